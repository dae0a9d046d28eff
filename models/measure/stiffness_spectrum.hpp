#pragma once
// The inverse Laplace transform of the mean-square displacement, with errors and with what the sampling
// leaves open. Definitions: rodwake/measure/memory_kernel.hpp.

#include "blocks.hpp"
#include "rodwake/measure/memory_kernel.hpp"

namespace rodwake::measure {

/// At these s, of one curve; `error` stays empty.
StiffnessSpectrum spectrum_of(std::span<const double> lag, std::span<const double> msd,
                              const std::vector<double>& s);

/// Of all blocks together, with the errors of the jackknife; `lag` are the first ones of the blocks', in s.
StiffnessSpectrum stiffness_spectrum(const std::vector<LagBlock>& blocks, const std::vector<double>& lag);

} // namespace rodwake::measure
