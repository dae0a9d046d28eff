#pragma once
// What the batched kernels (wake_batch.cpp) and their front (wake_kernel.cpp) pass each other.

#include "rodwake/elastic/wake_kernel.hpp"

#include <cstddef>

namespace rodwake::elastic {

/// A source with what its heading costs.
struct KernelSource {
    double x, y, cosine, sine;
};

/// A medium's constants as the kernels take them.
struct KernelInternals {
    using KernelConstants = WakeKernel::KernelConstants;
    static KernelConstants constants(const Field& field);
};
using KernelMedium = KernelInternals::KernelConstants;

/// In this order: xx, xy, yy of the strain; lap U; grad div U.
inline constexpr int strain_parts = 3, all_parts = 7;

/// Where the targets are and where their sums go.
struct KernelTargets {
    const double *x, *y;
    std::size_t count;
    double* sum[all_parts]; ///< the polar parts null: not wanted
};

/// Sums over sources at targets; what is beyond the kernel's range is asked of `field`.
void sum_wakes(const KernelMedium& medium, const Field& field, Accuracy accuracy,
               std::span<const KernelSource> sources, const KernelTargets& targets);

KernelSource kernel_source(const Source& source);
std::vector<KernelSource> kernel_sources(std::span<const Source> sources);

/// Throws InputError for sums that are not as many as the targets.
void require_lengths(std::size_t targets, const StrainSums& sums);
void require_lengths(std::size_t targets, const PolarSums& sums);

/// One source at one target by the field itself.
void exact_parts(const Field& field, const KernelSource& source, double x, double y, bool polar,
                 double* parts);

} // namespace rodwake::elastic
