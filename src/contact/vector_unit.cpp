#include "contact/vector_unit.hpp"

namespace talus {

bool has(VectorUnit unit) {
#ifdef TALUS_VECTOR_UNITS
    switch (unit) {
        case VectorUnit::avx512:
            return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                   __builtin_cpu_supports("avx512vl");
        case VectorUnit::avx2:
            return __builtin_cpu_supports("avx2");
        case VectorUnit::baseline:
            return true;
    }
    return false;
#else
    return unit == VectorUnit::baseline;
#endif
}

VectorUnit best_vector_unit() {
    return has(VectorUnit::avx512) ? VectorUnit::avx512 : has(VectorUnit::avx2) ? VectorUnit::avx2 : VectorUnit::baseline;
}

}  // namespace talus
