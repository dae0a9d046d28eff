#include "diagnostics.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/fitting/report.hpp"
#include "search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rodwake::fitting {

namespace {

constexpr double threshold = 3.841459; // 95 % of chi2 with one degree of freedom
constexpr double far_enough = 6.0;
constexpr double limit = 1000.0; // standard errors

/// A point of the profile: the others re-optimised.
struct LikelihoodPoint {
    double u = 0.0; ///< coordinate of the parameter
    double z = 0.0; ///< sqrt of the rise of the objective, in units of its rise for one standard error
    double value = 0.0, objective = std::numeric_limits<double>::infinity();
    std::vector<double> values; ///< of all parameters: start of the neighbour's search
};

struct LikelihoodProfile {
    LikelihoodProfile(const Problem& problem, const Method& method, const Fit& best, std::size_t parameter);

    /// At coordinate u, starting from a neighbour.
    LikelihoodPoint at(double u, const LikelihoodPoint& from);

    const Problem& problem;
    const Method& method;
    const Fit& best;
    std::size_t parameter;
    SearchSpace space;
    LikelihoodPoint centre;
    double error = 0.1;  ///< standard error in u
    double rise = 1.0;   ///< of the objective for it
    double ends[2] = {}; ///< the last coordinates below and above: the bound, or the limit
    bool stopped = false;
};

LikelihoodProfile::LikelihoodProfile(const Problem& fitted, const Method& how, const Fit& end,
                                     std::size_t which)
    : problem(fitted), method(how), best(end), parameter(which), space(fitted) {
    validate(problem);
    if (parameter >= problem.parameters.size() || !problem.parameters[parameter].free())
        throw InputError(fmt::format("fit: no profile likelihood of parameter {}: it is not free",
                                     parameter < problem.parameters.size()
                                         ? problem.parameters[parameter].name
                                         : std::to_string(parameter)));
    const auto k = std::ranges::find(space.free, parameter) - space.free.begin();
    const LossShape loss{method.loss, method.loss_width};
    Evaluator evaluator(problem, space, loss);
    std::vector<double> free;
    for (const std::size_t i : space.free)
        free.push_back(best.values[i]);
    const SearchPoint point = evaluator(space.coordinates(free), true);
    evaluator.require_memory();
    if (!point.finite())
        throw RunError("fit: no profile likelihood: the residuals are not finite at the best values (" +
                       evaluator.trouble() + ")");

    // The curvature is taken without bounds of the parameter, in the same coordinates, so that on a bound it
    // has an error there. Where the error is infinite a tenth of a natural step stands for it, and on a
    // bound, where a logarithm may be far from what is regular, no more than a natural one.
    Problem open = problem;
    Parameter& p = open.parameters[parameter];
    p.scale = natural_scale(p);
    p.upper = std::numeric_limits<double>::infinity();
    p.lower = p.transform == Transform::log ? 0.0 : -p.upper;
    const bool held = point.u[k] <= space.lower[k] || point.u[k] >= space.upper[k];
    const Curvature c =
        curvature(SearchSpace(open), point, evaluator.gradient(point), ReportOptions{}.rank_tolerance);
    const ErrorScale scale = error_scale(problem, loss, point, degrees_of_freedom(problem));
    if (std::isfinite(scale.rise) && scale.rise > 0.0)
        rise = scale.rise;
    if (const double size = c.standard_error[k] * scale.factor; std::isfinite(size) && size > 0.0)
        error = size;
    if (held)
        error = std::min(error, 1.0);
    const double value = best.values[parameter], reach = held ? HUGE_VAL : limit * error;
    centre = {space.coordinate(k, value), 0.0, value, best.objective, best.values};
    ends[0] = std::max(space.lower[k], centre.u - reach);
    ends[1] = std::min(space.upper[k], centre.u + reach);
}

LikelihoodPoint LikelihoodProfile::at(double u, const LikelihoodPoint& from) {
    Problem held = problem;
    const auto k = std::ranges::find(space.free, parameter) - space.free.begin();
    LikelihoodPoint point{u, 0.0, space.value(k, u), {}, {}};
    for (std::size_t i = 0; i < held.parameters.size(); ++i)
        held.parameters[i].start = i == parameter ? point.value : from.values[i];
    held.parameters[parameter].fixed = true;
    const SearchSpace others(held);
    Evaluator evaluator(held, others, {method.loss, method.loss_width}, method.stop_requested);
    std::vector<double> start;
    for (const std::size_t i : others.free)
        start.push_back(from.values[i]);
    const SearchResult end = levenberg_marquardt(evaluator, others.coordinates(start));
    evaluator.require_memory();
    stopped = stopped || evaluator.stopped();
    point.objective = end.objective;
    point.values = others.values(end.u);
    point.z = std::sqrt(std::max(end.objective - best.objective, 0.0) / rise);
    return point;
}

/// Between neighbours below and above the threshold: Illinois' false position, to a millionth of the rise.
double crossing(LikelihoodProfile& profile, LikelihoodPoint inside, const LikelihoodPoint& outside) {
    const double wanted = std::sqrt(threshold);
    double low = inside.z - wanted, high = outside.z - wanted, a = inside.u, b = outside.u;
    LikelihoodPoint nearest = inside;
    for (int i = 0; i < 40 && !profile.stopped; ++i) {
        const double u = std::isfinite(high) ? a + (b - a) * low / (low - high) : 0.5 * (a + b);
        nearest = profile.at(u, nearest.values.empty() || !std::isfinite(nearest.z) ? inside : nearest);
        const double off = nearest.z - wanted;
        if (std::abs(off) < 1e-7 || std::abs(b - a) <= 1e-12 * std::abs(b))
            return nearest.value;
        if (off < 0.0) {
            inside = nearest;
            a = u;
            low = off;
            high *= std::isfinite(high) ? 0.5 : 1.0;
        } else {
            b = u;
            high = off;
            low *= 0.5;
        }
    }
    return nearest.value;
}

/// Outward until the objective has risen enough, a bound or the limit is reached. The first is the centre.
std::vector<LikelihoodPoint> walk(LikelihoodProfile& profile, int side, std::size_t steps) {
    std::vector<LikelihoodPoint> places{profile.centre};
    const double end = profile.ends[side < 0 ? 0 : 1],
                 wanted = std::sqrt(far_enough) / static_cast<double>(steps);
    double step = wanted * profile.error;
    for (std::size_t i = 0; i < 8 * steps && places.back().z * places.back().z < far_enough; ++i) {
        const LikelihoodPoint& here = places.back();
        if (here.u == end || profile.stopped)
            break;
        const double to = here.u + side * step;
        LikelihoodPoint there = profile.at(side * (end - to) <= 0.0 ? end : to, here);
        const double climbed = std::abs(there.z - here.z);
        if (!std::isfinite(there.z) || climbed > 4.0 * wanted) {
            step *= 0.25;
            if (step > 1e-6 * std::min(profile.error, 1.0)) // an error may be any number of natural steps
                continue;
            break;
        }
        places.push_back(std::move(there));
        step *= std::clamp(wanted / std::max(climbed, 1e-300), 0.5, 2.0);
    }
    return places;
}

std::optional<double> bound_of(LikelihoodProfile& profile, const std::vector<LikelihoodPoint>& points) {
    const double wanted = std::sqrt(threshold);
    for (std::size_t i = 1; i < points.size(); ++i)
        if (points[i].z >= wanted && !profile.stopped) {
            const double value = crossing(profile, points[i - 1], points[i]);
            return profile.stopped ? std::nullopt : std::optional(value);
        }
    return {};
}

} // namespace

