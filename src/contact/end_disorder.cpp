#include "contact/end_disorder.hpp"

#ifdef TALUS_VECTOR_UNITS
#include <immintrin.h>

#include <bit>
#endif

namespace talus {
namespace {

// Few ends are out of order, but which is as good as random: each place is written, and the next one over it unless it
// counts.
int baseline(const double* coordinate, const int* tag, int from, int to, int* places) {
    int count = 0;
    double last = coordinate[2 * tag[from - 1]];
    for (int k = from; k < to; ++k) {
        const double at = coordinate[2 * tag[k]];
        places[count] = k;
        count += !(last < at);
        last = at;
    }
    return count;
}

// Written out because compilers take coordinates from all over the memory one by one, which is two times as slow.
#ifdef TALUS_VECTOR_UNITS

TALUS_AVX2 int avx2(const double* coordinate, const int* tag, int from, int to, int* places) {
    int count = 0;
    __m256d last = _mm256_set1_pd(coordinate[2 * tag[from - 1]]);
    for (; from + 4 <= to; from += 4) {
        const __m128i tags = _mm_loadu_si128(reinterpret_cast<const __m128i*>(tag + from));
        const __m256d at = _mm256_i32gather_pd(coordinate, _mm_slli_epi32(tags, 1), 8);
        const __m256d turned = _mm256_permute4x64_pd(at, 0b10'01'00'11);  // 3 0 1 2
        const __m256d before = _mm256_blend_pd(turned, _mm256_permute4x64_pd(last, 0b11'11'11'11), 1);
        for (int mask = _mm256_movemask_pd(_mm256_cmp_pd(before, at, _CMP_NLT_UQ)); mask != 0; mask &= mask - 1)
            places[count++] = from + std::countr_zero(static_cast<unsigned>(mask));
        last = at;
    }
    return count + baseline(coordinate, tag, from, to, places + count);
}

TALUS_AVX512 int avx512(const double* coordinate, const int* tag, int from, int to, int* places) {
    int count = 0;
    const __m512i one_before = _mm512_set_epi64(14, 13, 12, 11, 10, 9, 8, 7);
    __m256i here = _mm256_add_epi32(_mm256_set1_epi32(from), _mm256_set_epi32(7, 6, 5, 4, 3, 2, 1, 0));
    __m512d last = _mm512_set1_pd(coordinate[2 * tag[from - 1]]);
    for (; from + 8 <= to; from += 8) {
        const __m256i tags = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(tag + from));
        const __m512d at = _mm512_i32gather_pd(_mm256_slli_epi32(tags, 1), coordinate, 8);
        const __mmask8 mask = _mm512_cmp_pd_mask(_mm512_permutex2var_pd(last, one_before, at), at, _CMP_NLT_UQ);
        _mm256_storeu_si256(reinterpret_cast<__m256i*>(places + count), _mm256_maskz_compress_epi32(mask, here));
        count += std::popcount(static_cast<unsigned>(mask));
        here = _mm256_add_epi32(here, _mm256_set1_epi32(8));
        last = at;
    }
    return count + baseline(coordinate, tag, from, to, places + count);
}

#endif

}  // namespace

FindDisorder disorder_kernel([[maybe_unused]] VectorUnit unit) {
#ifdef TALUS_VECTOR_UNITS
    if (unit == VectorUnit::avx512) return avx512;
    if (unit == VectorUnit::avx2) return avx2;
#endif
    return baseline;
}

}  // namespace talus
