#include "contact/near_boxes.hpp"

#ifdef TALUS_VECTOR_UNITS
#include <immintrin.h>

#include <bit>
#endif

namespace talus {
namespace {

enum class Near { along_both, along_y, rarely };

/// A branch per box would be guessed wrong at each that is near: each is written, and the next one over it unless it counts.
template <Near kind>
int baseline(const RoundedBoxes& of, int place, int from, int to, int* near) {
    const float *xmin = of.xmin.data(), *ymin = of.ymin.data(), *xmax = of.xmax.data(), *ymax = of.ymax.data();
    int count = 0;
    for (int k = from; k < to; ++k) {
        near[count] = k;
        count += (kind == Near::along_y || ((xmin[place] <= xmax[k]) & (xmin[k] <= xmax[place]))) &
                 (ymin[place] <= ymax[k]) & (ymin[k] <= ymax[place]);
    }
    return count;
}

#ifdef TALUS_VECTOR_UNITS

template <Near kind>
TALUS_AVX2 int avx2(const RoundedBoxes& of, int place, int from, int to, int* near) {
    const float *xmin = of.xmin.data(), *ymin = of.ymin.data(), *xmax = of.xmax.data(), *ymax = of.ymax.data();
    const __m256 x0 = _mm256_set1_ps(xmin[place]), x1 = _mm256_set1_ps(xmax[place]);
    const __m256 y0 = _mm256_set1_ps(ymin[place]), y1 = _mm256_set1_ps(ymax[place]);
    int count = 0;
    for (; from + 8 <= to; from += 8) {
        __m256 overlap = _mm256_cmp_ps(y0, _mm256_loadu_ps(ymax + from), _CMP_LE_OQ);
        overlap = _mm256_and_ps(overlap, _mm256_cmp_ps(_mm256_loadu_ps(ymin + from), y1, _CMP_LE_OQ));
        if (kind != Near::along_y) {
            overlap = _mm256_and_ps(overlap, _mm256_cmp_ps(x0, _mm256_loadu_ps(xmax + from), _CMP_LE_OQ));
            overlap = _mm256_and_ps(overlap, _mm256_cmp_ps(_mm256_loadu_ps(xmin + from), x1, _CMP_LE_OQ));
        }
        for (auto mask = static_cast<unsigned>(_mm256_movemask_ps(overlap)); mask != 0; mask &= mask - 1)
            near[count++] = from + std::countr_zero(mask);
    }
    return count + baseline<kind>(of, place, from, to, near + count);
}

template <Near kind>
TALUS_AVX512 int avx512(const RoundedBoxes& of, int place, int from, int to, int* near) {
    const float *xmin = of.xmin.data(), *ymin = of.ymin.data(), *xmax = of.xmax.data(), *ymax = of.ymax.data();
    const __m512 x0 = _mm512_set1_ps(xmin[place]), x1 = _mm512_set1_ps(xmax[place]);
    const __m512 y0 = _mm512_set1_ps(ymin[place]), y1 = _mm512_set1_ps(ymax[place]);
    const __m512i counting = _mm512_set_epi32(15, 14, 13, 12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1, 0);
    int count = 0;
    for (; from < to; from += 16) {
        const auto inside = static_cast<__mmask16>(to - from < 16 ? (1 << (to - from)) - 1 : 0xffff);
        __mmask16 mask = _mm512_mask_cmp_ps_mask(inside, y0, _mm512_maskz_loadu_ps(inside, ymax + from), _CMP_LE_OQ);
        mask = _mm512_mask_cmp_ps_mask(mask, _mm512_maskz_loadu_ps(inside, ymin + from), y1, _CMP_LE_OQ);
        if (kind != Near::along_y) {
            mask = _mm512_mask_cmp_ps_mask(mask, x0, _mm512_maskz_loadu_ps(inside, xmax + from), _CMP_LE_OQ);
            mask = _mm512_mask_cmp_ps_mask(mask, _mm512_maskz_loadu_ps(inside, xmin + from), x1, _CMP_LE_OQ);
        }
        if (kind == Near::rarely && mask == 0) continue;
        const __m512i places = _mm512_add_epi32(_mm512_set1_epi32(from), counting);
        _mm512_storeu_si512(near + count, _mm512_maskz_compress_epi32(mask, places));
        count += std::popcount(static_cast<unsigned>(mask));
    }
    return count;
}

#endif

template <Near kind>
FindNear kernel([[maybe_unused]] VectorUnit unit) {
#ifdef TALUS_VECTOR_UNITS
    if (unit == VectorUnit::avx512) return avx512<kind>;
    if (unit == VectorUnit::avx2) return avx2<kind>;
#endif
    return baseline<kind>;
}

}  // namespace

void RoundedBoxes::resize(std::size_t boxes) {
    for (auto* side : {&xmin, &ymin, &xmax, &ymax}) side->resize(boxes);
}

void RoundedBoxes::set(std::size_t place, const Box& box) {
    xmin[place] = static_cast<float>(box.xmin);
    ymin[place] = static_cast<float>(box.ymin);
    xmax[place] = static_cast<float>(box.xmax);
    ymax[place] = static_cast<float>(box.ymax);
}

FindNear near_kernel(VectorUnit unit) { return kernel<Near::along_both>(unit); }
FindNear rarely_near_kernel(VectorUnit unit) { return kernel<Near::rarely>(unit); }
FindNear near_along_y_kernel(VectorUnit unit) { return kernel<Near::along_y>(unit); }

}  // namespace talus
