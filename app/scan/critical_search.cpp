// All critical values of a scan: brackets from the coarse pass, their results, and the files of both.

#include "critical.hpp"
#include "rodwake/core/encounter.hpp"
#include "rodwake/core/json_text.hpp"
#include "rodwake/scan/run.hpp"
#include "rodwake/store/atomic_file.hpp"
#include "scan_parts.hpp"
#include "scan_tables.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>

namespace rodwake::app {

namespace {

using nlohmann::ordered_json;

/// Within one bracket so many changes are looked for, one above the other.
constexpr std::int64_t most_changes = 8;

/// The coarse pass: outcomes along the last axis, point by point; -1: failed.
using Outcomes = std::vector<std::vector<std::int32_t>>;

Outcomes coarse_outcomes(const ScanPlan& plan, const scan::Ledger& ledger) {
    const auto values = static_cast<std::int64_t>(plan.design.axes.back().values.size());
    Outcomes outcomes(static_cast<std::size_t>(scan::places(plan.design) / values),
                      std::vector<std::int32_t>(static_cast<std::size_t>(values), -1));
    ledger.for_each([&](const scan::Result& one) {
        if (one.ok())
            outcomes[static_cast<std::size_t>(one.point.id / values)]
                    [static_cast<std::size_t>(one.point.id % values)] = one.outcome;
    });
    return outcomes;
}

std::int64_t point_of_bracket(const ScanPlan& plan, std::int64_t id) {
    const auto values = static_cast<std::int64_t>(plan.design.axes.back().values.size());
    return (id - first_bracket) / most_changes / values;
}

/// Places that differ on the first axis alone, in the order of its values, one after the other, each with its
/// level: critical values are predicted from those of lower levels.
struct PredictionChain {
    std::vector<std::size_t> places;
    std::vector<double> at;
    std::vector<int> levels;
};

std::vector<PredictionChain> chains_of(const ScanPlan& plan, std::size_t places) {
    const std::size_t others = plan.design.axes.size() - 1;
    const scan::PointList points(plan.design);
    std::map<std::vector<double>, std::vector<std::pair<double, std::size_t>>> rows;
    for (std::size_t place = 0; place < places; ++place) {
        const scan::Point point =
            points.at_place(static_cast<std::int64_t>(place * plan.design.axes.back().values.size()));
        std::vector<double> rest(point.at.begin() + std::min<std::size_t>(others, 1),
                                 point.at.begin() + others);
        rows[rest].emplace_back(others > 0 ? point.at[0] : 0.0, place);
    }
    const bool words = others == 0 || !plan.design.axes[0].words.empty();
    std::vector<PredictionChain> chains;
    for (auto& [rest, row] : rows) {
        std::ranges::sort(row);
        PredictionChain& chain = chains.emplace_back();
        const bool log = !words && row.front().first > 0.0; // a curve is smooth in either
        // Every 2^levels-th place is of level 0, then those in between, ever closer; five begin.
        const int levels = words ? 0 : std::max(static_cast<int>(std::bit_width(row.size() / 5)) - 1, 0);
        for (std::size_t i = 0; i < row.size(); ++i) {
            chain.places.push_back(row[i].second);
            chain.at.push_back(log ? std::log(row[i].first) : row[i].first);
            const bool end = i == 0 || i + 1 == row.size();
            chain.levels.push_back(end ? 0 : std::max(levels - std::countr_zero(i), 0));
        }
    }
    return chains;
}

CriticalValue value_of(const scan::Result& result) {
    CriticalValue value;
    std::size_t next = 0;
    std::apply([&](const auto&... field) { ((value.*field.get = result.values[next++]), ...); },
               CriticalValue::fields());
    return value;
}

using Groups = std::pair<int, int>; ///< below and above

/// Interpolates with ever more neighbours, the nearest first, and keeps what changes least with one more: the
/// prediction, and how far off it may be; nothing of fewer than three.
std::optional<std::pair<double, double>> interpolated(double at,
                                                      std::span<const std::pair<double, double>> known) {
    std::optional<std::pair<double, double>> best;
    std::vector<double> values; // Neville's scheme, its last diagonal
    double before = HUGE_VAL;
    for (std::size_t j = 0; j < known.size(); ++j) {
        const double last = values.empty() ? known[j].second : values[0];
        values.push_back(known[j].second);
        for (std::size_t k = j; k-- > 0;)
            values[k] = values[k + 1] + (at - known[j].first) * (values[k + 1] - values[k]) /
                                            (known[j].first - known[k].first);
        const double change = std::abs(values[0] - last), error = std::max(change, before / 8.0);
        if (j >= 2 && (!best || error < best->second))
            best = {values[0], error};
        before = change;
    }
    return best;
}

/// Moves the ends of a bracket to where its critical value is predicted, on a grid of a power of two.
void narrow(const ScanPlan& plan, scan::Point& bracket, double value, double error) {
    const std::size_t axis = plan.design.axes.size() - 1;
    double &low = bracket.at[axis], &high = bracket.at[axis + 1];
    const double width = critical_width(plan, low, high),
                 half = error < 0.5 * width ? 0.5 * width : 2.0 * error;
    const double grid = std::exp2(std::floor(std::log2(0.25 * half))), reach = grid * std::floor(half / grid),
                 middle = grid * std::round(value / grid);
    if (value > low && value < high && reach < 0.25 * (high - low))
        low = std::max(low, middle - reach), high = std::min(high, middle + reach);
}

} // namespace

double critical_width(const ScanPlan& plan, double from, double to) {
    const scan::Axis& range = plan.design.axes.back();
    return plan.critical->tolerance *
           std::max(std::min(std::abs(from), std::abs(to)), 1e-3 * (range.to - range.from));
}

std::pair<double, double> coarse_bracket(const ScanPlan& plan, const scan::Point& bracket) {
    const std::vector<double>& values = plan.design.axes.back().values;
    const std::int64_t number = bracket.id - first_bracket;
    const auto k = static_cast<std::size_t>(number / most_changes) % values.size();
    const double rest = bracket.at[plan.design.axes.size() - 1];
    return {number % most_changes == 0 ? values[k] : rest, values[k + 1]};
}

CriticalSearch find_critical(const ScanPlan& plan, const scan::Ledger& ledger, scan::Ledger& found,
                             const scan::Execute& execute,
                             const std::function<void(std::int64_t done, std::int64_t total)>& progress) {
    const CriticalPlan& critical = *plan.critical;
    const scan::Axis& axis = plan.design.axes.back();
    const std::size_t number_of_axis = plan.design.axes.size() - 1;
    const auto values = static_cast<std::int64_t>(axis.values.size());
    const Outcomes outcomes = coarse_outcomes(plan, ledger);
    const scan::PointList points(plan.design);
    CriticalSearch search;

    // Neighbours of different groups are brackets. The audit: random values that end otherwise than the two
    // of the coarse pass around them, which end alike, were found by chance.
    const auto group = [&](std::int32_t outcome) {
        return outcome < 0 ? -1 : critical_group(critical, outcome);
    };
    std::vector<std::vector<std::size_t>> brackets(outcomes.size()); // of each place, by their lower values
    std::int64_t done = 0, total = 0;
    for (std::size_t place = 0; place < outcomes.size(); ++place) {
        const std::vector<std::int32_t>& row = outcomes[place];
        std::size_t last = 0; // of the coarse pass
        for (std::size_t k = 0; k + 1 < row.size(); ++k) {
            if (!critical.audited[k])
                last = k;
            if (row[k] < 0 || row[k + 1] < 0)
                continue;
            if (critical.audited[k + 1]) {
                std::size_t next = k + 1;
                while (next + 1 < row.size() && critical.audited[next])
                    ++next;
                ++search.audited;
                search.missed +=
                    group(row[last]) == group(row[next]) && group(row[k + 1]) != group(row[last]);
            }
            if (group(row[k]) != group(row[k + 1]))
                brackets[place].push_back(k), ++total;
        }
    }

    // Level after level: the value of a bracket is predicted from those of lower levels between the same
    // groups, the n-th from each n-th.
    const std::vector<PredictionChain> chains = chains_of(plan, outcomes.size());
    std::map<std::pair<std::size_t, Groups>, std::vector<double>> known; // values of a place, ascending
    int levels = 0;
    for (const PredictionChain& chain : chains)
        levels = std::max(levels, 1 + std::ranges::max(chain.levels));
    for (int level = 0; level < levels; ++level) {
        std::vector<scan::Point> wanted;
        for (const PredictionChain& chain : chains)
            for (std::size_t i = 0; i < chain.places.size(); ++i) {
                if (chain.levels[i] != level)
                    continue;
                const std::size_t place = chain.places[i];
                const std::vector<std::int32_t>& row = outcomes[place];
                std::map<Groups, std::size_t> all, turn;
                const auto groups = [&](std::size_t k) { return Groups{group(row[k]), group(row[k + 1])}; };
                for (const std::size_t k : brackets[place])
                    ++all[groups(k)];
                for (const std::size_t k : brackets[place]) {
                    scan::Point bracket = points.at_place(static_cast<std::int64_t>(place) * values);
                    bracket.id = first_bracket +
                                 (static_cast<std::int64_t>(place) * values + static_cast<std::int64_t>(k)) *
                                     most_changes;
                    bracket.at[number_of_axis] = axis.values[k];
                    bracket.at[number_of_axis + 1] = axis.values[k + 1];
                    std::vector<std::pair<double, double>> neighbours;
                    for (std::size_t j = 0; j < chain.places.size(); ++j)
                        if (const auto at = known.find({chain.places[j], groups(k)});
                            chain.levels[j] < level && at != known.end() &&
                            at->second.size() == all[groups(k)])
                            neighbours.emplace_back(chain.at[j], at->second[turn[groups(k)]]);
                    std::ranges::stable_sort(
                        neighbours, {}, [&](const auto& one) { return std::abs(one.first - chain.at[i]); });
                    neighbours.resize(std::min<std::size_t>(neighbours.size(), 8));
                    if (const auto value = interpolated(chain.at[i], neighbours))
                        narrow(plan, bracket, value->first, value->second);
                    ++turn[groups(k)];
                    wanted.push_back(bracket);
                }
            }

        // A bracket's result is its lowest change. If what lies above that is not yet the group of the upper
        // end, the rest is a bracket of its own.
        while (!wanted.empty()) {
            std::map<std::int64_t, scan::Result> results;
            const bool finished = scan::evaluate_missing(
                found, execute, wanted,
                [&](const scan::Result& one) { results.emplace(one.point.id, one), ++done; },
                [&] { progress(done, total); });
            if (!finished)
                return search;
            std::vector<scan::Point> rest;
            for (const scan::Point& bracket : wanted) {
                const scan::Result& result = results.at(bracket.id);
                if (!result.ok()) {
                    search.failed.push_back(result);
                    continue;
                }
                if (result.outcome != static_cast<std::int32_t>(CriticalKind::other))
                    search.values.push_back(result);
                const CriticalValue value = value_of(result);
                const auto below = static_cast<std::int32_t>(value.below),
                           above = static_cast<std::int32_t>(value.above);
                const auto place = static_cast<std::size_t>(point_of_bracket(plan, bracket.id));
                const std::int64_t number = bracket.id - first_bracket;
                const auto k = static_cast<std::size_t>(number / most_changes % values);
                if (above < 0)
                    continue;
                known[{place, {group(below), group(above)}}].push_back(value.value);
                if (number % most_changes + 1 == most_changes ||
                    group(above) == group(outcomes[place][k + 1]))
                    continue;
                scan::Point upper = bracket;
                upper.id = bracket.id + 1;
                upper.at[number_of_axis] = value.rest;
                upper.at[number_of_axis + 1] = axis.values[k + 1];
                if (upper.at[number_of_axis] < upper.at[number_of_axis + 1])
                    rest.push_back(upper);
            }
            total += static_cast<std::int64_t>(rest.size());
            wanted = std::move(rest);
        }
        for (auto& [place, all] : known)
            std::ranges::sort(all);
    }
    std::ranges::sort(search.values, {}, [](const scan::Result& one) { return one.point.id; });
    search.complete = true;
    return search;
}

namespace {

/// The axes' values at a place.
ordered_json at_of(const ScanPlan& plan, const scan::PointList& points, std::size_t place) {
    ordered_json at = ordered_json::object();
    const scan::Point point =
        points.at_place(static_cast<std::int64_t>(place * plan.design.axes.back().values.size()));
    for (std::size_t k = 0; k + 1 < plan.design.axes.size(); ++k) {
        const scan::Axis& axis = plan.design.axes[k];
        at[axis.name] = axis.words.empty() ? ordered_json(point.at[k])
                                           : ordered_json(axis.words[static_cast<std::size_t>(point.at[k])]);
    }
    return at;
}

/// Values of neighbouring points on one branch have one number: between the same outcomes, and nearest to
/// each other, a branch taking one value of a point.
std::vector<int> branches_of(const ScanPlan& plan, const std::vector<scan::Result>& values) {
    std::vector<int> branches(values.size(), -1);
    int next = 0;
    std::vector<std::size_t> before, here; // values of the last point, and of this one
    const auto extend = [&] {
        std::vector<std::size_t> free = before;
        for (const std::size_t one : here) {
            auto best = free.end();
            double least = HUGE_VAL;
            for (auto at = free.begin(); at != free.end(); ++at) {
                const CriticalValue neighbour = value_of(values[*at]), value = value_of(values[one]);
                const bool alike = neighbour.below == value.below && neighbour.above == value.above;
                const double away = std::abs(neighbour.value - value.value);
                if (alike && away < least)
                    least = away, best = at;
            }
            branches[one] = best == free.end() ? next++ : branches[*best];
            if (best != free.end())
                free.erase(best);
        }
        before = std::move(here);
        here.clear();
    };
    std::int64_t stride = 1; // neighbours lie along the first axis, as figures draw them
    if (plan.design.kind == scan::Kind::grid)
        for (std::size_t k = 1; k + 1 < plan.design.axes.size(); ++k)
            stride *= plan.design.axes[k].count;
    const auto place = [&](std::size_t i) { return point_of_bracket(plan, values[i].point.id); };
    std::vector<std::size_t> order(values.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, {},
                             [&](std::size_t i) { return std::pair(place(i) % stride, place(i)); });
    for (const std::size_t i : order) {
        if (!here.empty() && place(i) != place(here.front())) {
            const bool adjacent = place(i) == place(here.front()) + stride;
            extend();
            if (!adjacent)
                before.clear();
        }
        here.push_back(i);
    }
    extend();
    return branches;
}

/// Where curves meet between two neighbours along the first axis: the values of each that the other does not
/// continue with the same kind, if both sides lead from one group to the same other one. (A curve that leaves
/// the range does not.)
ordered_json triple_points_of(const ScanPlan& plan, const std::vector<scan::Result>& values,
                              const std::vector<int>& branches, std::size_t places) {
    const scan::PointList points(plan.design);
    std::map<std::size_t, std::vector<std::size_t>> at; // values of a place, ascending
    for (std::size_t i = 0; i < values.size(); ++i)
        at[static_cast<std::size_t>(point_of_bracket(plan, values[i].point.id))].push_back(i);
    const auto ending = [&](std::size_t place, std::size_t other) {
        std::vector<std::size_t> found = at[place];
        std::erase_if(found, [&](std::size_t i) {
            return std::ranges::any_of(at[other], [&](std::size_t j) {
                return branches[i] == branches[j] && values[i].outcome == values[j].outcome;
            });
        });
        return found;
    };
    ordered_json triples = ordered_json::array();
    if (!plan.design.axes[0].words.empty()) // without neighbours
        return triples;
    for (const PredictionChain& chain : chains_of(plan, places))
        for (std::size_t k = 0; k + 1 < chain.places.size(); ++k) {
            std::vector<Groups> groups; // of what ends here and of what begins there
            ordered_json sides = ordered_json::array();
            for (const std::size_t side : {k, k + 1}) {
                ordered_json all = ordered_json::array();
                const std::size_t before = groups.size();
                for (const std::size_t i : ending(chain.places[side], chain.places[2 * k + 1 - side])) {
                    const CriticalValue v = value_of(values[i]);
                    const auto below = static_cast<std::int32_t>(v.below),
                               above = static_cast<std::int32_t>(v.above);
                    const int from = critical_group(*plan.critical, below),
                              to = critical_group(*plan.critical, above);
                    if (groups.size() == before)
                        groups.emplace_back(from, to);
                    groups.back().second = to;
                    all.push_back({{"value", v.value},
                                   {"kind", critical_kinds[static_cast<std::size_t>(values[i].outcome)]},
                                   {"outcomes", {outcome_text(plan, below), outcome_text(plan, above)}}});
                }
                sides.push_back({{"at", at_of(plan, points, chain.places[side])}, {"values", all}});
            }
            if (groups.size() == 2 ? groups[0] == groups[1]
                                   : groups.size() == 1 && groups[0].first == groups[0].second)
                triples.push_back(sides);
        }
    return triples;
}

} // namespace

void write_critical(const std::filesystem::path& folder, const ScanPlan& plan, const scan::Ledger& ledger,
                    const CriticalSearch& search) {
    const scan::Axis& axis = plan.design.axes.back();
    const std::size_t others = plan.design.axes.size() - 1;
    const std::vector<int> branches = branches_of(plan, search.values);
    std::string text;
    for (std::size_t k = 0; k < others; ++k)
        text += plan.design.axes[k].name + ",";
    text +=
        "value,low,high,kind,below,above,closest_below,closest_above,lambda,lambda_error,branch,encounters\n";
    std::vector<std::int64_t> counts(coarse_outcomes(plan, ledger).size(), 0);
    for (std::size_t i = 0; i < search.values.size(); ++i) {
        const scan::Result& one = search.values[i];
        ++counts[static_cast<std::size_t>(point_of_bracket(plan, one.point.id))];
        for (std::size_t k = 0; k < others; ++k)
            text += plan.design.axes[k].words.empty()
                        ? number_text(one.point.at[k]) + ","
                        : plan.design.axes[k].words[static_cast<std::size_t>(one.point.at[k])] + ",";
        const CriticalValue v = value_of(one);
        const auto outcome = [&](double number) {
            return outcome_text(plan, static_cast<std::int32_t>(number));
        };
        text += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{}\n", number_text(v.value), number_text(v.low),
                            number_text(v.high), critical_kinds[static_cast<std::size_t>(one.outcome)],
                            outcome(v.below), outcome(v.above), number_text(v.closest_below),
                            number_text(v.closest_above), number_text(v.lambda), number_text(v.lambda_error),
                            branches[i], number_text(v.encounters));
    }
    store::write_atomically(folder / "critical.csv", text);

