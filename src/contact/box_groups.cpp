#include "contact/box_groups.hpp"

#include "contact/vector_unit.hpp"

#include <bit>
#include <limits>

#ifdef TALUS_VECTOR_UNITS
#include <immintrin.h>
#endif

namespace talus {
namespace {

constexpr int width = BoxGroups::width;
constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
constexpr Box nobody{nothing, nothing, nothing, nothing};

const Box& box_at(std::span<const Box> boxes, const BoxGroups& groups, int place) {
    const int box = groups.box[place];
    return *(box < 0 ? &nobody : &boxes[box]);
}

/// Places of a group after the given one.
constexpr unsigned later(int lane) { return 0xffu & (0xfeu << lane); }

struct Kernels {
    void (*refresh)(std::span<const Box>, const Vec2&, BoxGroups&, int, int, std::vector<int>&);
    void (*compare)(BoxGroups&, std::size_t, std::size_t);
    void (*list)(BoxGroups&, std::span<const CoarseBox>, std::span<const Pair>);
};

// ---- any processor ------------------------------------------------------------------------------------------------------

template <class Bounds, class Asked>
unsigned overlapping(const Bounds& of, const Asked& box) {
    unsigned found = 0;
    for (int k = 0; k < width; ++k)
        found |= static_cast<unsigned>((box.xmin <= of.xmax[k]) & (of.xmin[k] <= box.xmax) & (box.ymin <= of.ymax[k]) &
                                       (of.ymin[k] <= box.ymax))
                 << k;
    return found;
}

Box box_in(const BoxGroups::Bounds& of, int lane) { return {of.xmin[lane], of.ymin[lane], of.xmax[lane], of.ymax[lane]}; }

void refresh_plain(std::span<const Box> boxes, const Vec2& centre, BoxGroups& groups, int begin, int end,
                   std::vector<int>& escaped) {
    for (int g = begin; g < end; ++g) {
        BoxGroups::Bounds& bounds = groups.bounds[g];
        const BoxGroups::Limits& limits = groups.limits[g];
        for (int k = 0; k < width; ++k) {
            const Box& b = box_at(boxes, groups, width * g + k);
            bounds.xmin[k] = b.xmin, bounds.ymin[k] = b.ymin, bounds.xmax[k] = b.xmax, bounds.ymax[k] = b.ymax;
            const bool inside = (b.xmin - centre.x() >= limits.xmin[k]) & (b.ymin - centre.y() >= limits.ymin[k]) &
                                (b.xmax - centre.x() <= limits.xmax[k]) & (b.ymax - centre.y() <= limits.ymax[k]);
            if (!inside && groups.box[width * g + k] >= 0) escaped.push_back(width * g + k);
        }
        for (int k = 0; k < width; ++k)
            groups.own[width * g + k] = static_cast<std::uint8_t>(overlapping(bounds, box_in(bounds, k)) & later(k));
    }
}

void compare_plain(BoxGroups& groups, std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
        const auto [place, group] = groups.rows[k];
        const Box box = box_in(groups.bounds[place / width], place % width);
        groups.found[k] = static_cast<std::uint8_t>(overlapping(groups.bounds[group], box));
    }
}

void list_plain(BoxGroups& groups, std::span<const CoarseBox> reach, std::span<const Pair> near) {
    for (const auto [a, b] : near) {
        const unsigned from_a = overlapping(groups.limits[a], reach[b]), from_b = overlapping(groups.limits[b], reach[a]);
        const bool fewer = std::popcount(from_a) < std::popcount(from_b);
        groups.add_rows(fewer ? a : b, fewer ? from_a : from_b, fewer ? b : a);
    }
}

constexpr Kernels plain{refresh_plain, compare_plain, list_plain};

// ---- AVX-512 ------------------------------------------------------------------------------------------------------------

#ifdef TALUS_VECTOR_UNITS

struct Registers {
    __m512d xmin, ymin, xmax, ymax;
};

TALUS_AVX512 inline __mmask8 overlapping_avx512(const Registers& of, const BoxGroups::Bounds& in, int lane) {
    __mmask8 found = _mm512_cmp_pd_mask(_mm512_set1_pd(in.xmin[lane]), of.xmax, _CMP_LE_OQ);
    found = _mm512_mask_cmp_pd_mask(found, of.xmin, _mm512_set1_pd(in.xmax[lane]), _CMP_LE_OQ);
    found = _mm512_mask_cmp_pd_mask(found, _mm512_set1_pd(in.ymin[lane]), of.ymax, _CMP_LE_OQ);
    return _mm512_mask_cmp_pd_mask(found, of.ymin, _mm512_set1_pd(in.ymax[lane]), _CMP_LE_OQ);
}

TALUS_AVX512 inline __m512d two(const Box& a, const Box& b) {
    return _mm512_insertf64x4(_mm512_castpd256_pd512(_mm256_loadu_pd(&a.xmin)), _mm256_loadu_pd(&b.xmin), 1);
}

/// The boxes of a group, turned from one after the other to one bound after the other.
TALUS_AVX512 inline Registers take(std::span<const Box> boxes, const BoxGroups& groups, int group) {
    const auto at = [&](int lane) -> const Box& { return box_at(boxes, groups, width * group + lane); };
    const __m512d a = two(at(0), at(4)), b = two(at(1), at(5)), c = two(at(2), at(6)), d = two(at(3), at(7));
    const __m512d x01 = _mm512_unpacklo_pd(a, b), y01 = _mm512_unpackhi_pd(a, b);  // 0 and 1, 4 and 5: lower, upper bounds
    const __m512d x23 = _mm512_unpacklo_pd(c, d), y23 = _mm512_unpackhi_pd(c, d);
    const __m512i lower = _mm512_setr_epi64(0, 1, 8, 9, 4, 5, 12, 13), upper = _mm512_setr_epi64(2, 3, 10, 11, 6, 7, 14, 15);
    return {_mm512_permutex2var_pd(x01, lower, x23), _mm512_permutex2var_pd(y01, lower, y23),
            _mm512_permutex2var_pd(x01, upper, x23), _mm512_permutex2var_pd(y01, upper, y23)};
}

TALUS_AVX512 inline __m512d widened(const float* bounds) { return _mm512_cvtps_pd(_mm256_load_ps(bounds)); }

TALUS_AVX512 void refresh_avx512(std::span<const Box> boxes, const Vec2& centre, BoxGroups& groups, int begin, int end,
                                 std::vector<int>& escaped) {
    const __m512d x = _mm512_set1_pd(centre.x()), y = _mm512_set1_pd(centre.y());
    for (int g = begin; g < end; ++g) {
        const Registers now = take(boxes, groups, g);
        BoxGroups::Bounds& bounds = groups.bounds[g];
        _mm512_store_pd(bounds.xmin, now.xmin);
        _mm512_store_pd(bounds.ymin, now.ymin);
        _mm512_store_pd(bounds.xmax, now.xmax);
        _mm512_store_pd(bounds.ymax, now.ymax);
        const BoxGroups::Limits& limits = groups.limits[g];
        __mmask8 inside = _mm512_cmp_pd_mask(_mm512_sub_pd(now.xmin, x), widened(limits.xmin), _CMP_GE_OQ);
        inside = _mm512_mask_cmp_pd_mask(inside, _mm512_sub_pd(now.ymin, y), widened(limits.ymin), _CMP_GE_OQ);
        inside = _mm512_mask_cmp_pd_mask(inside, _mm512_sub_pd(now.xmax, x), widened(limits.xmax), _CMP_LE_OQ);
        inside = _mm512_mask_cmp_pd_mask(inside, _mm512_sub_pd(now.ymax, y), widened(limits.ymax), _CMP_LE_OQ);
        for (unsigned outside = 0xffu & ~static_cast<unsigned>(inside); outside != 0; outside &= outside - 1) {
            const int place = width * g + std::countr_zero(outside);
            if (groups.box[place] >= 0) escaped.push_back(place);
        }
        for (int k = 0; k < width; ++k)
            groups.own[width * g + k] = static_cast<std::uint8_t>(overlapping_avx512(now, bounds, k) & later(k));
    }
}

TALUS_AVX512 void compare_avx512(BoxGroups& groups, std::size_t begin, std::size_t end) {
    const BoxGroups::Bounds* const bounds = groups.bounds.data();
    const BoxGroups::Row* const rows = groups.rows.data();
    std::uint8_t* const found = groups.found.data();
    for (std::size_t k = begin; k < end; ++k) {
        const BoxGroups::Bounds& others = bounds[rows[k].group];
        const Registers of{_mm512_load_pd(others.xmin), _mm512_load_pd(others.ymin), _mm512_load_pd(others.xmax),
                           _mm512_load_pd(others.ymax)};
        const auto place = static_cast<int>(rows[k].place);
        found[k] = static_cast<std::uint8_t>(overlapping_avx512(of, bounds[place / width], place % width));
    }
}

TALUS_AVX512 inline __mmask8 near_avx512(const BoxGroups::Limits& of, const CoarseBox& box) {
    __mmask8 found = _mm256_cmp_ps_mask(_mm256_set1_ps(box.xmin), _mm256_load_ps(of.xmax), _CMP_LE_OQ);
    found = _mm256_mask_cmp_ps_mask(found, _mm256_load_ps(of.xmin), _mm256_set1_ps(box.xmax), _CMP_LE_OQ);
    found = _mm256_mask_cmp_ps_mask(found, _mm256_set1_ps(box.ymin), _mm256_load_ps(of.ymax), _CMP_LE_OQ);
    return _mm256_mask_cmp_ps_mask(found, _mm256_load_ps(of.ymin), _mm256_set1_ps(box.ymax), _CMP_LE_OQ);
}

TALUS_AVX512 void list_avx512(BoxGroups& groups, std::span<const CoarseBox> reach, std::span<const Pair> near) {
    const __m512i lanes = _mm512_setr_epi64(0, 1, 2, 3, 4, 5, 6, 7);
    std::size_t count = groups.rows.size();
    groups.rows.resize(count + width * near.size());
    for (const auto [a, b] : near) {
        const __mmask8 from_a = near_avx512(groups.limits[a], reach[b]), from_b = near_avx512(groups.limits[b], reach[a]);
        const bool fewer = std::popcount(unsigned{from_a}) < std::popcount(unsigned{from_b});
        const __mmask8 from = fewer ? from_a : from_b;
        const std::int64_t mine = fewer ? a : b, other = fewer ? b : a;
        const __m512i rows = _mm512_add_epi64(lanes, _mm512_set1_epi64(other << 32 | width * mine));  // place, group
        _mm512_storeu_si512(&groups.rows[count], _mm512_maskz_compress_epi64(from, rows));
        count += std::popcount(unsigned{from});
    }
    groups.rows.resize(count);
}

const Kernels best = has(VectorUnit::avx512) ? Kernels{refresh_avx512, compare_avx512, list_avx512} : plain;

#else
const Kernels best = plain;
#endif

}  // namespace

