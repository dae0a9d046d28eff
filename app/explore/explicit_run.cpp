#include "explicit_run.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/integrate/dormand_prince.hpp"
#include "rodwake/rods/classify_outcome.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace rodwake::app {

namespace {

using Numbers = std::vector<double>;

/// Where a trial step ends.
struct TrialStep {
    Numbers y, rates;
    double error = 0.0; ///< over the tolerance
};

class PageWake final : public elastic::Wake {
public:
    explicit PageWake(const elastic::Medium& medium) : field_(medium) {}
    elastic::FieldValues at(double x, double y, elastic::FieldRequest request) const override {
        return field_.at(x, y, request);
    }
    elastic::MediumDerivatives medium_derivatives(double, double, elastic::FieldRequest) const override {
        throw InputError("these wakes have no derivatives by the medium");
    }

private:
    elastic::Field field_;
};

class PlaneWakes final : public elastic::WakeField {
public:
    explicit PlaneWakes(const elastic::Medium& medium)
        : medium_(medium), wake_(std::make_shared<const PageWake>(medium)) {}
    elastic::FieldCapabilities capabilities() const override { return {.medium_derivatives = false}; }
    const elastic::Medium& medium() const override { return medium_; }
    std::shared_ptr<const elastic::Wake> wake(double /*heading*/) const override { return wake_; }

private:
    elastic::Medium medium_;
    std::shared_ptr<const elastic::Wake> wake_;
};

class ExplicitRun {
public:
    ExplicitRun(const rods::RodProblem& problem, double rtol)
        : problem_(problem), rtol_(rtol), t_end_(problem.t_end), late_from_(0.8 * problem.t_end),
          model_(model_on_plane(problem)), y_(rods::to_state(problem.rods)), rates_(rates(y_)),
          record_(rods::start_record(y_, late_from_)) {}

    rods::RodOutcome run(long max_attempts, const OnRow& on_row) {
        on_row(time_, y_, rates_);
        for (long tried = 0; !ended_; ++tried) {
            if (tried == max_attempts)
                throw too_stiff(max_attempts, time_);
            if (advance())
                on_row(time_, y_, rates_);
        }
        if (!problem_.contact_distance && problem_.rods.size() > 1 && model_.interacting()) {
            const double first = rods::closest_pair(rods::to_state(problem_.rods)).distance;
            if (record_.smallest.distance <= rods::passing_resolution(y_, first, 1.01 * rtol_))
                throw RunError("the rods pass through each other, where their fields are singular: set "
                               "contact_distance, so that the run stops when they meet");
        }
        integrate::Solution solution;
        solution.final_time = time_;
        solution.final_state = y_;
        if (contact_)
            solution.status.termination = integrate::Termination::stopped_at_event;
        return rods::classify_outcome(problem_, model_.interacting(), state_rates(), solution, record_, {},
                                      rods::TurnedBy::steady_wakes);
    }

private:
    Numbers rates(integrate::State y) const {
        Numbers ydot(y.size());
        model_.rhs(y, ydot);
        return ydot;
    }

    rods::StateRates state_rates() const {
        return [this](integrate::State y, std::span<double> ydot) { model_.rhs(y, ydot); };
    }

    TrialStep trial(double h) const {
        const std::size_t size = y_.size();
        std::array<Numbers, 7> k;
        k[0] = rates_;
        TrialStep end;
        for (int stage = 1; stage < 7; ++stage) {
            end.y = y_;
            for (int s = 0; s < stage; ++s)
                for (std::size_t i = 0; i < size; ++i)
                    end.y[i] += h * integrate::stage_weights[stage][s] * k[s][i];
            k[stage] = rates(end.y);
        }
        double square = 0.0;
        const double atol = 0.01 * rtol_;
        for (std::size_t i = 0; i < size; ++i) {
            double error = 0.0;
            for (int s = 0; s < 7; ++s)
                error += h * integrate::error_weights[s] * k[s][i];
            const double tolerance = rtol_ * std::min(std::max(std::abs(y_[i]), std::abs(end.y[i])), 1.0);
            square += std::pow(error / (tolerance + atol), 2);
        }
        end.error = std::sqrt(square);
        end.rates = std::move(k[6]);
        return end;
    }

