#pragma once
// Where a stage of a search ended, and why.

#include "rodwake/fitting/fit.hpp"

namespace rodwake::fitting {

struct SearchEnd {
    Eigen::VectorXd u;
    double objective = std::numeric_limits<double>::infinity();
    Termination termination = Termination::failed;
    std::string reason;
};

} // namespace rodwake::fitting
