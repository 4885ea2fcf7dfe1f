#include "geometry/cut.hpp"
