#include "rodwake/rods/pair_branches.hpp"

#include "interaction.hpp"
#include "pair_reduced.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/elastic/medium_derivatives.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rodwake::rods {

namespace {

constexpr double quarter_turn = 0.5 * std::numbers::pi;
constexpr std::size_t seeds = 17;
constexpr double longest_step = 0.05, shortest_step = 1e-7;
/// (a) vanishes at b = pi/2 by symmetry, and both equations at b = 0: branches end this far from there.
constexpr double border = 1e-5;

/// z = (u, b, s): p = least + s (most - least).
using State = Eigen::Vector3d;

/// A pair with one number left open.
struct OpenPair {
    elastic::Medium medium;
    Couplings couplings;
    BranchParameter over;
    double least, most;
    Family family = Family::orbit;

    double parameter(const State& z) const { return least + z[2] * (most - least); }
    /// A step may pass the end of the range, but not that of the domain.
    double domain_begin() const {
        return over == BranchParameter::eta ? -1.0 : over == BranchParameter::alpha ? 0.0 : -HUGE_VAL;
    }
    elastic::Medium medium_at(double p) const;
    Couplings couplings_at(double p) const;
    ScaledPair at(double p) const { return {medium_at(p), couplings_at(p)}; }
};

elastic::Medium OpenPair::medium_at(double p) const {
    return {over == BranchParameter::eta ? p : medium.eta,
            over == BranchParameter::alpha ? 1.0 / p : medium.xi};
}

Couplings OpenPair::couplings_at(double p) const {
    Couplings at_p = couplings;
    if (over < BranchParameter::eta)
        at_p.*coupling_list[static_cast<std::size_t>(over)].number = p;
    return at_p;
}

/// (a), (b) and their derivatives by z. T is linear in the couplings, and in units of xi alpha stands before
/// the polar ones alone, so all derivatives by p but that by eta are rates at other couplings.
struct BranchEquations {
    Eigen::Vector2d values;
    Eigen::Matrix<double, 2, 3> by_state;
};

BranchEquations equations_at(const OpenPair& open, const State& z) {
    const double p = open.parameter(z),
                 alpha = open.over == BranchParameter::alpha ? p : 1.0 / open.medium.xi;
    const ScaledPair pair = open.at(p);
    const ReducedEquations reduced = reduced_equations(pair, open.family, {z[0], z[1]});
    // The couplings whose rate is the derivative of T by p.
    Couplings changed = pair.couplings;
    if (open.over == BranchParameter::alpha)
        changed = {0.0, changed.gamma1 / alpha, changed.gamma2 / alpha};
    else if (open.over != BranchParameter::eta) {
        const Coupling& coupling = coupling_list[static_cast<std::size_t>(open.over)];
        changed = {};
        changed.*coupling.number = coupling.polar ? alpha : 1.0;
    }
    const auto rate = [&](double x, double y, double h) {
        const elastic::FieldRequest request = request_of(changed, false);
        if (!changed.any())
            return 0.0;
        const elastic::FieldValues field = open.over == BranchParameter::eta
                                               ? medium_derivatives(pair.field, x, y, request).by_eta
                                               : pair.field.at(x, y, request);
        return turning_rate(field, changed, {std::cos(h), std::sin(h)});
    };
    const double r = std::exp(z[0]), x = r * std::cos(z[1]), y = r * std::sin(z[1]);
    const double h = open.family == Family::orbit ? 2.0 * z[1] : 0.0, range = open.most - open.least;
    const double plus = r * range * rate(x, y, h), minus = r * range * rate(-x, -y, h);
    BranchEquations equations;
    equations.values = reduced.values;
    equations.by_state.leftCols<2>() = reduced.by_place;
    equations.by_state.col(2) << plus + minus, 0.5 * (plus - minus);
    return equations;
}

/// Unit tangent of the curve, in the direction of `onward`.
State tangent_at(const OpenPair& open, const State& z, const State& onward) {
    const BranchEquations equations = equations_at(open, z);
    const State normal = equations.by_state.row(0).cross(equations.by_state.row(1)).normalized();
    return normal.dot(onward) < 0.0 ? State(-normal) : normal;
}

/// Newton's method for (a), (b) and row.z = target.
std::optional<State> corrected(const OpenPair& open, State z, const State& row, double target) {
    double last = 1.0;
    for (int iteration = 0; iteration < 15; ++iteration) {
        if (!(open.parameter(z) > open.domain_begin()))
            return {};
        const BranchEquations equations = equations_at(open, z);
        Eigen::Matrix3d by_state;
        by_state << equations.by_state, row.transpose();
        const State residual{equations.values[0], equations.values[1], row.dot(z) - target};
        const State step = by_state.partialPivLu().solve(-residual);
        if (!(step.norm() <= 1.0))
            return {};
        z += step;
        if (step.norm() < 1e-14 || (step.norm() < 1e-10 && step.norm() > 0.5 * last))
            return z;
        last = step.norm();
    }
    return {};
}

struct Traced {
    State z;
    bool fold = false;
};

/// The fold between z and the point `length` on along the tangent, by bisection of dp/ds, which changes sign;
/// nothing if Newton's method fails.
std::optional<State> fold_between(const OpenPair& open, const State& z, const State& tangent, double length) {
    double low = 0.0, high = length;
    std::optional<State> at;
    for (int halving = 0; halving < 48; ++halving) {
        const double middle = 0.5 * (low + high);
        const State guess = z + middle * tangent;
        at = corrected(open, guess, tangent, tangent.dot(guess));
        if (!at)
            return {};
        const bool before = tangent_at(open, *at, tangent)[2] * tangent[2] > 0.0;
        (before ? low : high) = middle;
    }
    return at;
}

/// From `z` on in the direction of the tangent given until the branch leaves the domain; points after the
/// first.
std::vector<Traced> follow(const OpenPair& open, State z, State tangent, std::string& end) {
    const bool opposite = std::abs(z[1] - quarter_turn) < 0.5 * border;
    struct Limit {
        int component;
        double value, outward;
        const char* name;
    };
    std::vector<Limit> limits = {{2, 0.0, -1.0, "range"},
                                 {2, 1.0, 1.0, "range"},
                                 {0, std::log(least_searched), -1.0, "distance"},
                                 {0, std::log(most_searched), 1.0, "distance"}};
    if (!opposite) {
        limits.push_back({1, quarter_turn - border, 1.0, "opposite"});
        limits.push_back({1, border, -1.0, "in_line"});
    }
    std::vector<Traced> points;
    const State begin = z, away = tangent;
    double step = 0.2 * longest_step;
    while (points.size() < 100000) {
        // A step along the tangent, shorter until Newton's method is quick and the branch nearly straight.
        const State guess = z + step * tangent;
        const auto next = corrected(open, guess, tangent, tangent.dot(guess));
        const State onward = next ? tangent_at(open, *next, tangent) : tangent;
        if (!next || (*next - guess).norm() > 0.5 * step || onward.dot(tangent) < 0.995) {
            if ((step *= 0.5) > shortest_step)
                continue;
            end = "lost";
            return points;
        }
        if (tangent[2] * onward[2] < 0.0)
            if (const auto fold = fold_between(open, z, tangent, step))
                points.push_back({*fold, true});
        // The first limit that is passed ends the branch, at the limit itself.
        const Limit* passed = nullptr;
        double soonest = 2.0;
        for (const Limit& limit : limits) {
            const double before = z[limit.component] - limit.value;
            const double after = (*next)[limit.component] - limit.value;
            const double part = std::abs(before) / std::abs(after - before);
            if (limit.outward * after > 0.0 && part < soonest) {
                passed = &limit;
                soonest = part;
            }
        }
        if (passed) {
            end = passed->name;
            const State row = State::Unit(passed->component);
            if (soonest * step < 1e-9) // a seed at the limit
                return points;
            if (const auto last = corrected(open, z + soonest * (*next - z), row, passed->value))
                points.push_back({*last});
            return points;
        }
        points.push_back({*next});
        if (points.size() > 10 && (*next - begin).norm() < step && onward.dot(away) > 0.9) {
            end = "closed";
            return points;
        }
        z = *next;
        tangent = onward;
        step = std::min(1.3 * step, longest_step);
    }
    end = "lost";
    return points;
}

/// Whether the point is on the polygon through these, which is within 1e-3 of their branch.
bool is_on(const std::vector<Traced>& points, const State& z) {
    for (std::size_t k = 0; k + 1 < points.size(); ++k) {
        const State along = points[k + 1].z - points[k].z, from = z - points[k].z;
        const double part = std::clamp(from.dot(along) / along.squaredNorm(), 0.0, 1.0);
        if ((from - part * along).norm() < 2e-3)
            return true;
    }
    return false;
}

} // namespace

