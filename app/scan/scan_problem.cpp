#include "rodwake/app/scan_problem.hpp"

#include "bed/granular_summary.hpp"
#include "bed/run_tables.hpp"
#include "rodwake/core/encounter.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/scene/read.hpp"
#include "run/record_table.hpp"
#include "scan_parts.hpp"
#include "scan_values.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rodwake::app {

PointProblem::PointProblem(const ScanPlan& plan)
    : plan_(plan), scene_(std::make_unique<scene::Scene>(plan.base)), problem_(rod_problem(*scene_)) {
    if (auto& run = scene_->rods_run) // outputs that follow an end of the point's own, and are few
        run->output_times = scene::output_grid(run->t_end / scene::default_outputs, run->t_end);
    for (const ScanPlan::VariedKey& key : plan.keys)
        direct_.push_back(place_of(key, *scene_, problem_));
    if (std::ranges::count(direct_, nullptr) > 0)
        direct_.clear();
}

double* PointProblem::place_of(const ScanPlan::VariedKey& key, const scene::Scene& scene,
                               rods::RodProblem& problem) {
    if (key.whole || !key.words.empty())
        return nullptr;
    if (scene.coupling && scene.coupling->polar_basis != scene::PolarBasis::divergence &&
        scene.coupling->gamma_flow == 0.0)
        if (constexpr std::string_view table = "coupling."; key.key.starts_with(table))
            if (const auto* coupling = rods::find_coupling(std::string_view(key.key).substr(table.size())))
                return &(problem.couplings.*coupling->number);
    for (std::size_t k = 0; k < problem.rods.size(); ++k) {
        const std::string rod = fmt::format("rods.{}.", k);
        if (key.key == rod + "position.0")
            return &problem.rods[k].x;
        if (key.key == rod + "position.1")
            return &problem.rods[k].y;
        if (key.key == rod + "heading")
            return &problem.rods[k].heading;
    }
    return nullptr;
}

const rods::RodProblem& PointProblem::at(const scan::Point& point) {
    if (direct_.empty()) {
        if (const auto wrong = set_point(plan_, *scene_, point))
            throw InputError(*wrong);
        problem_ = rod_problem(*scene_);
        problem_.output_times.clear();
    }
    const std::span<const double> at = values_of(plan_.design, point);
    for (std::size_t k = 0; k < direct_.size(); ++k) // the axes' ends were tried, and ranges are intervals
        *direct_[k] = at[plan_.keys[k].axis] * plan_.keys[k].scale;
    return problem_;
}

// What a scan depends on: the part of the scene that its points are made from.

namespace {

/// A bed, and when two of its rods touch.
scene::Scene bed_keys(const scene::Scene& scene) {
    scene::Scene key;
    key.path = scene.path;
    key.granular = scene.granular;
    if (scene.measure && scene.measure->contact_distance)
        key.measure.emplace().contact_distance = scene.measure->contact_distance;
    return key;
}

} // namespace

void leave_out_outputs(std::optional<scene::RodsRun>& run) {
    if (!run)
        return;
    run->output_times = {run->t_end};
    run->t_end_from_outputs = false;
}

scene::Scene scan_base(const scene::Scene& scene) {
    if (scan_subject(scene) == scene::ScanSubject::beds)
        return bed_keys(scene);
    scene::Scene base = scene;
    base.scan.reset();
    base.field.reset();
    base.granular.reset();
    base.figures.clear();
    leave_out_outputs(base.rods_run);
    return base;
}

scan::Columns columns_of_rods(const scene::Scene& scene) {
    scan::Columns columns;
    for (const Ending ending : all_endings)
        columns.outcomes.emplace_back(rodwake::to_string(ending));
    EncounterEnd some;
    some.turn.resize(scene.rods.size());
    for_each_number(some, told_turns, [&](const auto& field, int rod, double) {
        columns.observables.push_back(numbered(field.name, rod));
    });
    if (scene.rods.size() > 2)
        for (const std::string_view name : field_names<MetPair>())
            columns.observables.emplace_back(name);
    if (scene.noise)
        for (const std::string_view name : field_names<CaptureNumbers>())
            columns.observables.emplace_back(name);
    return columns;
}

