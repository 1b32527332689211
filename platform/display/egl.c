#include "platform/base/log.h"
