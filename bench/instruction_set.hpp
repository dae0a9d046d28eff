#pragma once
// Include for a benchmark that can leave AVX-512 aside:
//
//   RODWAKE_BENCH_AVX2=1 build/release/bench/bench_pair_batch

#include <cstdlib>
#include <hwy/targets.h>

namespace rodwake {

/// True: the vector code runs as on a machine without AVX-512.
inline const bool without_avx512 = [] {
    const bool wanted = std::getenv("RODWAKE_BENCH_AVX2") != nullptr;
#if HWY_ARCH_X86
    if (wanted)
        hwy::DisableTargets(HWY_AVX3 | HWY_AVX3_DL);
#endif
    return wanted;
}();

} // namespace rodwake
