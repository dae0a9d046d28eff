#include "scan_rods.hpp"

#include "rodwake/core/error.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>

namespace rodwake::stages {

namespace {

using Clock = std::chrono::steady_clock;
using assembly::OutputUnits;
using integrate::Method;
using integrate::Termination;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Who was ahead of two rods when they had turned most: the other is the rear one. As measure/pairs.hpp says
/// for tracks.
class Leader {
public:
    explicit Leader(const rods::RodProblem& problem)
        : first_(rods::to_state(problem.rods)), box_(problem.box) {}

    void add(integrate::State y) {
        const double turned = std::abs(y[2] - first_[2]) + std::abs(y[5] - first_[5]);
        if (turned <= most_)
            return;
        most_ = turned;
        // moved since the start, so that images in a box do not matter
        ahead_x_ = y[0] - y[3] - first_[0] + first_[3];
        ahead_y_ = y[1] - y[4] - first_[1] + first_[4];
    }

    /// (|turn of the rear rod| - |turn of the front rod|)/(their sum); NaN without a common heading, or if
    /// nobody turned.
    double non_reciprocity(const std::vector<double>& turn) const {
        const rods::Offset d = rods::offset(first_, 0, 1, box_);
        const PairCourse course(first_[2], first_[5], d.x, d.y);
        if (!course.common())
            return std::nan("");
        const std::size_t front = course.ahead(d.x + ahead_x_, d.y + ahead_y_) >= 0.0 ? 0 : 1;
        const double of_front = std::abs(turn[front]), of_rear = std::abs(turn[1 - front]);
        constexpr double nothing = 1e-9; // rad
        return of_front + of_rear > nothing ? (of_rear - of_front) / (of_rear + of_front) : std::nan("");
    }

private:
    std::vector<double> first_;
    rods::Box box_;
    double most_ = 0.0, ahead_x_ = 0.0, ahead_y_ = 0.0;
};

/// The ladder of retries: changes the options for the attempt after number `rung`; false: none left.
bool next_rung(integrate::OdeOptions& ode, int rung) {
    switch (rung) {
    case 0:
        ode.max_steps *= 10;
        return true;
    case 1:
        ode.rtol = std::max(0.1 * ode.rtol, 1e-13);
        ode.atol *= 0.1;
        return true;
    case 2:
        ode.method = ode.method == Method::bdf ? Method::adams : Method::bdf;
        return true;
    default:
        return false;
    }
}

/// The order of assembly::ScanPlan's columns.
class Values {
public:
    explicit Values(scan::Result& result) : values_(result.values) {}

    Values& operator<<(double value) {
        values_[next_++] = value;
        return *this;
    }

private:
    std::array<double, scan::max_observables>& values_;
    std::size_t next_ = 0;
};

/// How the rods of a pair stand at the end; of more rods the pair that the outcome is about.
struct End {
    double separation = 0.0, angle = 0.0;
};

End end_of(integrate::State y, const rods::Separation& pair, const rods::Box& box) {
    const rods::Offset d = rods::offset(y, pair.first, pair.second, box);
    return {std::hypot(d.x, d.y), angle_between(y[3 * pair.first + 2], y[3 * pair.second + 2])};
}

class PointOfRods {
public:
    PointOfRods(const assembly::ScanPlan& plan, const OutputUnits& units, const std::function<bool()>& stop)
        : plan_(plan), units_(units), stop_(stop), scene_(plan.base) {}

    void evaluate(const scan::Point& point, scan::Result& result) {
        const auto start = Clock::now();
        result.point = point;
        try {
            if (const auto wrong = assembly::set_point(plan_, scene_, point))
                throw InputError(*wrong);
            const rods::RodProblem problem = assembly::rod_problem(scene_);
            if (!starts_in_contact(problem, result))
                climb(problem, result, start);
        } catch (const std::exception& error) {
            result.status = scan::Status::exception;
            result.set_cause(describe(error));
        }
        result.seconds = seconds_since(start);
    }

private:
    void climb(const rods::RodProblem& problem, scan::Result& result, Clock::time_point start) {
        rods::RodOptions options = assembly::rod_options(*scene_.rods_run, problem);
        options.ode.stop_requested = stop_condition(start);
        std::string causes;
        for (result.retries = 0;; ++result.retries) {
            attempt(problem, options, result, start);
            const bool hopeless = result.status == scan::Status::ok ||
                                  result.status == scan::Status::time_limit ||
                                  result.status == scan::Status::stopped;
            if (!result.ok() && !causes.ends_with(result.cause_text())) // a retry may fail alike
                causes += (causes.empty() ? "" : "; ") + std::string(result.cause_text());
            if (hopeless || !next_rung(options.ode, result.retries))
                break;
        }
        result.set_cause(causes);
    }