    double gap(integrate::State y) const {
        return problem_.rods.size() < 2 || !problem_.contact_distance
                   ? HUGE_VAL
                   : rods::closest_pair(y).distance - *problem_.contact_distance;
    }

    /// One attempted step; false: it is to be tried again, shorter.
    bool advance() {
        const double target = time_ < late_from_ ? late_from_ : t_end_, rest = target - time_;
        double limit = problem_.rods.size() > 1 ? rods::encounter_step(y_) : HUGE_VAL;
        if (problem_.medium && !rods::has_wide_wakes(*problem_.medium))
            limit = std::min(limit, rods::wake_step(y_, *problem_.medium));
        double h = std::min({step_, limit, rest});
        if (!(time_ + h > time_))
            throw RunError(fmt::format("steps became too small to add to t = {:.6g}", time_));
        TrialStep end = trial(h);
        const double factor = std::clamp(0.8 * std::pow(std::max(end.error, 1e-10), -0.2), 0.2, 5.0);
        if (!(end.error <= 1.0)) {
            step_ = h * (std::isfinite(end.error) ? factor : 0.2);
            return false;
        }
        // A step within which the rods meet is shortened until its end lies on the contact.
        double inside = h, outside = 0.0;
        if (gap(end.y) > 0.0 && problem_.contact_distance)
            if (const auto dip =
                    rods::first_approach_time({time_, time_ + h, y_, end.y}, {}, *problem_.contact_distance))
                inside = std::min(*dip - time_, h);
        if (inside < h)
            end = trial(inside);
        if (gap(end.y) <= 0.0) {
            for (int k = 0; k < 60 && inside - outside > 1e-14; ++k) {
                const double middle = 0.5 * (outside + inside);
                (gap(trial(middle).y) > 0.0 ? outside : inside) = middle;
            }
            h = inside;
            end = trial(h);
            contact_ = true;
        } else if (inside < h) {
            h = inside; // a closest approach, not quite as near
        }
        const bool to_target = h >= rest;
        step_ = to_target ? std::max(step_, h * factor) : h * factor;
        const double time = to_target ? target : time_ + h;
        if (problem_.rods.size() > 1)
            rods::add_step(record_, {time_, time, y_, end.y}, state_rates());
        time_ = time;
        y_ = std::move(end.y);
        rates_ = std::move(end.rates);
        ended_ = contact_ || time_ >= t_end_;
        return true;
    }

    const rods::RodProblem& problem_;
    double rtol_, t_end_, late_from_;
    rods::RodModel model_;
    double time_ = 0.0, step_ = 0.01; // as rods::simulate takes
    Numbers y_, rates_;
    rods::SeparationRecord record_;
    bool ended_ = false, contact_ = false;
};

} // namespace

rods::RodModel model_on_plane(const rods::RodProblem& problem) {
    const bool interacting = problem.couplings.any() && problem.medium;
    return {interacting ? std::make_shared<const PlaneWakes>(*problem.medium) : nullptr, problem.couplings,
            problem.rods.size()};
}

RunError too_stiff(long attempts, double time) {
    return RunError(fmt::format("more than {} steps by t = {:.6g}: too stiff for an explicit "
                                "method; rodwake rods solves it",
                                attempts, time));
}

rods::RodOutcome explicit_run(const rods::RodProblem& problem, double rtol, long max_attempts,
                              const OnRow& on_row) {
    if (const auto met = rods::contact_at_start(problem)) {
        const Numbers y = rods::to_state(problem.rods);
        on_row(0.0, y, Numbers(y.size()));
        return met->outcome;
    }
    rods::validate(problem);
    return ExplicitRun(problem, rtol).run(max_attempts, on_row);
}

} // namespace rodwake::app
