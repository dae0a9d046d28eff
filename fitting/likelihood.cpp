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

class LikelihoodProfile {
public:
    LikelihoodProfile(const Problem& problem, const Method& method, const Fit& best, std::size_t parameter)
        : problem_(problem), method_(method), best_(best), parameter_(parameter), space_(problem) {
        while (space_.free()[k_] != parameter)
            ++k_;
        measure();
    }

    LikelihoodPoint centre() const {
        const double value = best_.values[parameter_];
        return {space_.coordinate(k_, value), 0.0, value, best_.objective, best_.values};
    }

    /// At coordinate u, starting from a neighbour.
    LikelihoodPoint at(double u, const LikelihoodPoint& from) const {
        Problem held = problem_;
        LikelihoodPoint place{u, 0.0, space_.value(k_, u), {}, {}};
        for (std::size_t i = 0; i < held.parameters.size(); ++i)
            held.parameters[i].start = i == parameter_ ? place.value : from.values[i];
        held.parameters[parameter_].fixed = true;
        const SearchSpace others(held);
        Evaluator evaluator(held, others, {method_.loss, method_.loss_width}, method_.stop_requested);
        std::vector<double> start;
        for (const std::size_t i : others.free())
            start.push_back(from.values[i]);
        const SearchResult end = levenberg_marquardt(evaluator, others.coordinates(start));
        evaluator.require_memory();
        stopped_ = stopped_ || evaluator.stopped();
        place.objective = end.objective;
        place.values = others.values(end.u);
        place.z = std::sqrt(std::max(end.objective - best_.objective, 0.0) / rise_);
        return place;
    }

    bool stopped() const { return stopped_; }
    double error() const { return error_; }
    /// The last coordinate in this direction: the bound, or the limit.
    double end(int side) const {
        const double bound = side < 0 ? space_.lower()[k_] : space_.upper()[k_];
        const double centre_u = centre().u, reach = held_ ? HUGE_VAL : limit * error_;
        return side < 0 ? std::max(bound, centre_u - reach) : std::min(bound, centre_u + reach);
    }

private:
    /// The space without bounds of the parameter, in the same coordinates: on a bound it has an error there.
    static Problem unbounded(Problem problem, std::size_t parameter) {
        Parameter& p = problem.parameters[parameter];
        p.scale = natural_scale(p);
        p.upper = std::numeric_limits<double>::infinity();
        p.lower = p.transform == Transform::log ? 0.0 : -p.upper;
        return problem;
    }

    /// Standard error in u and rise of the objective for it; a tenth of a natural step where it is infinite,
    /// and no more than a natural one on a bound, where a logarithm may be far from what is regular.
    void measure() {
        const LossShape loss{method_.loss, method_.loss_width};
        Evaluator evaluator(problem_, space_, loss);
        std::vector<double> free;
        for (const std::size_t i : space_.free())
            free.push_back(best_.values[i]);
        const SearchPoint point = evaluator(space_.coordinates(free), true);
        evaluator.require_memory();
        if (!point.finite())
            throw RunError("fit: no profile likelihood: the residuals are not finite at the best values (" +
                           evaluator.trouble() + ")");
        const Problem open = unbounded(problem_, parameter_);
        held_ = point.u[k_] <= space_.lower()[k_] || point.u[k_] >= space_.upper()[k_];
        const Curvature c =
            curvature(SearchSpace(open), point, evaluator.gradient(point), ReportOptions{}.rank_tolerance);
        const ErrorScale scale = error_scale(problem_, loss, point, degrees_of_freedom(problem_));
        if (std::isfinite(scale.rise) && scale.rise > 0.0)
            rise_ = scale.rise;
        const double error = c.standard_error[k_] * scale.factor;
        error_ = std::isfinite(error) && error > 0.0 ? error : 0.1;
        if (held_)
            error_ = std::min(error_, 1.0);
    }

    const Problem& problem_;
    const Method& method_;
    const Fit& best_;
    std::size_t parameter_;
    SearchSpace space_;
    Eigen::Index k_ = 0;
    double error_ = 0.1, rise_ = 1.0;
    bool held_ = false; ///< by a bound
    mutable bool stopped_ = false;
};

/// Between neighbours below and above the threshold: Illinois' false position, to a millionth of the rise.
double crossing(const LikelihoodProfile& profile, LikelihoodPoint inside, const LikelihoodPoint& outside) {
    const double wanted = std::sqrt(threshold);
    double low = inside.z - wanted, high = outside.z - wanted, a = inside.u, b = outside.u;
    LikelihoodPoint nearest = inside;
    for (int i = 0; i < 40 && !profile.stopped(); ++i) {
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
std::vector<LikelihoodPoint> walk(const LikelihoodProfile& profile, int side, std::size_t steps) {
    std::vector<LikelihoodPoint> places{profile.centre()};
    const double end = profile.end(side), wanted = std::sqrt(far_enough) / static_cast<double>(steps);
    double step = wanted * profile.error();
    for (std::size_t i = 0; i < 8 * steps && places.back().z * places.back().z < far_enough; ++i) {
        const LikelihoodPoint& here = places.back();
        if (here.u == end || profile.stopped())
            break;
        const double to = here.u + side * step;
        LikelihoodPoint there = profile.at(side * (end - to) <= 0.0 ? end : to, here);
        const double climbed = std::abs(there.z - here.z);
        if (!std::isfinite(there.z) || climbed > 4.0 * wanted) {
            step *= 0.25;
            if (step > 1e-6 * std::min(profile.error(), 1.0)) // an error may be any number of natural steps
                continue;
            break;
        }
        places.push_back(std::move(there));
        step *= std::clamp(wanted / std::max(climbed, 1e-300), 0.5, 2.0);
    }
    return places;
}

std::optional<double> bound_of(const LikelihoodProfile& profile, const std::vector<LikelihoodPoint>& points) {
    const double wanted = std::sqrt(threshold);
    for (std::size_t i = 1; i < points.size(); ++i)
        if (points[i].z >= wanted && !profile.stopped()) {
            const double value = crossing(profile, points[i - 1], points[i]);
            return profile.stopped() ? std::nullopt : std::optional(value);
        }
    return {};
}

void check(const Problem& problem, std::size_t parameter) {
    validate(problem);
    if (parameter >= problem.parameters.size() || !problem.parameters[parameter].free())
        throw InputError(fmt::format("fit: no profile likelihood of parameter {}: it is not free",
                                     parameter < problem.parameters.size()
                                         ? problem.parameters[parameter].name
                                         : std::to_string(parameter)));
}

} // namespace

std::optional<double> one_sided_limit(const Problem& problem, const Fit& best, std::size_t parameter) {
    check(problem, parameter);
    Method method;
    method.loss = best.loss;
    method.loss_width = best.loss_width;
    const LikelihoodProfile profile(problem, method, best, parameter);
    const Parameter& p = problem.parameters[parameter];
    const double value = best.values[parameter];
    const int side = value - p.lower <= p.upper - value ? +1 : -1; // away from the nearer bound
    return bound_of(profile, walk(profile, side, 6));
}

ProfileLikelihood profile_likelihood(const Problem& problem, const Method& method, const Fit& best,
                                     std::size_t parameter, std::size_t points) {
    check(problem, parameter);
    const LikelihoodProfile profile(problem, method, best, parameter);
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