    std::function<bool()> stop_condition(Clock::time_point start) const {
        const double limit = plan_.time_limit.value_or(HUGE_VAL);
        if (limit == HUGE_VAL && !stop_)
            return nullptr;
        return [this, start, limit] { return (stop_ && stop_()) || seconds_since(start) > limit; };
    }

    void attempt(const rods::RodProblem& problem, rods::RodOptions options, scan::Result& result,
                 Clock::time_point start) const {
        Leader leader(problem);
        if (problem.rods.size() == 2)
            options.ode.on_step = [&](const integrate::Step& step) { leader.add(step.state); };
        const rods::RodResult run = rods::simulate(problem, options);
        const integrate::Status& status = run.solution.status;
        if (status.termination == Termination::interrupted) {
            const bool late = seconds_since(start) > plan_.time_limit.value_or(HUGE_VAL);
            result.status = late ? scan::Status::time_limit : scan::Status::stopped;
            result.set_cause(fmt::format("{:g} s were up at t = {:.4g}", plan_.time_limit.value_or(0.0),
                                         status.reached * units_.time));
            return;
        }
        if (!status.ok()) {
            result.status = scan::Status::failed;
            result.set_cause(status.flag + ": " + status.cause);
            return;
        }
        store(problem, run, leader, result);
    }

    void store(const rods::RodProblem& problem, const rods::RodResult& run, const Leader& leader,
               scan::Result& result) const {
        const rods::RodOutcome& outcome = run.outcome;
        const End end = end_of(run.solution.final_state, outcome.pair, problem.box);
        result.status = scan::Status::ok;
        result.outcome = static_cast<std::int32_t>(outcome.ending);
        Values values(result);
        values << outcome.time * units_.time << outcome.min_separation * units_.length
               << outcome.min_separation_time * units_.time;
        for (std::size_t rod = 0; rod < std::min<std::size_t>(outcome.turn.size(), 8); ++rod)
            values << outcome.turn[rod];
        values << (problem.rods.size() == 2 ? leader.non_reciprocity(outcome.turn) : std::nan(""))
               << end.separation * units_.length << end.angle
               << static_cast<double>(run.solution.statistics.steps)
               << static_cast<double>(run.solution.statistics.rhs_evaluations);
        for (std::size_t k = 0; k < plan_.columns.observables.size(); ++k)
            if (const std::string& name = plan_.columns.observables[k];
                !std::isfinite(result.values[k]) && name != "non_reciprocity") { // which may have no value
                result.status = scan::Status::not_finite;
                result.set_cause(name + " is not finite");
            }
    }

    bool starts_in_contact(const rods::RodProblem& problem, scan::Result& result) const {
        const std::vector<double> y = rods::to_state(problem.rods);
        const rods::Separation pair = rods::closest_pair(y, problem.box);
        if (pair.distance > problem.contact_distance.value_or(0.0))
            return false;
        const End end = end_of(y, pair, problem.box);
        result.outcome = static_cast<std::int32_t>(Ending::contact);
        Values values(result);
        values << 0.0 << pair.distance * units_.length << 0.0;
        for (std::size_t rod = 0; rod < std::min<std::size_t>(problem.rods.size(), 8); ++rod)
            values << 0.0;
        values << std::nan("") << end.separation * units_.length << end.angle << 0.0 << 0.0;
        return true;
    }

    const assembly::ScanPlan& plan_;
    const OutputUnits& units_;
    const std::function<bool()>& stop_;
    scene::Scene scene_;
};

} // namespace

scan::Evaluate evaluate_rods(const assembly::ScanPlan& plan, std::function<bool()> stop) {
    return [&plan, units = assembly::output_units(plan.base),
            stop = std::move(stop)](std::span<const scan::Point> points, std::span<scan::Result> results) {
        PointOfRods one(plan, units, stop);
        for (std::size_t i = 0; i < points.size(); ++i)
            one.evaluate(points[i], results[i]);
    };
}

rods::RodResult trajectory_of(const assembly::ScanPlan& plan, const scan::Result& result, std::size_t times) {
    scene::Scene scene = plan.base;
    if (const auto wrong = assembly::set_point(plan, scene, result.point))
        throw InputError(*wrong);
    rods::RodProblem problem = assembly::rod_problem(scene);
    const double end = result.values[0] / assembly::output_units(plan.base).time;
    problem.output_times.clear();
    for (std::size_t i = 0; i + 1 < times; ++i)
        problem.output_times.push_back(end * static_cast<double>(i) / static_cast<double>(times - 1));
    rods::RodOptions options = assembly::rod_options(*scene.rods_run, problem);
    for (int rung = 0; rung < result.retries; ++rung) // as the attempt that succeeded
        next_rung(options.ode, rung);
    return rods::simulate(problem, options);
}

} // namespace rodwake::stages
