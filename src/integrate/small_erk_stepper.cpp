// Explicit Runge-Kutta steps of a few components, with nothing between the method and the right-hand side.

#include "erk_table.hpp"
#include "rodwake/integrate/tsitouras_famelis.hpp"
#include "stepper.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace rodwake::integrate {

namespace {

namespace tableau = tsitouras_famelis;

/// `fixed`: the number of components, known to the compiler, or 0.
template<std::size_t fixed>
class SmallErkStepper final : public Stepper {
public:
    SmallErkStepper(UserFunctions& calls, const OdeOptions& options, double end_time)
        : Stepper(calls, options, end_time), strictness_(1.0 / tableau::leniency(options.rtol, 8.0)),
          size_of_state_(calls.problem().initial_state.size()), dense_(tableau::order) {}

    void start(double t, State y) override;
    bool advance() override;
    void interpolate(double t, std::span<double> y) override;
    int order() const override { return tableau::order; }
    std::string flag_prefix() const override { return "ERK"; }
    std::vector<double> weighted_errors() const override;
    State state_before() const override { return {before_.data(), size()}; }
    State state() const override { return {after_.data(), size()}; }

private:
    using Numbers = std::array<double, fixed == 0 ? most_small : fixed>;
    using Slopes = std::array<Numbers, tableau::stages>;

    bool attempt(double from);
    UserFunctions::CallbackResult stages(double from, double h);
    double error_norm(double h);
    double factor(double error) const;
    void accept(double from, double to, double error);
    bool fail(const char* flag);

    std::size_t size() const { return fixed > 0 ? fixed : size_of_state_; }
    std::span<double> of(Numbers& numbers) const { return {numbers.data(), size()}; }
    State of(const Numbers& numbers) const { return {numbers.data(), size()}; }
    Statistics segment_counts() const override { return counts_; }
    std::string flag_name() const override { return std::string("ERK_") + flag_; }

