// Directions the data do not fix, in words.

#include "words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rodwake::fitting {

namespace {

/// Relative change of a value along a direction, or the change itself if the value is 0.
struct Move {
    std::string name;
    double amount = 0.0;
    bool relative = true;
};

std::vector<Move> moves(const Problem& problem, const Fit& fit, const FlatDirection& flat) {
    std::vector<Move> all;
    for (std::size_t i = 0; i < flat.change.size(); ++i) {
        const Parameter& p = problem.parameters[i];
        const double value = fit.values[i];
        const bool log = p.transform == Transform::log;
        if (p.free() && flat.change[i] != 0.0)
            all.push_back({p.name, log || value == 0.0 ? flat.change[i] : flat.change[i] / std::abs(value),
                           log || value != 0.0});
    }
    return all;
}

std::string amount(const Move& move, double unit) {
    return move.relative ? fmt::format("{:.2g} %", std::abs(move.amount) * unit)
                         : fmt::format("{:.2g}", 0.01 * std::abs(move.amount) * unit);
}

std::string names(const std::vector<Move>& all) {
    std::string text;
    for (std::size_t i = 0; i < all.size(); ++i)
        text += (i == 0 ? "" : i + 1 == all.size() ? " and " : ", ") + all[i].name;
    return text;
}

/// "raising eta by 1 % and lowering xi by 0.8 %"
std::string deeds(const std::vector<Move>& all) {
    double largest = 0.0;
    for (const Move& move : all)
        largest = std::max(largest, std::abs(move.amount));
    const double unit = (all.front().amount < 0.0 ? -1.0 : 1.0) / largest;
    std::string text;
    for (std::size_t i = 0; i < all.size(); ++i)
        text += fmt::format("{}{} {} by {}", i == 0 ? "" : " and ",
                            all[i].amount * unit > 0.0 ? "raising" : "lowering", all[i].name,
                            amount(all[i], std::abs(unit)));
    return text;
}

std::string sentence(const std::vector<Move>& all, bool exactly) {
    const char* fix = exactly ? "do not fix" : "hardly fix";
    const char* little = exactly
                             ? "changes the residuals hardly or not at all"
                             : "changes the residuals by less than a thousandth of what either does alone";
    if (all.size() == 1)
        return fmt::format("the data {} {}: {}", fix, all.front().name,
                           exactly ? "the residuals do not depend on it here"
                                   : "the residuals hardly depend on it");
    return fmt::format("the data {} {} separately: {} {}", fix, names(all), deeds(all), little);
}

/// Of all parameters, those that take part by less than a thousandth left out, largest = 1.
std::vector<double> change_of(const Problem& problem, const Fit& fit, const SearchSpace& space,
                              const Eigen::VectorXd& direction, const Eigen::VectorXd& part) {
    std::vector<double> change(problem.parameters.size());
    double largest = 0.0;
    for (Eigen::Index k = 0; k < space.size(); ++k) {
        const std::size_t i = space.free()[k];
        if (std::abs(part[k]) > 1e-3)
            change[i] = direction[k] * space.slope(k, space.logarithmic(k) ? 1.0 : fit.values[i]);
        largest = std::max(largest, std::abs(change[i]));
    }
    for (double& c : change)
        c = c == 0.0 ? 0.0 : c / largest;
    for (std::size_t i = 0; i < change.size(); ++i)
        if (const Parameter& p = problem.parameters[i]; !p.tied_to.empty()) {
            const auto to = std::ranges::find(problem.parameters, p.tied_to, &Parameter::name);
            const double by = to->transform == Transform::log ? 1.0 : p.tie_factor;
            change[i] = by * change[static_cast<std::size_t>(to - problem.parameters.begin())];
        }
    return change;
}

} // namespace

std::vector<FlatDirection> flat_directions(const Problem& problem, const Fit& fit, const SearchSpace& space,
                                           const Curvature& c) {
    std::vector<FlatDirection> all;
    for (Eigen::Index i = c.singular_values.size() - 1; i >= 0 && c.singular_values[i] < 1e-3; --i) {
        FlatDirection flat;
        flat.singular_value = c.singular_values[i];
        flat.change = change_of(problem, fit, space, c.directions.col(i), c.scaled.col(i));
        flat.text = sentence(moves(problem, fit, flat), i >= c.rank);
        all.push_back(std::move(flat));
    }
    return all;
}

} // namespace rodwake::fitting