    // critical.json says how many values each point has, and why it has none.
    const Outcomes outcomes = coarse_outcomes(plan, ledger);
    const scan::PointList list(plan.design);
    ordered_json points = ordered_json::array();
    for (std::size_t place = 0; place < outcomes.size(); ++place) {
        ordered_json seen = ordered_json::object();
        for (std::size_t k = 0; k < plan.columns.outcomes.size(); ++k)
            if (const auto times = std::ranges::count(outcomes[place], static_cast<std::int32_t>(k));
                times > 0)
                seen[plan.columns.outcomes[k]] = times;
        const auto lost = std::ranges::count(outcomes[place], -1);
        std::string reason;
        for (const scan::Result& one : search.failed)
            if (point_of_bracket(plan, one.point.id) == static_cast<std::int64_t>(place))
                reason = fmt::format("between {:g} and {:g}: {}", one.point.at[others],
                                     one.point.at[others + 1], one.cause_text());
        if (reason.empty() && lost > 0)
            reason = fmt::format("{} of {} values of the coarse pass failed", lost, axis.values.size());
        const auto open = std::ranges::count(outcomes[place], static_cast<std::int32_t>(Ending::undecided));
        if (reason.empty() && counts[place] == 0 && open > 0 &&
            std::ranges::count(plan.critical->between, "undecided") == 0)
            reason =
                fmt::format("{} of {} values of the coarse pass are undecided; raise rods_run.t_end_limit",
                            open, axis.values.size());
        const bool failed = !reason.empty();
        if (reason.empty() && counts[place] == 0)
            reason = fmt::format("no change between {} from {:g} to {:g}",
                                 plan.critical->between.size() == 1
                                     ? "outcomes"
                                     : plan.critical->between[0] + " and " + plan.critical->between[1],
                                 axis.from, axis.to);
        points.push_back({{"at", at_of(plan, list, place)},
                          {"status", failed              ? "incomplete"
                                     : counts[place] > 0 ? "found"
                                                         : "none"},
                          {"count", counts[place]},
                          {"reason", reason.empty() ? ordered_json(nullptr) : ordered_json(reason)},
                          {"outcomes", seen}});
    }
    double encounters = 0.0;
    for (const scan::Result& one : search.values)
        encounters += value_of(one).encounters;
    const scan::Audit audit{search.audited, search.missed};
    const ordered_json triples = triple_points_of(plan, search.values, branches, outcomes.size());
    const ordered_json out = {{"solve_for", axis.name},
                              {"from", axis.from},
                              {"to", axis.to},
                              {"between", plan.critical->between},
                              {"tolerance", plan.critical->tolerance},
                              {"complete", search.complete},
                              {"values", search.values.size()},
                              {"evaluated",
                               {{"coarse", static_cast<std::int64_t>(outcomes.size() * axis.values.size())},
                                {"correctors", encounters}}},
                              {"audit",
                               {{"values", search.audited},
                                {"found", search.missed},
                                {"missed_rate_high", search.audited > 0 ? ordered_json(audit.upper_bound())
                                                                        : ordered_json(nullptr)}}},
                              {"triple_points", triples},
                              {"points", points}};
    store::write_atomically(folder / "critical.json", json_text(out, 2) + "\n");
}

} // namespace rodwake::app
