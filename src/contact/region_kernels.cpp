#include "contact/region_kernels.hpp"

#include "contact/threads.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#if defined(__x86_64__) && defined(__GNUC__)
#include <immintrin.h>
#endif

namespace talus {
namespace {

struct Kernels {
    void (*find_escaped)(std::span<const Box>, const Vec2&, const Regions&, int, int, std::vector<int>&);
    void (*compare_watched)(std::span<const Box>, WatchedPairs&);
    void (*compare_upper)(std::span<const Box>, int, int, UpperBounds&);  // of boxes [4 begin, 4 end)
};

// ---- any processor ------------------------------------------------------------------------------------------------------

bool inside(const Box& box, const Vec2& centre, const float* at, double radius) {
    // Written so that a bound that is not a number is outside.
    return (std::abs(box.xmin - centre.x() - at[0]) <= radius) & (std::abs(box.ymin - centre.y() - at[1]) <= radius) &
           (std::abs(box.xmax - centre.x() - at[2]) <= radius) & (std::abs(box.ymax - centre.y() - at[3]) <= radius);
}

void find_escaped_plain(std::span<const Box> boxes, const Vec2& centre, const Regions& regions, int begin, int end,
                        std::vector<int>& escaped) {
    for (int i = begin; i < end; ++i)
        if (!inside(boxes[i], centre, &regions.at[4 * static_cast<std::size_t>(i)], regions.radius[i])) escaped.push_back(i);
}

// Without branches: of two watched boxes nobody can predict which side keeps them apart.
bool overlapping(const Box& a, const Box& b) {
    return (a.xmin <= b.xmax) & (b.xmin <= a.xmax) & (a.ymin <= b.ymax) & (b.ymin <= a.ymax);
}

void compare_plain(std::span<const Box> boxes, WatchedPairs& pairs) {
    for (std::size_t k = 0; k < pairs.size(); ++k) {
        const auto other = static_cast<std::uint32_t>(pairs.other(k));
        pairs.others()[k] = other | (overlapping(boxes[pairs.box(k)], boxes[other]) ? WatchedPairs::flag : 0);
    }
}

unsigned reaches(std::span<const Box> boxes, int i, const UpperBounds& bounds) {
    const UpperBounds::Beyond other = bounds.beyond[i];
    return static_cast<unsigned>(boxes[i].xmax >= boxes[other.x].xmin) |
           static_cast<unsigned>(boxes[i].ymax >= boxes[other.y].ymin) << 1;
}

void compare_upper_plain(std::span<const Box> boxes, int begin, int end, UpperBounds& bounds) {
    for (int four = begin; four < end; ++four) {
        unsigned all = 0;
        for (int k = 0; k < 4; ++k) all |= reaches(boxes, 4 * four + k, bounds) << (2 * k);
        bounds.reaches[four] = static_cast<std::uint8_t>(all);
    }
}

constexpr Kernels plain{find_escaped_plain, compare_plain, compare_upper_plain};

// ---- AVX-512
// --------------------------------------------------------------------------------------------------------------

#if defined(__x86_64__) && defined(__GNUC__)

// Eight boxes at a time, two in a register, four bits of the mask for each.
[[gnu::target("avx512f")]] void find_escaped_avx512(std::span<const Box> boxes, const Vec2& centre, const Regions& regions,
                                                    int begin, int end, std::vector<int>& escaped) {
    const __m512d middle =
        _mm512_setr_pd(centre.x(), centre.y(), centre.x(), centre.y(), centre.x(), centre.y(), centre.x(), centre.y());
    const __m512i first_two = _mm512_setr_epi64(0, 0, 0, 0, 1, 1, 1, 1);
    int i = begin;
    for (; i + 8 <= end; i += 8) {
        const __m512d radius = _mm512_cvtps_pd(_mm256_loadu_ps(&regions.radius[i]));
        std::uint32_t outside = 0;
        for (int k = 0; k < 4; ++k) {
            const std::size_t box = static_cast<std::size_t>(i) + 2 * k;
            const __m512d reference = _mm512_cvtps_pd(_mm256_loadu_ps(&regions.at[4 * box]));
            const __m512d bounds = _mm512_sub_pd(_mm512_loadu_pd(&boxes[box].xmin), middle);
            const __m512d moved = _mm512_abs_pd(_mm512_sub_pd(bounds, reference));
            const __m512i lanes = _mm512_add_epi64(first_two, _mm512_set1_epi64(2 * k));
            const __m512d limit = _mm512_permutexvar_pd(lanes, radius);
            outside |= static_cast<std::uint32_t>(_mm512_cmp_pd_mask(moved, limit, _CMP_NLE_UQ)) << (8 * k);
        }
        while (outside != 0) {
            const int box = std::countr_zero(outside) / 4;
            escaped.push_back(i + box);
            outside &= ~(15u << (4 * box));
        }
    }
    find_escaped_plain(boxes, centre, regions, i, end, escaped);
}

// Eight pairs at a time, two in a register. Bounds of the second of a pair change places and those that bound from above
// their sign: all four must then be smaller or equal.
[[gnu::target("avx512f,avx512dq,avx512vl,bmi2")]] void compare_avx512(std::span<const Box> boxes, WatchedPairs& pairs) {
    const __m512d sign = _mm512_setr_pd(0.0, 0.0, -0.0, -0.0, 0.0, 0.0, -0.0, -0.0);
    const __m256i flag = _mm256_set1_epi32(static_cast<int>(WatchedPairs::flag));
    for (std::size_t k = 0; k < pairs.size(); k += 8) {
        const std::size_t left = pairs.size() - k;
        const auto present = static_cast<__mmask8>(left >= 8 ? 255u : (1u << left) - 1);  // beyond the last: box 0 twice
        const __m256i other = _mm256_andnot_si256(flag, _mm256_maskz_loadu_epi32(present, pairs.others() + k));
        alignas(32) std::uint32_t here[8], there[8];
        _mm256_store_si256(reinterpret_cast<__m256i*>(here), _mm256_maskz_loadu_epi32(present, pairs.boxes() + k));
        _mm256_store_si256(reinterpret_cast<__m256i*>(there), other);
        std::uint32_t smaller = 0;
        for (int p = 0; p < 8; p += 2) {
            const __m512d a = _mm512_insertf64x4(_mm512_castpd256_pd512(_mm256_loadu_pd(&boxes[here[p]].xmin)),
                                                 _mm256_loadu_pd(&boxes[here[p + 1]].xmin), 1);
            const __m512d b = _mm512_insertf64x4(_mm512_castpd256_pd512(_mm256_loadu_pd(&boxes[there[p]].xmin)),
                                                 _mm256_loadu_pd(&boxes[there[p + 1]].xmin), 1);
            const __m512d turned = _mm512_maskz_permutex_pd(255, b, 0x4e);
            smaller |= static_cast<std::uint32_t>(
                           _mm512_cmp_pd_mask(_mm512_xor_pd(a, sign), _mm512_xor_pd(turned, sign), _CMP_LE_OQ))
                       << (4 * p);
        }
        const std::uint32_t all_four = smaller & (smaller >> 1) & (smaller >> 2) & (smaller >> 3);
        const auto overlaps = static_cast<__mmask8>(_pext_u32(all_four, 0x11111111u));
        _mm256_mask_storeu_epi32(pairs.others() + k, present, _mm256_mask_or_epi32(other, overlaps, other, flag));
    }
}

[[gnu::target("avx512f,avx512dq,avx512vl")]] void compare_upper_avx512(std::span<const Box> boxes, int begin, int end,
                                                                       UpperBounds& bounds) {
    const __m256i along = _mm256_setr_epi32(0, 1, 0, 1, 0, 1, 0, 1);
    for (int four = begin; four < end; ++four) {
        const std::size_t i = 4 * static_cast<std::size_t>(four);
        const __m256i others = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(&bounds.beyond[i]));
        const __m256i places = _mm256_add_epi32(_mm256_slli_epi32(others, 2), along);  // of lower bounds
        const __m512d lower = _mm512_mask_i32gather_pd(_mm512_setzero_pd(), 255, places, &boxes.front().xmin, 8);
        const __m512d upper =
            _mm512_shuffle_f64x2(_mm512_loadu_pd(&boxes[i].xmin), _mm512_loadu_pd(&boxes[i + 2].xmin), 0xdd);
        bounds.reaches[four] = static_cast<std::uint8_t>(_mm512_cmp_pd_mask(upper, lower, _CMP_GE_OQ));
    }
}

bool has_avx512() {
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl") &&
           __builtin_cpu_supports("bmi2");
}

const Kernels best = has_avx512() ? Kernels{find_escaped_avx512, compare_avx512, compare_upper_avx512} : plain;
#else
const Kernels best = plain;
#endif

}  // namespace

