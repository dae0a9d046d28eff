// Two rods: how their separation changed, who turned, how it ended; from the runs' tracks.

#include "rodwake/measure/pairs.hpp"

#include "bed/measure_parts.hpp"
#include "bed/run_tables.hpp"

#include "rodwake/app/granular.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rodwake::app::measures {

namespace {

using measure::PairResult;
using scene::Measure, scene::Scene;

void reset_postprocessing_keys(Measure& m) {
    m.pairs = false;
    m.contact_distance = std::nullopt;
}

/// From t = 0 on, as the rods are held before, and where both are known.
measure::PairTrack track_of(const RunTables& run) {
    const std::vector<Column> all = run.tracks({"t", "x0", "y0", "theta0", "x1", "y1", "theta1"});
    const auto known = [&](std::size_t row) {
        return std::ranges::none_of(all, [&](const Column& column) { return std::isnan(column[row]); });
    };
    std::vector<Column> kept(all.size());
    for (std::size_t i = 0; i < all[0].size(); ++i)
        if (all[0][i] >= -1e-12 && known(i))
            for (std::size_t k = 0; k < all.size(); ++k)
                kept[k].push_back(all[k][i]);
    return {kept[0], {kept[1], kept[4]}, {kept[2], kept[5]}, {kept[3], kept[6]}};
}

measure::PairOptions options_of_bed(const Scene& scene) {
    double longest = 0.0;
    for (const scene::GranularRod& rod : scene.granular->rods)
        longest = std::max(longest, rod.shape.length);
    const double half = 0.5 * longest;
    return {.box = bed_size(*scene.granular).box,
            .contact_distance = scene.measure ? scene.measure->contact_distance.value_or(half) : half};
}

PairNumbers numbers_of(const measure::PairRun& p, double a) {
    return {.outcome_time = p.ending_time,
            .half_box_change = p.half_box_change ? *p.half_box_change / a : std::nan(""),
            .last_change = p.last_change / a,
            .separation = p.separation / a,
            .min_separation = p.min_separation / a,
            .turn = {p.turn[0], p.turn[1]},
            .non_reciprocity = p.non_reciprocity,
            .leader = p.leader,
            .outcome = p.ending};
}

/// Of pairs.csv.
struct PairRow {
    PairNumbers p;
    std::size_t number = 0; ///< of the run, from 1
    bool perpendicular = false;

    static constexpr auto fields() {
        using R = const PairRow&;
        return std::tuple{
            field("run", {"1", "number of the run, from 1"}, [](R r) { return r.number; }),
            field("separation", {"a", "at the start, across the mean first heading"},
                  [](R r) { return r.p.separation; }),
            field("half_box_change",
                  {"a", "of the separation when the rods had come half a box (empty: they have not)"},
                  [](R r) { return r.p.half_box_change; }),
            field("last_change", {"a", "of the separation at the end, outwards positive"},
                  [](R r) { return r.p.last_change; }),
            field("turn0", {"rad", "net turn of rod 0 towards the other's first position"},
                  [](R r) { return r.p.turn[0]; }),
            field("turn1", {"rad", "net turn of rod 1 towards the other's first position"},
                  [](R r) { return r.p.turn[1]; }),
            field("leader", {"1", "rod that was ahead when the pair had turned most"},
                  [](R r) { return r.p.leader; }),
            field("non_reciprocity", {"1", "(|turn of the rear| - |turn of the front|)/(their sum)"},
                  [](R r) { return r.p.non_reciprocity; }),
            field("min_separation", {"a", "smallest distance of nearest images"},
                  [](R r) { return r.p.min_separation; }),
            field("outcome", {"1", "0 contact, 1 pursuit, 2 escape, 3 undecided"},
                  [](R r) { return r.p.outcome; }),
            field("outcome_time", {"s", "of the contact, of the lock of headings, or the end of the track"},
                  [](R r) { return r.p.outcome_time; }),
            field("perpendicular", {"1", "1: first headings 60 to 120 degrees apart"},
                  [](R r) { return r.perpendicular; })};
    }
};

struct PairValues : PairResult {
    double a; ///< m
    double to_a = 1.0 / a;

