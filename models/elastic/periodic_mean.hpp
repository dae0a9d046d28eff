#pragma once
// The mean over y of the periodic potential, a function of x alone (n = 0 of periodic_rows.hpp), z = 2 cx:
//
//   g'' + z g' = -2 pi (delta_per(x) - 1),    g = (2 pi/z) [x - 1/2 - 1/z + e^(-z x)/(1 - e^-z)],  0 < x < 1
//
// of zero mean over the box. For small z the sum 2 pi sum_n (-z)^(n-2) B_n(x)/n! of Bernoulli polynomials.

namespace rodwake::elastic {

/// Derivatives by x and by z.
struct Mean {
    double g, x, xx, z, xz, xxz;
};

/// Of all columns, 0 <= x <= 1; any z.
Mean mean_of_all(double z, double x);

/// Without the infinite plane's column at 0, whose mean is (2 pi/|z|) min(1, e^(-z x)); |x| <= 1/2. For
/// |z| >= 1, else powers of 1/z cancel.
Mean mean_of_others(double z, double x);

} // namespace rodwake::elastic
