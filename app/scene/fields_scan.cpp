// Field lists of [scan].

#include "fields.hpp"
#include "rodwake/scene/scan.hpp"

#include <algorithm>
#include <array>

namespace rodwake::scene {

void fields(Visitor& v, ScanAxis& axis) {
    v(key("key")
          .absent("keys")
          .doc("the key of the scene that varies, entries of lists by number from 0")
          .example("\"coupling.kappa\""),
      axis.key);
    v(key("keys")
          .items(1, 16)
          .written_if(!axis.keys.empty())
          .doc("several keys that vary together, instead of key")
          .example("[\"coupling.gamma1\", \"coupling.gamma2\"]"),
      axis.keys);
    v(key("factor")
          .items(1, 16)
          .absent("1 for each key")
          .doc("with keys: what the value of the axis is multiplied by for each of them")
          .example("[1.0, -1.0]"),
      axis.factor);
    v(key("label")
          .absent("the symbol of the key")
          .doc("what figures call the axis, as TeX; for tied keys that mean something else together")
          .example("\"d_0\""),
      axis.label);
    v(key("from").absent("values").doc("one end, in the units of the key").example("0.1"), axis.from);
    v(key("to").absent("values").doc("the other end, included").example("100.0"), axis.to);
    v(key("spacing").doc("how points lie between the ends; log needs ends of one sign").example("\"log\""),
      choice(axis.spacing, {{"linear", ScanSpacing::linear}, {"log", ScanSpacing::log}}));
    v(key("count")
          .within(1, 1e7)
          .doc("grid: points, both ends included; adaptive: cells at the start")
          .example("64"),
      axis.count);
    v(key("values")
          .items(1, 1'000'000)
          .absent("from, to and count")
          .doc("the values themselves: numbers, quantities with units, or words")
          .example("[0.1, 1.0, 10.0]"),
      axis.values);
}

void fields(Visitor& v, ScanRefine& refine) {
    v(key("observable")
          .required()
          .doc("column of scan.csv beside the outcome that drives refinement")
          .example("\"min_separation\""),
      refine.observable);
    v(key("step").required().above(0.0).doc("cells over which it changes by more are divided").example("0.5"),
      refine.step);
}

void fields(Visitor& v, Scan& scan) {
    using enum ScanDesign;
    v(key("design")
          .doc("grid; list (of a file); lhs (Latin hypercube), sobol: samples; adaptive: refines where the "
               "outcome changes; critical: values of solve_for at which it changes, for each point of the "
               "axes or of the file")
          .example("\"adaptive\""),
      choice(scan.design, {{"grid", grid},
                           {"list", list},
                           {"lhs", lhs},
                           {"sobol", sobol},
                           {"adaptive", adaptive},
                           {"critical", critical}}));
    v(key("solve_for")
          .written_if(scan.design == critical)
          .absent("none")
          .doc("critical: the key whose critical values are sought, any number that an encounter depends on")
          .example("\"coupling.kappa\""),
      scan.solve_for);
    v(key("from")
          .absent("none")
          .doc("critical: one end of its range, in the units of the key")
          .example("1.0"),
      scan.from);
    v(key("to").absent("none").doc("critical: the other end, included").example("120.0"), scan.to);
    v(key("spacing")
          .written_if(scan.design == critical)
          .doc("critical: how the values of the coarse pass lie between the ends; log needs ends of one sign")
          .example("\"log\""),
      choice(scan.spacing, {{"linear", ScanSpacing::linear}, {"log", ScanSpacing::log}}));
    v(key("count")
          .written_if(scan.design == critical)
          .within(2, 100'000)
          .doc("critical: values of the coarse pass; two changes between two of them are found by chance "
               "alone")
          .example("20"),
      scan.count);
    v(key("between")
          .written_if(scan.design == critical)
          .items(1, 2)
          .doc("critical: the two ends of an encounter between which the value lies: outcomes, capture "
               "(contact, bound, orbit or pursuit), or other (whatever the first does not name); [\"any\"]: "
               "every "
               "change of outcome")
          .example("[\"capture\", \"escape\"]"),
      scan.between);
    v(key("tolerance")
          .written_if(scan.design == critical)
          .within(1e-14, 0.1)
          .doc("critical: of max(|value|, range/1000), the width of the bracket")
          .example("1e-8"),
      scan.tolerance);
    v(key("resolution")
          .within(2, 1 << 20)
          .doc("adaptive: cells a side at the finest, count of each axis times a power of two")
          .example("1024"),
      scan.resolution);
    v(key("samples").within(1, 1e8).doc("lhs, sobol: points").example("1000"), scan.samples);
    v(key("file")
          .absent("none")
          .doc("list, critical: CSV whose header names the keys, a row a point")
          .example("\"points.csv\""),
      scan.file);
    v(key("seed").within(0, largest_seed).doc("of lhs and of the audit").example("1"), scan.seed);
    v(key("audit")
          .within(0, 1e7)
          .absent("1000; critical: count")
          .doc("adaptive: points tried at random in cells that were not divided, for the rate of what was "
               "missed; critical: random values of solve_for at each point, next to the coarse pass")
          .example("1000"),
      scan.audit);
    v(key("boundary_tolerance")
          .within(1e-12, 0.1)
          .absent("boundaries are not bisected")
          .doc("adaptive: boundaries between outcomes are bisected to this fraction of the axis and written "
               "to boundary.csv")
          .example("1e-8"),
      scan.boundary_tolerance);
    v(key("time_limit")
          .above(0.0)
          .absent("none")
          .doc(
              "seconds that one point, of beds one run, may take; one that takes longer is marked time_limit")
          .example("10.0"),
      scan.time_limit);
    v(key("decide")
          .doc("of rods: points that are undecided at rods_run.t_end are continued, alone, until their "
               "outcome is decided, or to rods_run.t_end_limit")
          .example("true"),
      scan.decide);
    v(key("certificates")
          .doc("of rods: whether the outcomes of rods that turn are verified, or checked by a second run, a "
               "hundred "
               "times tighter, which takes many times as long; without, they are open")
          .example("true"),
      scan.certificates);
    v(key("trajectories")
          .within(0, 100'000)
          .doc("of rods: points spread over the scan whose trajectories are stored; for beds see "
               "granular.output")
          .example("256"),
      scan.trajectories);
    v(key("max_points")
          .within(1, 1e10)
          .doc("a scan of more points, of beds of more runs, is refused before it starts")
          .example("20000000"),
      scan.max_points);
    v.list(key("axes").items(0, max_scan_axes).doc("What varies."), scan.axes);
    v.list(key("refine").items(0, 8).doc("What else than the outcome makes a cell be divided."), scan.refine);
}

namespace {

constexpr std::string_view bed_table = "granular.";

} // namespace

ScanSubject scan_subject(const Scene& scene) {
    if (!scene.granular || !scene.scan)
        return ScanSubject::rods;
    const auto of_bed = [](const std::string& key) { return key.starts_with(bed_table); };
    const bool varies_bed = std::ranges::any_of(scene.scan->axes, [&](const ScanAxis& axis) {
        return of_bed(axis.key) || std::ranges::any_of(axis.keys, of_bed);
    });
    return !scene.rods_run || varies_bed ? ScanSubject::beds : ScanSubject::rods;
}

bool can_vary(std::string_view key, ScanSubject subject) {
    // what is stored and how many runs there are is not what a run depends on
    constexpr std::array<std::string_view, 3> not_of_beds{"granular.runs", "granular.output.",
                                                          "granular.restart_from"};
    constexpr std::array<std::string_view, 14> not_of_rods{
        "scan.", "figures.", "variants.", "field.", "granular.", "measure.", "fit.", "title", "schema",
        // a scan takes the exact field, and its table has no order of rods
        "medium.field", "medium.table.", "medium.measured.", "medium.dynamic.", "rods_order."};
    const auto begins = [&](std::string_view text) { return key.starts_with(text); };
    return subject == ScanSubject::beds ? begins(bed_table) && std::ranges::none_of(not_of_beds, begins)
                                        : std::ranges::none_of(not_of_rods, begins);
}

} // namespace rodwake::scene