void find_escaped(std::span<const Box> boxes, const Vec2& centre, const Regions& regions, std::vector<int>& escaped) {
    const int n = static_cast<int>(boxes.size()), threads = n < 20000 ? 1 : threads_allowed();
    escaped.clear();
    if (threads == 1) return best.find_escaped(boxes, centre, regions, 0, n, escaped);
    std::vector<std::vector<int>> found(threads);
#pragma omp parallel for schedule(static) num_threads(threads)
    for (int t = 0; t < threads; ++t) {
        const auto at = [&](int k) { return static_cast<int>(static_cast<std::int64_t>(n) * k / threads); };
        best.find_escaped(boxes, centre, regions, at(t), at(t + 1), found[t]);
    }
    for (const auto& each : found) escaped.insert(escaped.end(), each.begin(), each.end());
}

void compare_watched(std::span<const Box> boxes, WatchedPairs& pairs) { best.compare_watched(boxes, pairs); }

void compare_upper_bounds(std::span<const Box> boxes, int word, UpperBounds& bounds) {
    const auto compare = [&](int i) {
        const unsigned others = bounds.reaches[i / 4] & ~(3u << (2 * (i % 4)));
        bounds.reaches[i / 4] = static_cast<std::uint8_t>(others | reaches(boxes, i, bounds) << (2 * (i % 4)));
    };
    const std::uint64_t watching = bounds.watching[word];
    const int whole = std::min(16 * word + 16, static_cast<int>(boxes.size()) / 4);
    if (std::popcount(watching) < 12) {
        for (std::uint64_t left = watching; left != 0; left &= left - 1) compare(64 * word + std::countr_zero(left));
    } else {  // all, which is faster than to ask who
        best.compare_upper(boxes, 16 * word, whole, bounds);
        for (int i = 4 * whole; i < std::min(64 * word + 64, static_cast<int>(boxes.size())); ++i) compare(i);
    }
}

}  // namespace talus
