#pragma once
// Field of a rod in the periodic box, the zero Fourier mode removed: what a measured displacement is compared
// with. Box axes along the rod. Lengths and U in one unit, U for f/mu = 1.
//
// U = (1/2 pi) [ G_T xhat + xi grad (G_T - G_L) ] with periodic G_i. The infinite plane's field of the images
// at (0, j L) is exact (elastic::Field); what is missing to the periodic one is a Fourier series in y whose
// terms fall as exp(-q (L - |x|)), so |x| <= L/2.

#include "rodwake/elastic/field.hpp"

#include <vector>

namespace measure_test {

class PeriodicField {
public:
    PeriodicField(const rodwake::elastic::Medium& medium, double box);

    /// Sum of images and series; slow. Not at the rod.
    rodwake::elastic::Vector exact(double x, double y) const;
    /// The infinite plane's field and a table of the rest: within 1e-6 of the exact one. x, y of any image.
    rodwake::elastic::Vector at(double x, double y) const;

private:
    rodwake::elastic::Vector rest(double x, double y) const;
    rodwake::elastic::Vector series(double c, double x, double y, double& value) const;
    rodwake::elastic::Vector interpolated(double x, double y) const;

    rodwake::elastic::Field field_;
    double box_;
    std::vector<rodwake::elastic::Vector> table_; ///< [y][x] over the box and two nodes around it
};

} // namespace measure_test
