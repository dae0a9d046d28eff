#pragma once
// Relative error of a computed vector or tensor, and the worst of many.

#include "multiprecision.hpp"
#include "oracle.hpp"

#include <array>
#include <vector>

namespace rodwake::oracle {

/// Smallest true norm at which a relative error is asked for: the products inside need room above 2.2e-308.
inline constexpr double smallest_norm = 1e-290;

double norm(const std::vector<Real>& exact);

/// |got - exact|/|exact|; infinite when got is not finite or the two differ in length; 0 where exact is 0 and
/// got too.
double relative_error(const std::vector<double>& got, const std::vector<Real>& exact);

inline constexpr elastic::FieldRequest everything{true, true, true, true, true};

/// Worst relative error per quantity, and where.
struct Worst {
    std::array<double, all_quantities> error{};
    std::array<Point, all_quantities> at{};
    /// Compares the field with the oracle at one point, wherever the true norm is at least smallest_norm.
    void include(const Point& point);
    void include(Quantity q, double relative, const Point& point);
};

} // namespace rodwake::oracle
