// The rate at which rods leave the unstable fixed point that lies on a separatrix.

#include "critical_encounters.hpp"
#include "rodwake/measure/statistics.hpp"
#include "rodwake/rods/pair_equilibria.hpp"
#include "rodwake/rods/settled_orbit.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

namespace rodwake::app {

Path follow(Encounters& encounters, const Encounter& one) {
    rods::RodProblem problem = encounters.problem_at(one.at);
    problem.t_end = std::max(problem.t_end, one.time);
    problem.output_times.clear();
    rods::RodOptions options = encounters.options(problem);
    Path path;
    options.ode.on_step = [&](const integrate::Step& step) {
        const rods::Pose pose = rods::pose_seen_from(rods::pose(step.state, 0), rods::pose(step.state, 1));
        path.times.push_back(step.time);
        path.separations.push_back(std::hypot(pose.x, pose.y));
        path.poses.push_back(pose);
    };
    encounters.run(problem, options);
    return path;
}

namespace {

/// The pose at which rods on both sides of a separatrix linger before they part: the slowest of their common
/// way, which ends where the two separations differ by a tenth.
std::optional<rods::Pose> lingering_pose(const rods::RodProblem& problem, const Path& low, const Path& high) {
    const auto separation = [](const Path& path, double time) {
        const auto at = std::ranges::lower_bound(path.times, time);
        if (at == path.times.end())
            return path.separations.back();
        const auto k = static_cast<std::size_t>(at - path.times.begin());
        return k == 0 ? path.separations[0]
                      : std::lerp(path.separations[k - 1], path.separations[k],
                                  (time - path.times[k - 1]) / (path.times[k] - path.times[k - 1]));
    };
    std::optional<rods::Pose> slowest;
    double least = HUGE_VAL;
    for (std::size_t i = 0; i < low.times.size(); ++i) {
        if (std::abs(separation(high, low.times[i]) / low.separations[i] - 1.0) > 0.1)
            break;
        const Eigen::Vector3d rates = rods::pair_flow(*problem.medium, problem.couplings, low.poses[i]).rates;
        const double speed =
            std::hypot(rates[0] / low.separations[i], rates[1] / low.separations[i], rates[2]);
        if (speed < least) {
            least = speed;
            slowest = low.poses[i];
        }
    }
    return slowest;
}

/// An unstable fixed point: its separation, and the rate at which rods leave it.
struct Saddle {
    rods::Pose pose;
    double separation, rate;
};

/// When the separation first differs by a tenth from the fixed point's, after the rods came closest to it.
std::optional<double> departure_time(const Path& path, const Saddle& saddle) {
    std::size_t closest = 0;
    double least = HUGE_VAL;
    for (std::size_t i = 0; i < path.times.size(); ++i) {
        const rods::Pose& pose = path.poses[i];
        const double away = std::hypot(
            (pose.x - saddle.pose.x) / saddle.separation, (pose.y - saddle.pose.y) / saddle.separation,
            std::remainder(pose.heading - saddle.pose.heading, 2.0 * std::numbers::pi));
        if (away < least)
            least = away, closest = i;
    }
    const auto off = [&](std::size_t i) {
        return std::abs(path.separations[i] / saddle.separation - 1.0) - 0.1;
    };
    for (std::size_t i = closest + 1; i < path.times.size(); ++i)
        if (off(i) > 0.0 && off(i - 1) <= 0.0)
            return std::lerp(path.times[i - 1], path.times[i], off(i - 1) / (off(i - 1) - off(i)));
    return std::nullopt;
}

} // namespace

std::optional<Departure> departure(Encounters& encounters, Bracket bracket) {
    const rods::RodProblem problem = encounters.problem_at(bracket.low.at);
    if (!has_fixed_points(problem))
        return std::nullopt;
    const auto pose =
        lingering_pose(problem, follow(encounters, bracket.low), follow(encounters, bracket.high));
    if (!pose)
        return std::nullopt;
    std::optional<Saddle> saddle;
    const double distance = std::hypot(pose->x, pose->y);
    if (const auto found = rods::equilibrium_near(*problem.medium, problem.couplings, *pose))
        saddle = Saddle{found->pose, found->separation[0], found->eigenvalues[0].real()};
    else if (std::abs(pose->y) <= 0.1 * distance && std::abs(pose->heading) <= 0.1) {
        const auto in_line = rods::in_line_eigenvalues(*problem.medium, problem.couplings, distance);
        saddle = Saddle{{pose->x, 0.0, 0.0}, distance, in_line[0].real()};
    }
    if (!saddle || !(saddle->rate > 0.0))
        return std::nullopt;

    const double scale = std::max(std::abs(bracket.low.at), std::abs(bracket.high.at));
    while (bracket.width() > 4e-16 * scale) { // the times of the last decades need all digits
        const double middle = std::midpoint(bracket.low.at, bracket.high.at);
        if (middle <= bracket.low.at || middle >= bracket.high.at)
            break;
        const Encounter one = encounters.at(middle);
        if (one.ending == Ending::undecided)
            return std::nullopt;
        bracket.take(one);
    }
    std::vector<double> logs, times;
    const double root = std::midpoint(bracket.low.at, bracket.high.at);
    for (int decade = 5; decade <= 12; ++decade) { // farther out the flow is not linear at the fixed point
        const double step = scale * std::pow(10.0, -decade);
        const auto time = departure_time(follow(encounters, encounters.at(root + step)), *saddle);
        if (time) {
            logs.push_back(-std::log(step));
            times.push_back(*time);
        }
    }
    if (times.size() < 3)
        return Departure{root, saddle->rate, std::nan("")};
    const std::vector<double> alike(times.size(), 1.0);
    const double slope = measure::fit_line(logs, times, alike).slope.value;
    return Departure{root, saddle->rate, std::abs(1.0 / slope - saddle->rate)};
}

} // namespace rodwake::app
