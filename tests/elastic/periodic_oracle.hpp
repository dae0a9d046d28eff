#pragma once
// The field of a rod and its images in a periodic box by Ewald's split of the diffusing source's history, in
// long double; it shares nothing with models/elastic but the equation. With
//
//   1/(k^2 - 2 i c.k) = int_0^inf exp(-t (k^2 - 2 i c.k)) dt
//
// the times after tau are summed as Fourier series, those before as images, each exp(-|r + 2 c t|^2/4t)/(2
// t): diffusion with drift. The image integrals are Gauss-Legendre over ln t.

#include "rodwake/core/periodic.hpp"
#include "rodwake/elastic/field.hpp"

#include <array>
#include <vector>

namespace rodwake::oracle {

/// A place in the rod's axes, the medium, the box's x side and the rod's heading against it.
struct BoxPoint {
    double x, y, xi, eta, box, heading;
    double aspect = 1.0; ///< the box's y side over the x side

    PeriodicBox sides() const { return {box, aspect * box}; }
};

/// The periodic potential G and its derivatives d_x^i d_y^j, i + j <= 4.
class PeriodicPotential {
public:
    PeriodicPotential(const BoxPoint& at, long double c);
    long double derivative(int i, int j) const { return table_.at(i).at(j); }

private:
    void add_waves(const BoxPoint& at, long double c, long double tau);
    void add_images(const BoxPoint& at, long double c, long double tau);
    void add_image(long double x, long double y, long double c, long double tau);

    std::array<std::array<long double, 5>, 5> table_{};
};

/// All quantities: displacement, strain, polar, dipole, gradients.
elastic::FieldValues periodic_field(const BoxPoint& at);

} // namespace rodwake::oracle