void BoxGroups::resize(int groups) {
    constexpr float none = std::numeric_limits<float>::quiet_NaN();
    Bounds empty;
    Limits unlimited;
    for (int k = 0; k < width; ++k) {
        empty.xmin[k] = empty.ymin[k] = empty.xmax[k] = empty.ymax[k] = nothing;
        unlimited.xmin[k] = unlimited.ymin[k] = unlimited.xmax[k] = unlimited.ymax[k] = none;
    }
    box.resize(static_cast<std::size_t>(width) * groups, -1);
    own.resize(static_cast<std::size_t>(width) * groups, 0);
    bounds.resize(groups, empty);
    limits.resize(groups, unlimited);
}

void BoxGroups::enclose(int place, const CoarseBox& b) {
    Limits& of = limits[place / width];
    const int k = place % width;
    of.xmin[k] = b.xmin, of.ymin[k] = b.ymin, of.xmax[k] = b.xmax, of.ymax[k] = b.ymax;
}

CoarseBox BoxGroups::coarse_box(int place) const {
    const Limits& of = limits[place / width];
    const int k = place % width;
    return {of.xmin[k], of.ymin[k], of.xmax[k], of.ymax[k]};
}

void BoxGroups::add_rows(int group, unsigned lanes, int other) {
    for (; lanes != 0; lanes &= lanes - 1)
        rows.push_back(
            {static_cast<std::uint32_t>(width * group + std::countr_zero(lanes)), static_cast<std::uint32_t>(other)});
}

