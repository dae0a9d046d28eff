#include "interaction.hpp"
#include "rodwake/rods/pair_batch.hpp"

#include <algorithm>
#include <cmath>

namespace rodwake::rods {

namespace {

/// The columns of the headings alone, by central differences.
Eigen::MatrixXd difference_jacobian(const RodModel& model, std::vector<double> y) {
    constexpr double step = 1e-5;
    const std::size_t size = y.size();
    Eigen::MatrixXd jacobian =
        Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(size), static_cast<Eigen::Index>(size));
    std::vector<double> up(size), down(size);
    for (std::size_t column = 2; column < size; column += 3) {
        const double heading = y[column];
        y[column] = heading + step;
        model.rhs(y, up);
        y[column] = heading - step;
        model.rhs(y, down);
        y[column] = heading;
        for (std::size_t row = 0; row < size; ++row)
            jacobian(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column)) =
                (up[row] - down[row]) / (2.0 * step);
    }
    return jacobian;
}

} // namespace

double stiffness(const RodProblem& problem) {
    const auto y = to_state(problem.rods);
    double fastest = 0.0;
    if (const auto pair = to_pair_problem(problem)) {
        // As by the Jacobian, of which it takes no more than it needs: every point of a scan asks.
        const double distance = closest_pair(y, {}).distance;
        if (distance == 0.0)
            return 0.0;
        const elastic::Field field(pair->medium);
        for (const std::size_t a : {0, 1}) {
            const View at = view(y, a, 1 - a, direction(y, a), direction(y, 1 - a));
            const TurningRate rate = turning_rate_derivatives(
                field.at(at.x, at.y, request_of(pair->couplings, true)), pair->couplings, at.heading);
            fastest = std::max({fastest, std::abs(rate.by_phi),
                                std::abs(at.y * rate.by_x - at.x * rate.by_y - rate.by_phi)});
        }
        return fastest * distance;
    }
    const RodModel model = model_of(problem);
    if (!model.interacting())
        return 0.0;
    if (model.rods() > 1 && closest_pair(y, problem.box).distance == 0.0)
        return 0.0; // in contact before anything turns
    const auto size = static_cast<Eigen::Index>(y.size());
    Eigen::MatrixXd jacobian(size, size);
    if (model.has_jacobian())
        model.jacobian(y, jacobian);
    else
        jacobian = difference_jacobian(model, y);
    for (Eigen::Index row = 2; row < size; row += 3)
        for (Eigen::Index column = 2; column < size; column += 3)
            fastest = std::max(fastest, std::abs(jacobian(row, column)));
    return fastest * (model.rods() > 1 ? closest_pair(y, problem.box).distance : problem.box->shorter());
}

integrate::Method suitable_method(const RodProblem& problem) {
    if (problem.rods.size() > most_followed_rods)
        return integrate::Method::erk;
    constexpr double stiff_overlap = 0.02;
    constexpr std::size_t few = 30;
    if (problem.bodies.any() && problem.bodies.stall_overlap < stiff_overlap && problem.rods.size() <= few)
        return integrate::Method::bdf;
    return stiffness(problem) > 30.0 ? integrate::Method::bdf : integrate::Method::erk;
}

bool suits_held_wakes(const RodProblem& problem) {
    return problem.rods.size() > most_followed_rods && problem.bodies.any() && problem.medium &&
           problem.couplings.any();
}

} // namespace rodwake::rods
