// One critical value: from a bracket of the coarse pass to a number with its error.

#include "critical_encounters.hpp"
#include "rodwake/core/error.hpp"
#include "scan_parts.hpp"

#include <boost/math/tools/toms748_solve.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <numbers>
#include <numeric>
#include <vector>

namespace rodwake::app {

namespace {

/// A root that a corrector found, and the bracket around it.
struct Root {
    CriticalKind kind = CriticalKind::separatrix;
    double value = 0.0;
    Bracket bracket;
    bool of_fixed_point = false; ///< solved for without encounters
};

/// Whether one end of the bracket is an orbit to which rods shrink without coming closer on the way, to 0.1
/// %.
bool ends_in_shrinking_orbit(const Bracket& bracket) {
    const Encounter& orbiting = bracket.low.ending == Ending::orbit ? bracket.low : bracket.high;
    return bracket.is_between(Ending::orbit, Ending::contact) && orbiting.closest >= 0.999 * orbiting.orbit;
}

/// The root of D(p) - d_c in a bracket of which one end is contact. Signs are those of the groups, so that
/// whatever lies between, what is found is a change of group. Nothing, and a narrower bracket, where it turns
/// out to be that of a shrinking orbit.
std::optional<Root> graze(Encounters& encounters, Bracket& bracket, double gap_low, double gap_high,
                          double width) {
    struct Shrinks {};
    const int group = bracket.low.group;
    const double sign = gap_low < 0.0 ? -1.0 : 1.0;
    const auto gap = [&](double value) {
        const Encounter one = encounters.at(value);
        bracket.take(one);
        if (ends_in_shrinking_orbit(bracket)) // near the root encounters would take for ever
            throw Shrinks{};
        const double size = std::abs(encounters.closest_approach(one) - encounters.contact_distance(value));
        return one.group == group ? sign * size : -sign * size;
    };
    std::uintmax_t most = 60;
    try {
        const auto [low, high] = boost::math::tools::toms748_solve(
            gap, bracket.low.at, bracket.high.at, gap_low, gap_high,
            [&](double a, double b) { return std::abs(b - a) <= width; }, most);
        const double root = std::midpoint(low, high); // one that was hit exactly leaves a side wide
        for (const double side : {root - 0.5 * width, root + 0.5 * width})
            if (bracket.width() > width && side > bracket.low.at && side < bracket.high.at)
                bracket.take(encounters.at(side));
        return Root{CriticalKind::grazing, root, bracket};
    } catch (const Shrinks&) {
        return std::nullopt;
    }
}

/// The zero of the squared angle, long after, between the headings of rods that part: between `near`, where
/// they part, and `end`, where they no longer do. The value as a polynomial in it, through all angles so far,
/// each fivefold closer, until the zero changes by no more than `width`. `far` is farther out than `near`; a
/// `root` that is known saves the last angle. Nothing if the angle does not fall to zero as a square root:
/// then the change is another one.
std::optional<double> unbind(Encounters& encounters, double far, double near, double end, double width,
                             double root = std::nan("")) {
    std::vector<double> squares, values; // values: Neville's scheme, its last diagonal
    double next = far;
    for (int turn = 0; turn < 12; ++turn) {
        rods::RodProblem problem = encounters.problem_at(next);
        problem.t_end *= 1e4;
        problem.output_times.clear();
        rods::RodOptions options = encounters.options(problem);
        options.ode.max_steps = 10'000; // rods that part for ever take longer steps
        const rods::RodResult run = encounters.run(problem, options);
        if (!run.solution.status.ok() || run.outcome.ending != Ending::escape)
            return std::nullopt;
        const std::vector<double>& last = run.solution.final_state;
        const double square = std::pow(std::remainder(last[2] - last[5], 2.0 * std::numbers::pi), 2);
        if (turn > 0 && !(square < squares.back()))
            return std::nullopt;
        squares.push_back(square);
        values.push_back(next);
        for (int k = turn; k-- > 0;)
            values[k] = values[k + 1] + square * (values[k + 1] - values[k]) / (squares[k] - square);
        if (turn == 0) {
            next = near;
            continue;
        }
        const double change = std::abs(values[0] - root);
        root = values[0];
        if (!((root - next) * (end - root) > 0.0)) // beyond the end, or back
            return std::nullopt;
        if (change <= width)
            return root;
        next = root - 0.2 * (root - next);
    }
    return std::nullopt;
}

/// The unbinding in a bracket between pursuit and escape, with the nearest values on both sides at which
/// encounters end as in the bracket, decided within the limit of time; nothing if there are none.
std::optional<Root> unbound_root(Encounters& encounters, const Bracket& bracket, double width) {
    if (!bracket.is_between(Ending::pursuit, Ending::escape))
        return std::nullopt;
    const bool below = bracket.low.ending == Ending::escape;
    const double near = below ? bracket.low.at : bracket.high.at,
                 end = below ? bracket.high.at : bracket.low.at;
    const auto zero = unbind(encounters, near + 0.5 * (near - end), near, end, width);
    if (!zero)
        return std::nullopt;
    for (double step = std::max(width, 1e-12 * std::abs(*zero)); step < bracket.width(); step *= 4.0) {
        const Bracket both = encounters.both(*zero - step, *zero + step);
        if (both.low.group == bracket.low.group && both.high.group == bracket.high.group)
            return Root{CriticalKind::unbinding, *zero, both};
    }
    return std::nullopt;
}

/// A root of fixed points, which encounters cannot tell apart from its surroundings: near a fold and near an
/// orbit of the contact distance they take ever longer, and then end by the errors of the run. So outcomes
/// are checked from the bracket inwards, as long as encounters are decided soon and in four times the first's
/// time.
Root fixed_point_root(Encounters& brief, CriticalKind kind, double value, const Bracket& bracket,
                      double width) {
    Root root{kind, value, bracket, true};
    const double most = std::min(value - bracket.low.at, bracket.high.at - value);
    double first = 0.0;
    for (double step = 0.5 * most; step > width; step *= 0.25) {
        const auto [low, high] = brief.both(value - step, value + step);
        if (low.ending != bracket.low.ending || high.ending != bracket.high.ending)
            break;
        root.bracket = {low, high};
        first = first == 0.0 ? std::max(low.time, high.time) : first;
        if (std::max(low.time, high.time) > 4.0 * first)
            break;
    }
    return root;
}

/// Narrows a bracket until its kind is known and it is `width` wide. `brief`: the same encounters, with
/// little time to be decided.
Root correct(Encounters& encounters, Encounters& brief, Bracket bracket, double width) {
    using enum Ending;
    const double distance = encounters.contact_distance(bracket.low.at);
    const auto gap = [&](const Encounter& one) {
        return encounters.closest_approach(one) - encounters.contact_distance(one.at);
    };
    const double scale = std::max(std::abs(bracket.low.at), std::abs(bracket.high.at));
    bool tried_fold = false, parts = true; // parts: the end at which rods part is a new one
    while (bracket.width() > width) {
        if (ends_in_shrinking_orbit(bracket))
            if (const auto value = shrunk_orbit(encounters, bracket))
                return fixed_point_root(brief, CriticalKind::grazing, *value, bracket, width);
        const double middle = std::midpoint(bracket.low.at, bracket.high.at);
        if (middle <= bracket.low.at || middle >= bracket.high.at)
            break;
        // Near an unbinding encounters take ever longer, so bisection would not get far.
        if (parts && bracket.width() < 1e-3 * scale && bracket.width() > 16.0 * width)
            if (const auto root = unbound_root(encounters, bracket, width))
                return *root;
        const Encounter one = encounters.at(middle);

        // Where D is smooth over the bracket, its root is found much sooner.
        const bool touches = (bracket.low.ending == contact) != (bracket.high.ending == contact);
        const Encounter& apart = bracket.low.ending == contact ? bracket.high : bracket.low;
        if (touches && apart.closest < 2.0 * distance &&
            (one.ending == bracket.low.ending || one.ending == bracket.high.ending)) {
            const double gap_low = gap(bracket.low), gap_high = gap(bracket.high);
            // Whether D - d_c is smooth over the bracket: at the middle it lies on the straight line between
            // the ends, to 5 % of their difference.
            if (gap_low * gap_high < 0.0 &&
                (std::abs(gap(one) - 0.5 * (gap_low + gap_high)) < 0.05 * std::abs(gap_high - gap_low))) {
                if (const auto root = graze(encounters, bracket, gap_low, gap_high, width))
                    return *root;
                continue;
            }
        }
        // Undecided rods tell no side: then the bracket is the range.
        const bool stuck = one.ending == undecided && !one.parted && bracket.low.ending != undecided &&
                           bracket.high.ending != undecided;
        parts = one.ending == escape;
        if (!stuck)
            bracket.take(one);

        // Near a fold encounters take ever longer too.
        if (!stuck && bracket.width() > 1e-3 * scale)
            continue;
        if (!tried_fold && !touches && (bracket.low.ending == orbit || bracket.high.ending == orbit)) {
            tried_fold = true;
            if (const auto fold = fold_near(encounters, bracket))
                return fixed_point_root(brief, CriticalKind::fold, *fold, bracket, width);
        }
        if (stuck) {
            if (const auto root = unbound_root(encounters, bracket, width))
                return *root;
            break;
        }
    }

    // A bracket that is still wide may hide that D is continuous, so D near contact on both sides is enough.
    const bool touches = (bracket.low.ending == contact) != (bracket.high.ending == contact);
    const Encounter& apart = bracket.low.ending == contact ? bracket.high : bracket.low;
    const Encounter& met = bracket.low.ending == contact ? bracket.low : bracket.high;
    if (touches && std::abs(gap(apart)) < 0.5 * distance && std::abs(gap(met)) < 0.5 * distance)
        return {CriticalKind::grazing, std::midpoint(bracket.low.at, bracket.high.at), bracket};
    const double jump = std::abs(bracket.low.closest - bracket.high.closest);
    const bool unbinds = bracket.is_between(pursuit, escape) && jump < 1e-3 * bracket.low.closest;
    return {unbinds ? CriticalKind::unbinding : CriticalKind::separatrix,
            std::midpoint(bracket.low.at, bracket.high.at), bracket};
}

/// A bracket around the value, `step` to each side or wider, but within `from` and `to`; nothing if there is
/// none.
std::optional<Bracket> bracket_around(Encounters& encounters, double value, double step, double from,
                                      double to) {
    for (;; step *= 8.0) {
        const double low = std::max(value - step, from), high = std::min(value + step, to);
        const Bracket bracket = encounters.both(low, high);
        if (bracket.low.group != bracket.high.group)
            return bracket;
        if (low == from && high == to)
            return std::nullopt;
    }
}

/// The same root at another tolerance. Between pursuit and escape the angle at which rods part says whether
/// it is an unbinding; where it is small only next to the root, it says nothing.
std::optional<double> again(Encounters& encounters, Encounters& brief, Root& root, double from, double to,
                            double width) {
    if (root.bracket.is_between(Ending::pursuit, Ending::escape)) {
        const double away = std::max(64.0 * width, 1e-4 * std::abs(root.value)) *
                            (root.bracket.low.ending == Ending::escape ? -1.0 : 1.0);
        const auto value = unbind(encounters, root.value + away, root.value + 0.25 * away, root.value - away,
                                  width, root.value);
        if (value) {
            root.kind = CriticalKind::unbinding;
            return value;
        }
    }
    const auto bracket =
        bracket_around(encounters, root.value, std::max(width, root.bracket.width()), from, to);
    if (!bracket || bracket->low.group != root.bracket.low.group ||
        bracket->high.group != root.bracket.high.group)
        return std::nullopt;
    return correct(encounters, brief, *bracket, width).value;
}

CriticalValue solve(const ScanPlan& plan, const ScanPlan& tight, const ScanPlan& brief,
                    const scan::Point& point, const std::function<bool()>& stop, CriticalKind& kind) {
    const std::size_t axis = plan.design.axes.size() - 1;
    Encounters encounters(plan, point, stop), brief_encounters(brief, point, stop);
    const auto [from, to] = coarse_bracket(plan, point);
    const double low_end = point.at[axis], high_end = point.at[axis + 1];
    const bool predicted = low_end > from || high_end < to;
    const auto start = bracket_around(encounters, std::midpoint(low_end, high_end),
                                      predicted ? 0.5 * (high_end - low_end) : HUGE_VAL, from, to);
    CriticalValue found;
    found.low = from, found.high = to;
    if (!start) { // a rounding away from the coarse pass: nothing is between
        kind = CriticalKind::other;
        return found;
    }

    const double width = critical_width(plan, from, to);
    Root root = correct(encounters, brief_encounters, *start, width);
    kind = root.kind;
    found.value = root.value;
    found.encounters = static_cast<double>(encounters.count + brief_encounters.count);
    found.below = static_cast<double>(root.bracket.low.ending);
    found.above = static_cast<double>(root.bracket.high.ending);
    found.rest = root.bracket.high.at;
    found.low = std::min(root.bracket.low.at, root.value - 0.5 * width),
    found.high = std::max(root.bracket.high.at, root.value + 0.5 * width);
    const int low = root.bracket.low.group, high = root.bracket.high.group;
    if (plan.critical->between.size() == 2 && std::min(low, high) + std::max(low, high) != 1) {
        kind = CriticalKind::other; // a third group lies between
        return found;
    }

    if (!root.of_fixed_point) {
        Encounters checked(tight, point, stop);
        if (const auto check = again(checked, brief_encounters, root, from, to, width)) {
            const double beyond =
                *check + 0.5 * (*check - root.value); // its own error is a part of the change
            found.low = std::min(found.low, beyond);
            found.high = std::max(found.high, beyond);
        } else // the check ends otherwise: nothing narrower than the coarse bracket is certain
            found.low = from, found.high = to;
        kind = root.kind;
    }
    const OutputUnits units = output_units(plan.base);
    found.closest_below = encounters.closest_approach(root.bracket.low) * units.length;
    found.closest_above = encounters.closest_approach(root.bracket.high) * units.length;
    if (kind == CriticalKind::separatrix && root.bracket.width() <= width) {
        if (const auto rate = departure(encounters, root.bracket)) {
            found.value = rate->value;
            found.lambda = rate->rate / units.time;
            found.lambda_error = rate->error / units.time;
        } else if (root.bracket.is_between(Ending::pursuit, Ending::escape))
            kind = CriticalKind::unbinding; // there is no fixed point that the rods would leave
    }
    return found;
}

} // namespace

int critical_group(const CriticalPlan& critical, std::int32_t outcome) {
    if (critical.between.size() == 1)
        return outcome;
    const auto ending = static_cast<Ending>(outcome);
    const auto belongs = [&](const std::string& name) {
        return name == rodwake::to_string(ending) || (name == "capture" && is_capture(ending));
    };
    if (belongs(critical.between[0]))
        return 0;
    return critical.between[1] == "other" || belongs(critical.between[1]) ? 1 : 2;
}

scan::Columns columns_of_critical() {
    scan::Columns columns;
    columns.outcomes.assign(critical_kinds.begin(), critical_kinds.end());
    for (const std::string_view name : field_names<CriticalValue>())
        columns.observables.emplace_back(name);
    return columns;
}

scan::Evaluate evaluate_brackets(const ScanPlan& plan, std::function<bool()> stop) {
    // Plans of the same points: at a hundredth of the tolerance, and left undecided after eight times t_end.
    const auto tight = std::make_shared<ScanPlan>(plan), brief = std::make_shared<ScanPlan>(plan);
    double& rtol = tight->base.rods_run->rtol;
    const double least = std::max(0.01 * rtol, 1e-13);
    tight->base.rods_run->atol *= least / rtol;
    rtol = least;
    scene::RodsRun& run = *brief->base.rods_run;
    run.t_end_limit = std::min(run.t_end_limit.value_or(HUGE_VAL), 8.0 * run.t_end);
    return [&plan, tight, brief, stop = std::move(stop)](std::span<const scan::Point> points,
                                                         std::span<scan::Result> results) {
        for (std::size_t i = 0; i < points.size(); ++i) {
            scan::Result& result = results[i];
            const auto start = std::chrono::steady_clock::now();
            result.point = points[i];
            try {
                CriticalKind kind{};
                const CriticalValue found = solve(plan, *tight, *brief, points[i], stop, kind);
                std::ranges::copy(field_values(found), result.values.begin());
                result.outcome = static_cast<std::int32_t>(kind);
            } catch (const PointFailed& failed) {
                result.status = failed.status;
                result.set_cause(failed.cause);
            } catch (const std::exception& error) {
                result.status = scan::Status::exception;
                result.set_cause(rodwake::describe(error));
            }
            if (stop && stop())
                result.status = scan::Status::stopped;
            result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        }
    };
}

} // namespace rodwake::app