CoarseBox BoxGroups::reach(int group) const {
    constexpr float out = std::numeric_limits<float>::infinity();
    CoarseBox all{out, out, -out, -out};
    const Limits& of = limits[group];
    for (int k = 0; k < width; ++k)  // comparisons with what is not a number leave what was
        all = {of.xmin[k] < all.xmin ? of.xmin[k] : all.xmin, of.ymin[k] < all.ymin ? of.ymin[k] : all.ymin,
               of.xmax[k] > all.xmax ? of.xmax[k] : all.xmax, of.ymax[k] > all.ymax ? of.ymax[k] : all.ymax};
    return all;
}

bool BoxGroups::near(int group, const CoarseBox& b) const {
    const Limits& of = limits[group];
    int count = 0;
    for (int k = 0; k < width; ++k)
        count += (b.xmin <= of.xmax[k]) & (of.xmin[k] <= b.xmax) & (b.ymin <= of.ymax[k]) & (of.ymin[k] <= b.ymax);
    return count > 0;
}

void BoxGroups::vacate(int place) {
    constexpr float none = std::numeric_limits<float>::quiet_NaN();
    box[place] = -1;
    enclose(place, {none, none, none, none});
}

void refresh_groups(std::span<const Box> boxes, const Vec2& centre, BoxGroups& groups, int begin, int end,
                    std::vector<int>& escaped) {
    best.refresh(boxes, centre, groups, begin, end, escaped);
}

void compare_rows(BoxGroups& groups, std::size_t begin, std::size_t end) { best.compare(groups, begin, end); }

void list_rows(BoxGroups& groups, std::span<const CoarseBox> reach, std::span<const Pair> near) {
    best.list(groups, reach, near);
}

}  // namespace talus