    static constexpr auto fields() {
        using R = PairValues;
        return std::tuple{field("half_box_change", {R"($\Delta y$)"},
                                {"a", "change of the separation while the pair goes half the box"},
                                [](const R& r) { return r.half_box_change.scaled(r.to_a); }),
                          field("not_there", {"Runs short of half the box"},
                                {"1", R"(left out of $\Delta y$)"}, &R::not_there),
                          field("non_reciprocity", {"Non-reciprocity"},
                                {"1", "1: the rear rod alone turns, $-1$: the front rod alone"},
                                &R::non_reciprocity),
                          field("turn_rear", {"Turn of the rear rod"},
                                {"rad", "towards the other's first position"}, &R::turn_rear),
                          field("turn_front", {"Turn of the front rod"},
                                {"rad", "towards the other's first position"}, &R::turn_front),
                          field("contact", {"Contact"}, {"runs", "how runs ended"}, &R::contact),
                          field("pursuit", {"Pursuit"}, {"runs", "how runs ended"}, &R::pursuit),
                          field("escape", {"Escape"}, {"runs", "how runs ended"}, &R::escape),
                          field("undecided", &R::undecided, {"runs", "how runs ended"})};
    }
};

MeasureReport report(const MeasuredCase& data) {
    const double a = data.bead_radius(), to_a = 1.0 / a;
    measure::PairOptions options;
    if (data.film) {
        const measure::Layout& layout = data.sums.front().layout();
        options = {.box = layout.box,
                   .contact_distance = data.scene.measure->contact_distance.value(),
                   .images = !layout.window};
    } else {
        options = options_of_bed(data.scene);
    }
    std::vector<measure::PairRun> runs;
    for (const RunTables& run : data.tables)
        runs.push_back(measure::follow_pair(track_of(run), options));
    const PairResult p = measure::reduce(runs);
    const Estimate change = p.half_box_change.scaled(to_a);
    std::vector<PairRow> pair_rows;
    for (const measure::PairRun& run : p.runs)
        pair_rows.push_back({numbers_of(run, a), pair_rows.size() + 1, run.perpendicular});
    data.row.half_box_change = change;
    data.row.non_reciprocity = p.non_reciprocity;
    return {
        .values = record_json(PairValues{p, a}),
        .tables =
            {{"pairs.csv",
              "lengths in a, angles in rad, times in s; outcome 0 contact, 1 pursuit, 2 escape, 3 undecided; "
              "half_box_change empty: the rods did not come half a box",
              csv_of(pair_rows)}},
        .line = fmt::format(
            "change of separation over half the box, in a: {} ({} of {} runs); contact {}, pursuit {}, "
            "escape {}, undecided {}; non-reciprocity {}",
            text(change), change.count, p.runs.size(), p.contact, p.pursuit, p.escape, p.undecided,
            text(p.non_reciprocity))};
}

std::vector<FileKind> files() {
    return {{"pairs.csv", Lifetime::result, "how the rods of each run ended", columns_of<PairRow>()}};
}

} // namespace

MeasureKind pairs() {
    return {.name = "pairs",
            .order = 50,
            .wanted = [](const Measure& m) { return m.pairs; },
            .describe = [](const Scene&) -> std::string {
                return "separation over half the box, who turned, outcome";
            },
            .reset_postprocessing_keys = reset_postprocessing_keys,
            .report = report,
            .values = values_of<PairValues, true>,
            .files = files};
}

} // namespace rodwake::app::measures

namespace rodwake::app {

PairNumbers pair_numbers(const scene::Scene& scene, const RunTables& run) {
    return measures::numbers_of(
        measure::follow_pair(measures::track_of(run), measures::options_of_bed(scene)),
        scene.granular->bead_radius);
}

} // namespace rodwake::app
