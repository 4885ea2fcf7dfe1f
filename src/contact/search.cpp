#include "contact/search.hpp"
