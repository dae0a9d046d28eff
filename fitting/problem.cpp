#include "rodwake/fitting/problem.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/fitting/trajectory.hpp"
#include "rodwake/fitting/wake.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>

namespace rodwake::fitting {

namespace {

const Parameter* find(const Problem& problem, const std::string& name) {
    const auto found = std::ranges::find(problem.parameters, name, &Parameter::name);
    return found == problem.parameters.end() ? nullptr : &*found;
}

void check(const Problem& problem, const Parameter& p) {
    if (!std::isfinite(p.start))
        throw InputError(fmt::format("fit: the start of {} is not a finite number", p.name));
    if (!(p.scale >= 0.0) || !std::isfinite(p.scale))
        throw InputError(
            fmt::format("fit: the scale of {} is {}: must be above 0, or 0 to choose", p.name, p.scale));
    if (!p.tied_to.empty()) {
        if (p.fixed)
            throw InputError(
                fmt::format("fit: {} is both fixed and tied to {}: choose one", p.name, p.tied_to));
        const Parameter* to = find(problem, p.tied_to);
        if (!to || !to->free())
            throw InputError(fmt::format("fit: {} is tied to {}, which is {}: must be a free parameter",
                                         p.name, p.tied_to, to ? "not free itself" : "no parameter"));
        if (!std::isfinite(p.tie_factor))
            throw InputError(fmt::format("fit: the factor that ties {} is not a finite number", p.name));
    }
    if (!p.free())
        return;
    if (std::isnan(p.lower) || std::isnan(p.upper))
        throw InputError(fmt::format("fit: a bound of {} is not a number", p.name));
    if (p.lower > p.upper)
        throw InputError(fmt::format("fit: bounds of {} are reversed: [{}, {}]", p.name, p.lower, p.upper));
    if (p.lower == p.upper)
        throw InputError(
            fmt::format("fit: both bounds of {} are {}: to hold it there, fix it", p.name, p.lower));
    if (p.start < p.lower || p.start > p.upper)
        throw InputError(fmt::format("fit: {} starts at {}, outside its bounds [{}, {}]", p.name, p.start,
                                     p.lower, p.upper));
    if (p.transform == Transform::log) {
        // A log parameter without a lower bound has the whole positive axis.
        if (p.start <= 0.0)
            throw InputError(
                fmt::format("fit: {} is searched in the logarithm, so its start must be above 0, not {}",
                            p.name, p.start));
        if (std::isfinite(p.lower) && p.lower <= 0.0)
            throw InputError(fmt::format(
                "fit: {} is searched in the logarithm, so its lower bound must be above 0, not {}", p.name,
                p.lower));
    }
}

} // namespace

void validate(const Problem& problem) {
    for (std::size_t i = 0; i < problem.parameters.size(); ++i) {
        const std::string& name = problem.parameters[i].name;
        if (name.empty())
            throw InputError(fmt::format("fit: parameter {} has no name", i));
        if (find(problem, name) != &problem.parameters[i])
            throw InputError(fmt::format("fit: two parameters are called \"{}\"", name));
    }
    for (const Parameter& p : problem.parameters)
        check(problem, p);
    if (!problem.evaluate)
        throw InputError("fit: the problem has no function that gives its residuals");
    if (!(problem.independent > 0.0 && problem.independent <= 1.0))
        throw InputError(
            fmt::format("fit: independent = {}: a residual is worth more than 0 and at most 1 value",
                        problem.independent));
    const std::size_t free = free_parameters(problem).size();
    if (problem.residuals == 0 || problem.residuals < free)
        throw InputError(fmt::format("fit: {} data points cannot fix {} parameters: give more data or fix "
                                     "some of the parameters",
                                     problem.residuals, free));
}

std::size_t data_count(const Problem& problem) { return problem.residuals - problem.log_scales; }

double chi2_of(const Problem& problem, const Eigen::VectorXd& residuals) {
    return residuals.head(static_cast<Eigen::Index>(data_count(problem))).squaredNorm();
}

long independent_values(const Problem& problem) {
    return std::lround(problem.independent * static_cast<double>(data_count(problem)));
}

long degrees_of_freedom(const Problem& problem) {
    return independent_values(problem) - static_cast<long>(free_parameters(problem).size());
}

std::vector<std::size_t> free_parameters(const Problem& problem) {
    std::vector<std::size_t> free;
    for (std::size_t i = 0; i < problem.parameters.size(); ++i)
        if (problem.parameters[i].free())
            free.push_back(i);
    return free;
}

std::vector<double> all_values(const Problem& problem, std::span<const double> free) {
    std::vector<double> values(problem.parameters.size());
    for (std::size_t i = 0, next = 0; i < values.size(); ++i)
        values[i] = problem.parameters[i].free() ? free[next++] : problem.parameters[i].start;
    for (std::size_t i = 0; i < values.size(); ++i)
        if (const Parameter& p = problem.parameters[i]; !p.tied_to.empty())
            values[i] = p.tie_factor * values[find(problem, p.tied_to) - problem.parameters.data()];
    return values;
}

// How many independent values there are in data of which neighbours share noise.

namespace {

using Range = std::pair<std::size_t, std::size_t>;

/// Runs one after the other; rows in no order, of which stretches are short, are one.
std::vector<Range> runs_in(std::span<const double> positions) {
    constexpr std::size_t shortest = 4; // in random order a stretch has 2 to 3 rows
    // Rows between turns of the direction in which the places go.
    std::vector<Range> all;
    std::size_t first = 0;
    int direction = 0;
    for (std::size_t i = 1; i < positions.size(); ++i) {
        const int step = (positions[i] > positions[i - 1]) - (positions[i] < positions[i - 1]);
        if (step != 0 && step == -direction) {
            all.emplace_back(first, i);
            first = i;
            direction = 0;
        } else if (step != 0) {
            direction = step;
        }
    }
    all.emplace_back(first, positions.size());
    return shortest * all.size() > positions.size() ? std::vector<Range>{{0, positions.size()}} : all;
}

} // namespace

std::vector<double> independent_worth(std::span<const double> positions, double spacing) {
    std::vector<double> worth(positions.size(), 1.0);
    if (positions.empty())
        return worth;
    for (const auto& [first, last] : runs_in(positions)) {
        std::vector<std::size_t> order(last - first);
        std::iota(order.begin(), order.end(), first);
        std::ranges::sort(order, {}, [&](std::size_t row) { return positions[row]; });
        std::size_t low = 0, high = 0; // the rows closer than `spacing` are [low, high)
        for (const std::size_t row : order) {
            while (positions[row] - positions[order[low]] >= spacing)
                ++low;
            while (high < order.size() && positions[order[high]] - positions[row] < spacing)
                ++high;
            const auto count = static_cast<double>(high - low);
            const double span = positions[order[high - 1]] - positions[order[low]];
            worth[row] =
                count < 2.0 ? 1.0 : std::min(1.0, std::max(span / (spacing * (count - 1.0)), 1.0 / count));
        }
    }
    return worth;
}

std::vector<Series> series_of(const Problem& problem) {
    if (!problem.series.empty())
        return problem.series;
    Series all{"the data", "values", std::vector<std::size_t>(data_count(problem))};
    std::iota(all.residuals.begin(), all.residuals.end(), std::size_t{0});
    return {all};
}

double mean_worth(std::span<const double> worth) {
    return std::accumulate(worth.begin(), worth.end(), 0.0) / static_cast<double>(worth.size());
}

// Several kinds of data as one problem.

namespace {

/// One of the problems, and which parameter of the whole each of its parameters is.
struct ProblemPart {
    Problem problem;
    std::vector<std::size_t> index;
    std::size_t first_residual = 0;
};

std::size_t slot_of(const Parameter& parameter, std::vector<Parameter>& all) {
    const auto found = std::ranges::find(all, parameter.name, &Parameter::name);
    if (found == all.end()) {
        all.push_back(parameter);
        return all.size() - 1;
    }
    if (!(found->start == parameter.start && found->lower == parameter.lower &&
          found->upper == parameter.upper && found->transform == parameter.transform &&
          found->scale == parameter.scale && found->fixed == parameter.fixed &&
          found->tied_to == parameter.tied_to && found->tie_factor == parameter.tie_factor))
        throw InputError(
            fmt::format("fit: parameter {} has another start, bounds, scale or tie in one kind of "
                        "data than in the other; it must be the same",
                        parameter.name));
    return static_cast<std::size_t>(found - all.begin());
}

} // namespace

Problem joined(const std::vector<Problem>& problems) {
    if (problems.empty())
        throw InputError("fit: there are no data");
    Problem whole;
    whole.sigma_known = problems.front().sigma_known;
    double values = 0.0;
    const auto parts = std::make_shared<std::vector<ProblemPart>>();
    for (const Problem& problem : problems) {
        if (problem.sigma_known != whole.sigma_known)
            throw InputError(
                "fit: standard errors are known for one kind of data and not for the other: their "
                "weights cannot be compared; give all of them, or none");
        ProblemPart part{problem, {}, whole.residuals};
        for (const Parameter& parameter : problem.parameters)
            part.index.push_back(slot_of(parameter, whole.parameters));
        whole.residuals += problem.residuals;
        whole.log_sigma.insert(whole.log_sigma.end(), problem.log_sigma.begin(), problem.log_sigma.end());
        for (Series item : series_of(problem)) {
            for (std::size_t& i : item.residuals)
                i += part.first_residual;
            whole.series.push_back(std::move(item));
        }
        whole.remarks.insert(whole.remarks.end(), problem.remarks.begin(), problem.remarks.end());
        values += problem.independent * static_cast<double>(data_count(problem));
        whole.log_scales = problem.log_scales; // of tracks, which come last
        parts->push_back(std::move(part));
    }
    whole.independent = whole.residuals > 0 ? values / static_cast<double>(data_count(whole)) : 1.0;
    // NOLINTNEXTLINE(performance-unnecessary-value-param): an Eigen::Ref is a view
    whole.evaluate = [parts](std::span<const double> p, Eigen::Ref<Eigen::VectorXd> r,
                             Eigen::MatrixXd* jacobian) {
        if (jacobian)
            jacobian->setZero();
        for (const ProblemPart& part : *parts) {
            const auto rows = static_cast<Eigen::Index>(part.problem.residuals),
                       first = static_cast<Eigen::Index>(part.first_residual);
            std::vector<double> own;
            for (const std::size_t j : part.index)
                own.push_back(p[j]);
            Eigen::MatrixXd slopes;
            if (jacobian)
                slopes.setZero(rows, static_cast<Eigen::Index>(own.size()));
            part.problem.evaluate(own, r.segment(first, rows), jacobian ? &slopes : nullptr);
            for (std::size_t j = 0; jacobian && j < own.size(); ++j)
                jacobian->col(static_cast<Eigen::Index>(part.index[j])).segment(first, rows) =
                    slopes.col(static_cast<Eigen::Index>(j));
        }
    };
    whole.residual_name = [parts](std::size_t i) {
        const auto after = std::ranges::upper_bound(*parts, i, {}, &ProblemPart::first_residual);
        const ProblemPart& part = *std::prev(after);
        const std::size_t own = i - part.first_residual;
        return part.problem.residual_name ? part.problem.residual_name(own) : fmt::format("{}", own);
    };
    return whole;
}

} // namespace rodwake::fitting
