#include "check_problem.hpp"
#include "run.hpp"

namespace rodwake::integrate {

Solution solve(const OdeProblem& problem, const OdeOptions& options, std::span<const double> output_times) {
    check_problem(problem, options, output_times);
    return Run(problem, nullptr, options, output_times).execute().solution;
}

} // namespace rodwake::integrate
