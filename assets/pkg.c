#include "assets/pkg.h"
