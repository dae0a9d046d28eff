#pragma once
// The NLopt stage of a search. The only file of rodwake that includes nlopt.h is nlopt_search.cpp.

#include "evaluator.hpp"
#include "rodwake/fitting/method.hpp"
#include "search_end.hpp"

namespace rodwake::fitting {

/// From `start`; global algorithms are followed by slsqp from where they ended. `seed`: of the random
/// searches.
SearchEnd nlopt_search(Evaluator& evaluator, const Method& method, const Eigen::VectorXd& start,
                       std::uint32_t seed);

} // namespace rodwake::fitting