BranchParameter branch_parameter(std::string_view name) {
    constexpr std::string_view names[] = {"kappa", "gamma1", "gamma2", "eta", "alpha"};
    const auto at = std::ranges::find(names, name);
    if (at == std::end(names))
        throw InputError(
            fmt::format("a branch goes over kappa, gamma1, gamma2, eta or alpha, not over '{}'", name));
    return static_cast<BranchParameter>(at - std::begin(names));
}

std::vector<PairBranch> pair_branches(const elastic::Medium& medium, const Couplings& couplings,
                                      BranchParameter over, double least, double most) {
    OpenPair open{medium, couplings, over, least, most};
    if (!(std::isfinite(least) && std::isfinite(most) && least < most))
        throw InputError(fmt::format("the range of a branch must rise; it is {} to {}", least, most));
    if (!(least > open.domain_begin()))
        throw InputError(fmt::format("the range of a branch must be above {}; it begins at {}",
                                     open.domain_begin(), least));
    std::vector<PairBranch> branches;
    std::vector<std::pair<Family, std::vector<Traced>>> traced;
    for (std::size_t k = 0; k < seeds; ++k) {
        const double s = static_cast<double>(k) / (seeds - 1), p = least + s * (most - least);
        const ScaledPair pair = open.at(p);
        for (const PairEquilibrium& seed : pair_equilibria(open.medium_at(p), open.couplings_at(p))) {
            if (seed.kind == EquilibriumKind::in_line)
                continue;
            open.family = seed.kind == EquilibriumKind::orbit ? Family::orbit : Family::parallel;
            const State z{std::log(seed.separation[0] / pair.xi), std::atan2(seed.pose.y, -seed.pose.x), s};
            if (std::ranges::any_of(traced, [&](const auto& known) {
                    return known.first == open.family && is_on(known.second, z);
                }))
                continue;
            // Both ways from the seed, the first of them reversed.
            PairBranch branch;
            const State onward = tangent_at(open, z, State::UnitZ());
            std::vector<Traced> points = follow(open, z, -onward, branch.first_end);
            std::ranges::reverse(points);
            points.push_back({z});
            if (branch.first_end == "closed")
                branch.last_end = "closed";
            else
                for (const Traced& point : follow(open, z, onward, branch.last_end))
                    points.push_back(point);
            for (const Traced& point : points)
                branch.points.push_back({open.parameter(point.z),
                                         described(open.at(open.parameter(point.z)),
                                                   pose_of(open.family, {point.z[0], point.z[1]})),
                                         point.fold});
            branches.push_back(std::move(branch));
            traced.emplace_back(open.family, std::move(points));
        }
    }
    return branches;
}

} // namespace rodwake::rods
