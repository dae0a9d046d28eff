// Critical values at which the orbit in which rods end vanishes, or shrinks to the contact distance: solved
// for on its branch, as encounters take ever longer near them.

#include "critical_encounters.hpp"
#include "rodwake/rods/pair_branches.hpp"
#include "rodwake/rods/pair_equilibria.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace rodwake::app {

namespace {

/// The orbit in which an encounter ends, by its separation: another run for its pose would take as long.
std::optional<rods::PairEquilibrium> final_orbit(const rods::RodProblem& problem, const Encounter& orbiting) {
    for (const rods::PairEquilibrium& one : rods::pair_equilibria(*problem.medium, problem.couplings))
        if (one.kind == rods::EquilibriumKind::orbit && one.stable() &&
            std::abs(one.separation[0] - orbiting.orbit) < 1e-6 * orbiting.orbit)
            return one;
    return std::nullopt;
}

} // namespace

std::optional<double> fold_near(Encounters& encounters, const Bracket& bracket) {
    const double from = bracket.low.at, to = bracket.high.at;
    const rods::RodProblem low = encounters.problem_at(from), high = encounters.problem_at(to);
    if (!has_fixed_points(low))
        return std::nullopt;
    // The key must change one number of the pair's flow alone.
    struct FlowParameter {
        rods::BranchParameter parameter;
        double low, high;
    };
    using enum rods::BranchParameter;
    std::vector<FlowParameter> changed = {{kappa, low.couplings.kappa, high.couplings.kappa},
                                          {gamma1, low.couplings.gamma1, high.couplings.gamma1},
                                          {gamma2, low.couplings.gamma2, high.couplings.gamma2},
                                          {eta, low.medium->eta, high.medium->eta},
                                          {alpha, 1.0 / low.medium->xi, 1.0 / high.medium->xi}};
    std::erase_if(changed, [](const FlowParameter& one) { return one.low == one.high; });
    if (changed.size() != 1)
        return std::nullopt;
    const FlowParameter& key = changed.front();
    // An orbit that goes on to the other end, little changed, has no fold.
    const bool below = bracket.low.ending == Ending::orbit;
    const rods::RodProblem &of_orbit = below ? low : high, &other = below ? high : low;
    const auto here = final_orbit(of_orbit, below ? bracket.low : bracket.high);
    const auto there =
        here ? rods::equilibrium_near(*other.medium, other.couplings, here->pose) : std::nullopt;
    if (there && there->kind == rods::EquilibriumKind::orbit && there->stable() &&
        std::abs(there->separation[0] - here->separation[0]) < 0.1 * here->separation[0])
        return std::nullopt;
    // The key is linear in the parameter, or in its inverse, as xi is in alpha.
    const auto value_of = [&](double parameter) {
        const auto share = [&](double at, double first, double last) {
            return (at - first) / (last - first);
        };
        const bool inverse = std::abs(key.low * from - key.high * to) < 1e-9 * std::abs(key.low * from);
        return std::lerp(from, to,
                         inverse ? share(1.0 / parameter, 1.0 / key.low, 1.0 / key.high)
                                 : share(parameter, key.low, key.high));
    };
    const auto [least, most] = std::minmax(key.low, key.high);
    for (const rods::PairBranch& branch :
         rods::pair_branches(*low.medium, low.couplings, key.parameter, least, most))
        for (const rods::BranchPoint& point : branch.points)
            if (point.fold && point.equilibrium.kind == rods::EquilibriumKind::orbit)
                return value_of(point.parameter);
    return std::nullopt;
}

std::optional<double> shrunk_orbit(Encounters& encounters, const Bracket& bracket) {
    const double contact = encounters.contact_distance(bracket.low.at);
    const bool below = bracket.low.ending == Ending::orbit;
    const Encounter& orbiting = below ? bracket.low : bracket.high;
    const double end = below ? bracket.high.at : bracket.low.at;
    if (const double other = encounters.contact_distance(bracket.high.at); other != contact) // the key itself
        return std::lerp(bracket.low.at, bracket.high.at, (orbiting.orbit - contact) / (other - contact));
    const rods::RodProblem& start = encounters.problem_at(orbiting.at);
    const auto first = has_fixed_points(start) ? final_orbit(start, orbiting) : std::nullopt;
    if (!first)
        return std::nullopt;
    rods::Pose pose = first->pose;
    const auto separation = [&](double value) -> std::optional<double> {
        const rods::RodProblem& problem = encounters.problem_at(value);
        const auto orbit = rods::equilibrium_near(*problem.medium, problem.couplings, pose);
        if (!orbit || orbit->kind != rods::EquilibriumKind::orbit)
            return std::nullopt;
        pose = orbit->pose;
        return orbit->separation[0];
    };
    double before = orbiting.at, at = before + 1e-4 * (end - before);
    auto wide = separation(before), narrow = separation(at);
    for (int turn = 0; turn < 100; ++turn) {
        if (!wide || !narrow || !((end - at) * (at - orbiting.at) > 0.0))
            return std::nullopt;
        const double target = std::max(contact, 0.7 * *narrow),
                     next = at + (target - *narrow) * (at - before) / (*narrow - *wide);
        if (target == contact && std::abs(next - at) <= 1e-13 * std::abs(at))
            return next;
        if (!((end - next) * (next - orbiting.at) > 0.0))
            return std::nullopt;
        pose.x *= target / *narrow, pose.y *= target / *narrow;
        before = at, wide = narrow;
        at = next, narrow = separation(at);
    }
    return std::nullopt;
}

} // namespace rodwake::app
