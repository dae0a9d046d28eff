#include "rodwake/rods/model.hpp"

#include "interaction.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/elastic/periodic.hpp"

#include <array>

namespace rodwake::rods {

RodModel::RodModel(std::optional<elastic::Medium> medium, const Couplings& couplings, std::size_t rods,
                   std::optional<double> box)
    : box_(box), couplings_(couplings), rods_(rods) {
    if (medium && couplings.any() && (rods > 1 || box))
        field_.emplace(*medium);
}

void RodModel::rhs(integrate::State y, std::span<double> ydot) const {
    for (std::size_t a = 0; a < rods_; ++a) {
        const Direction n = direction(y, a);
        ydot[3 * a] = n.cosine;
        ydot[3 * a + 1] = n.sine;
        ydot[3 * a + 2] = 0.0;
    }
    if (!field_)
        return;
    if (box_) {
        add_periodic_turning(y, ydot);
        return;
    }
    const elastic::FieldRequest request = request_of(couplings_, false);
    for (std::size_t a = 0; a < rods_; ++a)
        for (std::size_t b = 0; b < rods_; ++b) {
            if (a == b)
                continue;
            const View at = view(y, a, b, {ydot[3 * a], ydot[3 * a + 1]}, {ydot[3 * b], ydot[3 * b + 1]});
            ydot[3 * a + 2] += turning_rate(field_->at(at.x, at.y, request), couplings_, at.heading);
        }
}

/// Sources outside: a periodic field is built for one heading.
void RodModel::add_periodic_turning(integrate::State y, std::span<double> ydot) const {
    const elastic::FieldRequest request = request_of(couplings_, false);
    for (std::size_t b = 0; b < rods_; ++b) {
        const elastic::PeriodicField field(field_->medium(), *box_, y[3 * b + 2]);
        ydot[3 * b + 2] += turning_rate(field.at_own_place(request), couplings_, {1.0, 0.0});
        for (std::size_t a = 0; a < rods_; ++a) {
            if (a == b)
                continue;
            const View at = view(y, a, b, {ydot[3 * a], ydot[3 * a + 1]}, {ydot[3 * b], ydot[3 * b + 1]});
            ydot[3 * a + 2] += turning_rate(field.at(at.x, at.y, request), couplings_, at.heading);
        }
    }
}

void RodModel::jacobian(integrate::State y, Eigen::Ref<Eigen::MatrixXd> jacobian) const {
    if (box_ && field_)
        throw InputError("rods in a periodic box have no analytic Jacobian; use difference quotients");
    jacobian.setZero();
    for (std::size_t a = 0; a < rods_; ++a) {
        const Direction na = direction(y, a);
        const auto row = static_cast<Eigen::Index>(3 * a);
        jacobian(row, row + 2) = -na.sine;
        jacobian(row + 1, row + 2) = na.cosine;
        if (!field_)
            continue;
        for (std::size_t b = 0; b < rods_; ++b) {
            if (a == b)
                continue;
            const Direction nb = direction(y, b);
            const View at = view(y, a, b, na, nb);
            const auto rate = turning_rate_derivatives(field_->at(at.x, at.y, request_of(couplings_, true)),
                                                       couplings_, at.heading);
            const auto column = static_cast<Eigen::Index>(3 * b);
            // The gradient in b's frame, turned to the lab; moving a one way is moving b the other.
            const double by_x = nb.cosine * rate.by_x - nb.sine * rate.by_y;
            const double by_y = nb.sine * rate.by_x + nb.cosine * rate.by_y;
            jacobian(row + 2, row) += by_x;
            jacobian(row + 2, row + 1) += by_y;
            jacobian(row + 2, row + 2) += rate.by_phi;
            jacobian(row + 2, column) -= by_x;
            jacobian(row + 2, column + 1) -= by_y;
            // Turning b carries its frame along: d(x, y)/d theta_b = (y, -x), d phi/d theta_b = -1.
            jacobian(row + 2, column + 2) += at.y * rate.by_x - at.x * rate.by_y - rate.by_phi;
        }
    }
}

std::string RodModel::component_name(std::size_t component) {
    static constexpr std::array names = {"x", "y", "theta"};
    return "rods[" + std::to_string(component / 3) + "]." + names[component % 3];
}

std::vector<double> to_state(std::span<const Pose> rods) {
    std::vector<double> y;
    y.reserve(3 * rods.size());
    for (const Pose& rod : rods)
        y.insert(y.end(), {rod.x, rod.y, rod.heading});
    return y;
}

Pose pose(integrate::State y, std::size_t rod) { return {y[3 * rod], y[3 * rod + 1], y[3 * rod + 2]}; }

} // namespace rodwake::rods