std::optional<double> one_sided_limit(const Problem& problem, const Fit& best, std::size_t parameter) {
    Method method;
    method.loss = best.loss;
    method.loss_width = best.loss_width;
    LikelihoodProfile profile(problem, method, best, parameter);
    const Parameter& p = problem.parameters[parameter];
    const double value = best.values[parameter];
    const int side = value - p.lower <= p.upper - value ? +1 : -1; // away from the nearer bound
    return bound_of(profile, walk(profile, side, 6));
}

ProfileLikelihood profile_likelihood(const Problem& problem, const Method& method, const Fit& best,
                                     std::size_t parameter, std::size_t points) {
    LikelihoodProfile profile(problem, method, best, parameter);
    const std::size_t steps = std::max<std::size_t>(points / 2, 2);
    const std::vector<LikelihoodPoint> down = walk(profile, -1, steps), up = walk(profile, +1, steps);
    ProfileLikelihood result;
    result.parameter = parameter;
    result.low = bound_of(profile, down);
    result.high = bound_of(profile, up);
    for (auto position = down.rbegin(); position != down.rend(); ++position) {
        result.value.push_back(position->value);
        result.chi2.push_back(position->objective);
    }
    for (std::size_t i = 1; i < up.size(); ++i) {
        result.value.push_back(up[i].value);
        result.chi2.push_back(up[i].objective);
    }
    return result;
}

} // namespace rodwake::fitting
