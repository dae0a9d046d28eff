// Two rods: how their separation changed, who turned, how it ended; from the runs' tracks.

#include "measure_parts.hpp"
#include "pair_run.hpp"

#include <fmt/format.h>

#include <cmath>

namespace rodwake::assembly::measures {

namespace {

using measure::PairResult;
using scene::Measure, scene::Scene;

constexpr ValueInfo values[] = {
    {"half_box_change", R"($\Delta y$)", "a", "change of the separation while the pair goes half the box"},
    {"not_there", "Runs short of half the box", "", R"(left out of $\Delta y$)"},
    {"non_reciprocity", "Non-reciprocity", "", "1: the rear rod alone turns, $-1$: the front rod alone"},
    {"turn_rear", "Turn of the rear rod", "rad", "towards the other's first place"},
    {"turn_front", "Turn of the front rod", "rad", "towards the other's first place"},
    {"contact", "Contact", "runs", "how runs ended"},
    {"pursuit", "Pursuit", "runs", "how runs ended"},
    {"escape", "Escape", "runs", "how runs ended"},
    {"undecided", "", "runs", "how runs ended"},
};

constexpr ColumnInfo pairs_columns[] = {
    {"run", "1", "number of the run, from 1"},
    {"separation", "a", "at the start, across the mean first heading"},
    {"half_box_change", "a", "of the separation when the rods had come half a box; empty: they have not"},
    {"last_change", "a", "of the separation at the end, outwards positive"},
    {"turn0", "rad", "net turn of rod 0 towards the other's first place"},
    {"turn1", "rad", "net turn of rod 1 towards the other's first place"},
    {"leader", "1", "rod that was ahead when the pair had turned most"},
    {"non_reciprocity", "1", "(|turn of the rear| - |turn of the front|)/(their sum)"},
    {"min_separation", "a", "smallest distance of nearest images"},
    {"outcome", "1", "0 contact, 1 pursuit, 2 escape, 3 undecided"},
    {"outcome_time", "s", "of the contact, of the lock of headings, or the end of the track"},
    {"perpendicular", "1", "1: first headings 60 to 120 degrees apart"}};
constexpr FileInfo files[] = {{"pairs.csv", "how the rods of each run ended", pairs_columns}};

constexpr SeriesInfo series[] = {{{"delta_y", "a", "change of the separation over half a box"}},
                                 {{"non_reciprocity", "1", "mean over the runs"}}};

void reset_late_keys(Measure& m) {
    m.pairs = false;
    m.contact_distance = std::nullopt;
}

PairResult pairs_of(const MeasuredCase& data) {
    std::vector<measure::PairRun> followed;
    for (const RunTables& run : data.tables)
        followed.push_back(pair_run(data.scene, run));
    return measure::reduce(followed);
}

Values values_of(const PairResult& p, double to_a) {
    return {{"half_box_change", p.half_box_change.scaled(to_a)},
            {"not_there", count_value(p.not_there)},
            {"non_reciprocity", p.non_reciprocity},
            {"turn_rear", p.turn_rear},
            {"turn_front", p.turn_front},
            {"contact", count_value(p.contact)},
            {"pursuit", count_value(p.pursuit)},
            {"escape", count_value(p.escape)},
            {"undecided", count_value(p.undecided)}};
}

std::vector<double> row_of(const measure::PairRun& p, std::size_t number, double a) {
    return {static_cast<double>(number),
            p.separation / a,
            p.half_box_change ? *p.half_box_change / a : std::nan(""),
            p.last_change / a,
            p.turn[0],
            p.turn[1],
            static_cast<double>(p.leader),
            p.non_reciprocity,
            p.min_separation / a,
            static_cast<double>(p.ending),
            p.ending_time,
            p.perpendicular ? 1.0 : 0.0};
}

MeasureTable table_of(const PairResult& pairs, double a) {
    std::vector<std::vector<double>> rows;
    rows.reserve(pairs.runs.size());
    for (const measure::PairRun& p : pairs.runs)
        rows.push_back(row_of(p, rows.size() + 1, a));
    return {"pairs.csv",
            "lengths in a, angles in rad, times in s; outcome 0 contact, 1 pursuit, 2 escape, 3 undecided; "
            "half_box_change empty: the rods did not come half a box",
            pairs_columns, transposed(rows, std::size(pairs_columns))};
}

MeasureReport report(const MeasuredCase& data) {
    const double a = data.bead_radius(), to_a = 1.0 / a;
    const PairResult p = pairs_of(data);
    const Estimate change = p.half_box_change.scaled(to_a);
    return {.values = values_of(p, to_a),
            .tables = {table_of(p, a)},
            .series = {{"delta_y", change}, {"non_reciprocity", p.non_reciprocity}},
            .line = fmt::format(
                "change of separation over half the box, in a: {} ({} of {} runs); contact {}, pursuit {}, "
                "escape {}, undecided {}; non-reciprocity {}",
                text(change), change.count, p.runs.size(), p.contact, p.pursuit, p.escape, p.undecided,
                text(p.non_reciprocity))};
}

} // namespace

MeasureKind pairs() {
    return {.name = "pairs",
            .order = 50,
            .wanted = [](const Measure& m) { return m.pairs; },
            .describe = [](const Scene&) -> std::string {
                return "separation over half the box, who turned, outcome";
            },
            .reset_late_keys = reset_late_keys,
            .report = report,
            .values = values,
            .files = files,
            .series = series};
}

} // namespace rodwake::assembly::measures
