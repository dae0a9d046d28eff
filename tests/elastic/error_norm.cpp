#include "error_norm.hpp"

#include <cmath>
#include <limits>

namespace rodwake::oracle {

namespace {

Real exact_norm(const std::vector<Real>& v) {
    Real sum = 0;
    for (const Real& value : v)
        sum += value * value;
    return sqrt(sum);
}

} // namespace

double norm(const std::vector<Real>& exact) { return static_cast<double>(exact_norm(exact)); }

double relative_error(const std::vector<double>& got, const std::vector<Real>& exact) {
    if (got.size() != exact.size())
        return std::numeric_limits<double>::infinity();
    std::vector<Real> difference;
    for (std::size_t k = 0; k < got.size(); ++k) {
        if (!std::isfinite(got[k]))
            return std::numeric_limits<double>::infinity();
        difference.push_back(got[k] - exact[k]);
    }
    const Real error = exact_norm(difference), scale = exact_norm(exact);
    return error == 0 ? 0.0 : static_cast<double>(error / scale);
}

void Worst::include(Quantity q, double relative, const Point& point) {
    const int k = static_cast<int>(q);
    if (!(relative <= error[k])) {
        error[k] = relative;
        at[k] = point;
    }
}

void Worst::include(const Point& point) {
    const Field exact(point);
    const elastic::FieldValues got =
        elastic::Field({.eta = point.eta, .xi = point.xi}).at(point.x, point.y, everything);
    for (int k = 0; k < all_quantities; ++k) {
        const auto q = static_cast<Quantity>(k);
        const std::vector<Real> truth = components(exact, q);
        if (norm(truth) >= smallest_norm)
            include(q, relative_error(components(got, q), truth), point);
    }
}

} // namespace rodwake::oracle