    const double strictness_;
    const std::size_t size_of_state_;
    Numbers before_{}, after_{}, end_{}, weights_{}, errors_{};
    Slopes slopes_{};
    DenseOutput dense_;
    double step_ = 0.0;  ///< to try next
    bool fresh_ = true;  ///< the last stage is not the slope at state()
    bool tried_ = false; ///< errors_ are those of a step
    Statistics counts_;
    const char* flag_ = "SUCCESS";
};

template<std::size_t fixed>
void SmallErkStepper<fixed>::start(double t, State y) {
    std::copy(y.begin(), y.end(), before_.begin()); // y may be state() itself
    after_ = before_;
    time_ = time_before_ = t;
    step_ = initial_step(t);
    fresh_ = true;
    tried_ = false;
    dense_.reset();
}

template<std::size_t fixed>
bool SmallErkStepper<fixed>::fail(const char* flag) {
    flag_ = flag;
    after_ = before_;
    return false;
}

template<std::size_t fixed>
bool SmallErkStepper<fixed>::advance() {
    if (!fresh_)
        slopes_[0] = slopes_[tableau::stages - 1];
    else if (calls_.rhs(time_, state(), of(slopes_[0])) != UserFunctions::fine)
        return fail("FIRST_RHSFUNC_ERR");
    else if (step_ == 0.0) {
        // Hairer, Norsett and Wanner I, II.4, without their trial step: a hundredth of the time in which the
        // state changes by itself, or by the tolerance where it is zero.
        calls_.error_weights(state(), of(weights_));
        double extent = 0.0, rate = 0.0;
        for (std::size_t i = 0; i < size(); ++i) {
            extent += std::pow(after_[i] * weights_[i], 2);
            rate += std::pow(slopes_[0][i] * weights_[i], 2);
        }
        const bool known = extent > 1e-10 && rate > 1e-10;
        step_ = known ? 0.01 * std::sqrt(extent / rate) : 1e-6;
    }
    before_ = after_;
    calls_.error_weights(state_before(), of(weights_));
    return attempt(time_);
}

/// Tries shorter and shorter steps until one is taken.
template<std::size_t fixed>
bool SmallErkStepper<fixed>::attempt(double from) {
    constexpr int most_failures = 60, most_faults = 20; // of a step: factors of 1e12 and more
    constexpr double shortening = 0.25;                 // after a fault, as CVODES
    int failures = 0, faults = 0;
    const double longest = longest_step(); // 0: no limit
    double h = longest > 0.0 ? std::min(step_, longest) : step_;
    h = std::min(h, end_time_ - from);
    for (;;) {
        const UserFunctions::CallbackResult result = stages(from, h);
        if (result == UserFunctions::give_up)
            return fail("RHSFUNC_FAIL");
        if (result == UserFunctions::try_shorter_step) {
            const double tried = calls_.last_time() - from;
            if (!(tried > 0.0) || ++faults > most_faults)
                return fail("UNREC_RHSFUNC_ERR");
            h = step_ = shortening * tried;
            if (h <= shortest_step(from))
                return fail("UNREC_RHSFUNC_ERR");
            continue;
        }
        const double error = error_norm(h);
        tried_ = true;
        if (error <= 1.0) {
            accept(from, from + h < end_time_ ? from + h : end_time_, error);
            return true;
        }
        ++counts_.error_test_failures;
        if (h <= shortest_step(from) || ++failures > most_failures)
            return fail("ERR_FAILURE");
        h *= std::min(factor(error), 0.9);
        step_ = h;
    }
}

template<std::size_t fixed>
UserFunctions::CallbackResult SmallErkStepper<fixed>::stages(double from, double h) {
    for (std::size_t s = 1; s < tableau::stages; ++s) {
        end_ = before_;
        for (std::size_t k = 0; k < s; ++k)
            if (const double weight = h * tableau::stage_weights[s][k]; weight != 0.0)
                for (std::size_t i = 0; i < size(); ++i)
                    end_[i] += weight * slopes_[k][i];
        const auto result = calls_.rhs(from + tableau::nodes[s] * h, of(std::as_const(end_)), of(slopes_[s]));
        if (result != UserFunctions::fine)
            return result;
    }
    return UserFunctions::fine;
}

template<std::size_t fixed>
double SmallErkStepper<fixed>::error_norm(double h) {
    double square = 0.0;
    for (std::size_t i = 0; i < size(); ++i) {
        double error = 0.0;
        for (std::size_t k = 0; k < tableau::stages; ++k)
            error += tableau::error_weights[k] * slopes_[k][i];
        errors_[i] = h * error * weights_[i];
        square += errors_[i] * errors_[i];
    }
    return strictness_ * std::sqrt(square / static_cast<double>(size()));
}

/// From the length of a step to that of the next: the standard controller. On pairs a PI controller needed
/// more steps, since many are cut short and have errors that tell little; a safety of 0.9 a third more in
/// stiff pursuits, where every other step was rejected.
template<std::size_t fixed>
double SmallErkStepper<fixed>::factor(double error) const {
    constexpr double safety = 0.8, least = 0.2, most = 5.0;
    if (!std::isfinite(error))
        return least;
    return std::clamp(safety * std::pow(error, -1.0 / tableau::order), least, most);
}

/// One that was cut short tells nothing against the length wanted.
template<std::size_t fixed>
void SmallErkStepper<fixed>::accept(double from, double to, double error) {
    after_ = end_; // the last stage is the end itself
    const double next = (to - from) * factor(error);
    step_ = to - from < step_ ? std::max(next, step_) : next;
    time_before_ = from;
    time_ = to;
    ++counts_.steps;
    fresh_ = calls_.projects();
    if (fresh_)
        calls_.project(of(after_));
}

template<std::size_t fixed>
void SmallErkStepper<fixed>::interpolate(double t, std::span<double> y) {
    dense_(*this, calls_, t, y, of(std::as_const(slopes_[0])),
           fresh_ ? State{} : of(std::as_const(slopes_[tableau::stages - 1])));
}

template<std::size_t fixed>
std::vector<double> SmallErkStepper<fixed>::weighted_errors() const {
    std::vector<double> errors;
    for (std::size_t i = 0; tried_ && i < size(); ++i)
        errors.push_back(std::abs(errors_[i]) / std::sqrt(static_cast<double>(size())));
    return errors;
}

} // namespace

std::unique_ptr<Stepper> make_small_erk_stepper(UserFunctions& calls, const OdeOptions& options,
                                                double end_time) {
    if (calls.problem().initial_state.size() == 6) // a pair of rods
        return std::make_unique<SmallErkStepper<6>>(calls, options, end_time);
    return std::make_unique<SmallErkStepper<0>>(calls, options, end_time);
}

} // namespace rodwake::integrate
