// Kinds of vector registers. A loop that pays for it is compiled once for each and chosen when the program runs; results are
// the same bits with each.
#pragma once

#if defined(__x86_64__) && defined(__GNUC__)
#define TALUS_VECTOR_UNITS
#define TALUS_AVX2 [[gnu::target("avx2")]]
#define TALUS_AVX512 [[gnu::target("avx512f,avx512dq,avx512vl,prefer-vector-width=512")]]
#endif

namespace talus {

enum class VectorUnit { baseline, avx2, avx512 };
bool has(VectorUnit unit);
VectorUnit best_vector_unit();

}  // namespace talus
