#include "nav/nav.h"
