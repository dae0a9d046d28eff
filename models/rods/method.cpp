#include "rodwake/rods/method.hpp"

#include <algorithm>
#include <cmath>

namespace rodwake::rods {

double stiffness(const RodProblem& problem) {
    const RodModel model(problem.medium, problem.couplings, problem.rods.size());
    if (!model.interacting())
        return 0.0;
    const auto y = to_state(problem.rods);
    const auto size = static_cast<Eigen::Index>(y.size());
    Eigen::MatrixXd jacobian(size, size);
    model.jacobian(y, jacobian);
    double fastest = 0.0;
    for (Eigen::Index row = 2; row < size; row += 3)
        for (Eigen::Index column = 2; column < size; column += 3)
            fastest = std::max(fastest, std::abs(jacobian(row, column)));
    return fastest * closest_pair(y).distance;
}

integrate::Method suitable_method(const RodProblem& problem) {
    return stiffness(problem) > 30.0 ? integrate::Method::bdf : integrate::Method::erk;
}

} // namespace rodwake::rods
