#pragma once
// Strain and polar vectors of many rods at many points at once: what superpose of elastic/field.hpp gives,
// with vector instructions chosen at run time.
//
// Bits: the value at a target depends on the sources and their order, on nothing else: not on the other
// targets, the lanes of a vector or the instruction set.
//
// Accuracy (Accuracy::full; accuracy.hpp has the coarser ones), relative to the norm of a tensor or vector of
// one source, measured against the closed form for r/xi in [0.005, 80] and eta in [0.1, 100]
// (studies/reports/elastic.md); tests hold 1.5e-13. Two exceptions, in which the parts cancel: grad div U on
// the wake axis loses r/xi, and lap U vanishes on a curve ahead of the rod. Range: any eta >= 0, distances of
// 2^-43 (1 + eta) xi to 2^21 xi. Points beyond, and media of eta < 0, are passed to elastic::Field one by
// one: right and slow. Far ahead values below 1e-300 are 0.
//
//   full         median  99 %   largest  where (test_elastic "errors of the accuracies*")
//   strain       4e-16   4e-15  8e-14    beside the rod at eta near 100
//   lap u        4e-16   6e-15  2e-12    near the curve ahead on which it vanishes
//   grad div u   4e-16   5e-15  3e-14    far behind on the axis
//
// Degenerate input:
//   no sources; no targets                                 sums of 0; nothing is written
//   a target at a source; places or headings not finite    InputError, at every accuracy
//   spans of unlike lengths, an illegal medium             InputError
//   xi = 1e-30 or 1e30, eta < 0                            by elastic::Field where the kernels do not reach

#include "rodwake/elastic/accuracy.hpp"
#include "rodwake/elastic/field.hpp"

#include <span>
#include <string>
#include <vector>

namespace rodwake::elastic {

/// Places in the lab frame; x and y of the same length.
struct FieldPoints {
    std::span<const double> x, y;
};
using Places [[deprecated("it is FieldPoints")]] = FieldPoints;

/// Where sums over the sources go, one number a target, lab components; each as long as the targets.
struct StrainSums {
    std::span<double> xx, xy, yy;
};
struct PolarSums {
    std::span<double> laplacian_x, laplacian_y; ///< lap U
    std::span<double> gradient_x, gradient_y;   ///< grad div U
};

class WakeKernel {
public:
    /// Throws InputError for an illegal medium (see validate).
    explicit WakeKernel(const Medium& medium, Accuracy accuracy = Accuracy::full);

    /// Overwrites the sums. Throws InputError if a target is at a source or not finite, and for spans of
    /// unlike lengths.
    void strain(std::span<const Source> sources, FieldPoints targets, const StrainSums& sums) const;
    void strain_and_polar(std::span<const Source> sources, FieldPoints targets, const StrainSums& strain,
                          const PolarSums& polar) const;

    /// One point: the same bits as in a batch.
    SymmetricTensor strain(const Source& source, double x, double y) const;

    const Medium& medium() const { return field_.medium(); }
    Accuracy accuracy() const { return accuracy_; }

private:
    friend struct KernelInternals; ///< models/elastic/wake_kernel.hpp

    struct KernelConstants {
        double c_shear, nu, delta, inverse_nu; ///< 1/(2 xi), 1/(1 + eta), 1 - nu, 1 + eta
    };

    Field field_;
    KernelConstants constants_;
    Accuracy accuracy_;
};

/// The instruction set in use, "AVX2".
std::string wake_kernel_target();

} // namespace rodwake::elastic