std::string scan_key(const scene::Scene& scene) {
    const bool beds = scan_subject(scene) == scene::ScanSubject::beds;
    scene::Scene key = beds ? bed_keys(scene) : scene;
    key.title.clear();
    key.field.reset();
    key.figures.clear();
    key.fit.reset();
    if (beds) {
        key.granular->runs = 1; // more of them go on with those there are
        key.granular->output.checkpoint = scene::GranularOutput{}.checkpoint;
    } else {
        key.granular.reset();
        key.measure.reset();
    }
    leave_out_outputs(key.rods_run);
    if (key.rods_run)
        key.rods_run->max_steps = scene::RodsRun{}.max_steps; // a limit, raised when it was met
    if (scene.scan) {
        // Design and axes as far as they decide what a point of some number is.
        const scene::Scan& scan = *scene.scan;
        scene::Scan& kept = key.scan.emplace();
        kept.design = scan.design;
        kept.axes = scan.axes;
        kept.certificates = scan.certificates;
        kept.decide = scan.decide;
        if (scan.design == scene::ScanDesign::critical) {
            kept.solve_for = scan.solve_for;
            kept.from = scan.from, kept.to = scan.to;
            kept.spacing = scan.spacing, kept.count = scan.count;
            kept.between = scan.between, kept.tolerance = scan.tolerance;
            kept.audit = scan.audited(), kept.seed = scan.seed;
        }
        for (scene::ScanAxis& axis : kept.axes)
            axis.label.clear();
        if (scan.design == scene::ScanDesign::lhs) { // another number of slices is another sample
            kept.samples = scan.samples;
            kept.seed = scan.seed;
        }
    }
    return scene::to_plain_toml(key);
}

namespace {

constexpr std::size_t told_rods = 5; ///< rods with columns of their own

bool has_pair(const scene::Scene& scene) { return scene.granular->rods.size() == 2; }

/// What the summary of a run tells behind the numbers of a pair, which have a time of their own.
std::vector<SummaryNumber> told_numbers(const scene::Scene& scene) {
    std::vector<SummaryNumber> described =
        summary_numbers(numbers_to(std::min(scene.granular->rods.size(), told_rods)), false);
    const std::string_view time = field_names<PairNumbers>().front();
    std::erase_if(described, [&](const SummaryNumber& number) {
        return number.scan_column.empty() || (has_pair(scene) && number.scan_column == time);
    });
    return described;
}

} // namespace

scan::Columns columns_of_beds(const scene::Scene& scene) {
    scan::Columns columns;
    if (has_pair(scene)) // tracks tell no orbits
        for (const Ending ending : std::span(all_endings).first(4))
            columns.outcomes.emplace_back(rodwake::to_string(ending));
    else
        columns.outcomes = {"finished"};
    if (has_pair(scene))
        for_each_number(PairNumbers{}, 2, [&](const auto& field, int rod, double) {
            columns.observables.push_back(numbered(field.name, rod));
        });
    for (const SummaryNumber& number : told_numbers(scene))
        columns.observables.push_back(number.scan_column);
    return columns;
}

std::vector<double> costs_of_beds(const ScanPlan& plan) {
    const scan::PointList points(plan.design);
    std::vector<double> costs(static_cast<std::size_t>(scan::places(plan.design)), 0.0);
    for (std::size_t index = 0; index < costs.size(); ++index)
        try {
            costs[index] =
                sphere_steps(scanned_bed(plan, points.at_place(static_cast<std::int64_t>(index))).problem);
        } catch (const InputError&) { // its point fails, with this cause
        }
    return costs;
}

BedPlan scanned_bed(const ScanPlan& plan, const scan::Point& point) {
    BedPlan bed{{"scene", "", "", plan.base}, {}, {}, {}};
    if (const auto wrong = set_point(plan, bed.of.scene, point))
        throw InputError(*wrong);
    bed.problem = granular_problem(bed.of.scene);
    std::erase(bed.of.scene.granular->output.formats, "xyz_if_short"); // one run is short, a thousand are not
    bed.schedule = granular_schedule(*bed.of.scene.granular, bed.problem);
    return bed;
}

BedObservables observables_of(const scene::Scene& scene, const RunTables& run) {
    BedObservables yield;
    if (has_pair(scene)) {
        const PairNumbers pair = pair_numbers(scene, run);
        yield.outcome = static_cast<std::int32_t>(pair.outcome);
        for_each_number(pair, 2, [&](const auto&, int, double number) { yield.values.push_back(number); });
    }
    for (const SummaryNumber& number : told_numbers(scene))
        yield.values.push_back(run.summary(number.path, number.path));
    return yield;
}

} // namespace rodwake::app
