#include "stepper.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace rodwake::integrate {

Stepper::Stepper(UserFunctions& calls, const OdeOptions& options, double end_time)
    : calls_(calls), options_(options), end_time_(end_time) {}

Eigen::MatrixXd Stepper::sensitivities(double) {
    throw std::logic_error("this integrator has no sensitivities");
}

Statistics Stepper::counts() const {
    Statistics sum = earlier_;
    return sum += segment_counts();
}

StepFailure Stepper::failure() const {
    if (calls_.rhs_threw())
        return {"RHSFUNC_FAIL", calls_.fault()};
    return {flag_name().substr(flag_prefix().size() + 1), calls_.fault()};
}

double Stepper::initial_step(double t) const {
    const double left = end_time_ - t;
    // SUNDIALS refuses to choose a step when the end is within round-off of the start.
    const double round_off =
        8.0 * std::numeric_limits<double>::epsilon() * std::max(std::abs(t), std::abs(end_time_));
    if (left < round_off)
        return left;
    return std::min(options_.initial_step, left);
}

double Stepper::longest_step() const {
    const auto& limit = calls_.problem().step_limit;
    double longest = next_step_limit_;
    if (limit)
        longest = std::min(longest, limit(time_, state_before()));
    if (options_.max_step > 0.0)
        longest = std::min(longest, options_.max_step);
    return longest < std::numeric_limits<double>::infinity() ? longest : 0.0;
}

double Stepper::shortest_step(double t) { return 2.0 * std::numeric_limits<double>::epsilon() * std::abs(t); }

} // namespace rodwake::integrate
