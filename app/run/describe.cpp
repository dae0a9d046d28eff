#include "describe_parts.hpp"
#include "rodwake/medium/film.hpp"

#include "rodwake/core/box_sides.hpp"
#include "rodwake/rods/classify_outcome.hpp"
#include "rodwake/scene/read.hpp"

#include <fmt/format.h>

namespace rodwake::app {

namespace {

void add_medium_lines(const scene::Scene& scene, Lines& lines) {
    if (!scene.medium)
        return;
    const scene::Medium& m = *scene.medium;
    lines.push_back({true, m.fitted ? std::string("medium: eta and xi from the fit")
                                    : fmt::format("medium: eta = {:g}, xi = {:g}", m.eta, m.xi)});
    lines.push_back({m.box().has_value(),
                     m.box() ? fmt::format("periodic box of {} for rods and field", to_string(*m.box()))
                             : "periodic images of rods: no medium.periodic, infinite plane"});
    if (m.is_dynamic()) {
        const medium::DynamicMedium d = m.memory();
        lines.push_back(
            {true,
             fmt::format("medium with{3} memory: {0} x {0} modes, force width {1:g}, {2}", d.modes,
                         d.force_width, d.start == medium::Start::steady ? "from steady fields" : "from rest",
                         d.closure == medium::Closure::none ? "" : "out")});
        lines.push_back({d.inertia > 0.0, d.inertia > 0.0
                                              ? fmt::format("inertia of the medium: {:g}", d.inertia)
                                              : "inertia of the medium: medium.dynamic.inertia is 0"});
        const bool mesh = medium::evaluation_of(d, scene.rods.size()) == medium::Evaluation::mesh;
        if (mesh)
            lines.push_back({true, "fields of many rods by fast Fourier transforms"});
        lines.push_back(
            {d.self_field, d.self_field ? "each rod in its own field too"
                           : mesh       ? "each rod in its own field: left out to first order in its turning"
                                        : "each rod in its own field: medium.dynamic.self_field is false"});
        if (d.film_interval && scene.rods_run) {
            const std::size_t frames = medium::film_times(d, scene.rods_run->t_end).size();
            const auto numbers = static_cast<double>(frames * medium::film_frame_size(d, scene.rods.size()));
            lines.push_back({true, fmt::format("film of the medium: {0} frames of {1} x {1} points, {2} in "
                                               "medium_film.h5 (twice that while it is made)",
                                               frames, d.film_grid, size_text(8.0 * numbers))});
        } else
            lines.push_back({false, "film of the medium: no medium.dynamic.film_interval"});
    }
    if (m.field == scene::FieldBackend::measured) {
        lines.push_back(
            {true, fmt::format("field measured in {}, f/mu = {:g} m; theory in its core and beyond its "
                               "edge",
                               m.measured->file, scene.scales->f_over_mu)});
        const auto samples = m.measured->samples;
        lines.push_back({samples > 0, samples > 0 ? fmt::format("errors of that field: {} draws", samples)
                                                  : "errors of that field: measured.samples is 0"});
    }
    if (m.field == scene::FieldBackend::table)
        lines.push_back({true, fmt::format("field from a table, relative error {:g}",
                                           m.table.value_or(scene::FieldTable{}).tolerance)});
}

void add_rod_lines(const Plan& plan, Lines& lines) {
    if (plan.rods.empty()) {
        lines.push_back({false, "rod dynamics: no [[rods]] and [rods_run]"});
        return;
    }
    const rods::RodProblem& problem = plan.rods.front().problem;
    const rods::Couplings& c = problem.couplings;
    const bool own =
        plan.scene.medium && plan.scene.medium->is_dynamic() && plan.scene.medium->memory().self_field;
    const bool interacting = problem.medium && c.any() && (problem.rods.size() > 1 || own);
    lines.push_back({true, fmt::format("{} rods to t = {:g}, {} variants", problem.rods.size(), problem.t_end,
                                       plan.rods.size() - 1)});
    if (const rods::Formulation form = plan.rods.front().options.form; form != rods::Formulation::angle)
        lines.push_back({true, fmt::format("form of the equations: {}", to_string(form))});
    if (!interacting)
        lines.push_back({false, problem.rods.size() < 2
                                    ? "interaction: a single rod feels no other; no field is evaluated"
                                : problem.medium       ? "interaction: no coupling, so no field is evaluated"
                                : problem.bodies.any() ? "interaction: no [medium]; only touch turns rods"
                                                       : "interaction: no [medium]; rods walk straight"});
    lines.push_back({interacting && c.apolar(),
                     c.apolar()
                         ? fmt::format("alignment with the strain axis ({})", rods::coupling_names(false))
                         : "alignment with the strain axis: kappa is 0, strain is not evaluated"});
    lines.push_back({interacting && c.polar(),
                     c.polar()
                         ? fmt::format("polar turning ({})", rods::coupling_names(true))
                         : "polar turning: gamma1 and gamma2 are 0, strain gradients are not evaluated"});
    if (plan.scene.coupling && plan.scene.coupling->gamma_flow != 0.0)
        lines.push_back(
            {interacting, fmt::format("turning to the medium's velocity: coupling.gamma_flow = {:g}, as "
                                      "polar turning",
                                      plan.scene.coupling->gamma_flow)});
    if (problem.rows.any())
        lines.push_back(
            {true,
             fmt::format("turning into the rows of a crystal along {:g} rad: coupling.gamma_rows = {:g}",
                         problem.rows.direction, problem.rows.gamma)});
    lines.push_back(
        {problem.bodies.any(),
         problem.bodies.any()
             ? fmt::format("bodies push each other: a rod stalls at an overlap of {:g} of two radii",
                           problem.bodies.stall_overlap)
             : "bodies: no [body], rods are points"});
    lines.push_back({problem.contact_distance.has_value(),
                     problem.contact_distance
                         ? fmt::format("contact stops the run at {:g}", *problem.contact_distance)
                         : "contact: no rods_run.contact_distance"});
}

/// The field depends on position over xi, so rods that only align with the strain have no other length: see
/// "Similarity" in docs/theory.md.
void add_similarity_line(const Plan& plan, Lines& lines) {
    if (plan.rods.empty() || !plan.scene.medium || !plan.scene.coupling)
        return;
    const RodsPlan& rods = plan.rods.front();
    const scene::Medium& medium = *plan.scene.medium;
    const bool aligns_only = !rods.problem.bodies.any() && rods.problem.couplings.apolar() &&
                             !rods.problem.couplings.polar() && plan.scene.coupling->gamma_flow == 0.0 &&
                             !rods.problem.rows.any() && !rods.noise;
    const bool steady_on_plane =
        medium.field == scene::FieldBackend::exact && !medium.box() && !medium.fitted;
    if (rods.problem.rods.size() < 2 || !aligns_only || !steady_on_plane || medium.xi == 1.0 ||
        rods.problem.sums.turning_tolerance > 0.0)
        return;
    lines.push_back(
        {true, fmt::format("alpha = {0:g} is a unit of length: with alpha = 1 and lengths and times "
                           "multiplied by {0:g} (start, contact distance, t_end) the encounter is "
                           "the same",
                           1.0 / medium.xi)});
}

/// What only many rods have.
void add_crowd_lines(const Plan& plan, Lines& lines) {
    if (plan.rods.empty())
        return;
    const scene::Scene& scene = plan.rods.front().of.scene;
    const rods::RodProblem& problem = plan.rods.front().problem;
    if (scene.rods_random)
        lines.push_back({true, fmt::format("rods at random in a {}, seed {}",
                                           scene::region_of(*scene.rods_random), scene.rods_random->seed)});
    if (problem.rods.size() > rods::most_followed_rods)
        lines.push_back(
            {false, fmt::format("pursuit and escape of pairs: more than {} rods", rods::most_followed_rods)});
    if (problem.sums.turning_tolerance > 0.0)
        lines.push_back({true, fmt::format("far wakes on meshes: turning rates right to {:g}, as measured",
                                           problem.sums.turning_tolerance)});
    if (problem.sums.accuracy != elastic::Accuracy::full)
        lines.push_back({true, problem.sums.accuracy == elastic::Accuracy::fine
                                   ? "sums of wakes to 1e-7 of each"
                                   : "sums of wakes in single precision"});
}

void add_order_line(const scene::Scene& scene, Lines& lines) {
    if (!scene.rods_order)
        return;
    if (order_of_bed(scene))
        lines.push_back({true, fmt::format("order of the motile rods of the bed; clusters by links of less "
                                           "than {:.4g} a",
                                           *scene.rods_order->link / scene.granular->bead_radius)});
    else
        lines.push_back({true, scene.rods_order->link
                                   ? fmt::format("order of the rods; clusters by links of less than {:g}",
                                                 *scene.rods_order->link)
                                   : "order of the rods; clusters of rods that touch"});
    if (!order_of_bed(scene) && scene.granular)
        lines.push_back(
            {false, "order of the rods of the bed: with [rods_run], [rods_order] looks at its rods"});
}

void add_scan_lines(const Plan& plan, Lines& lines) {
    if (!plan.scan) {
        lines.push_back({false, "scan: no [scan] table"});
        return;
    }
    const scan::Design& design = plan.scan->design;
    std::string axes;
    for (const scan::Axis& axis : design.axes)
        axes +=
            fmt::format("{}{} from {:g} to {:g}", axes.empty() ? "" : ", ", axis.name, axis.from, axis.to);
    std::string points;
    if (design.kind == scan::Kind::adaptive)
        points = fmt::format("refined to {} cells a side where the outcome changes", design.resolution);
    else
        points = fmt::format("{} points ({})", scan::places(design), scan::to_string(design.kind));
    if (design.kind != scan::Kind::adaptive && design.runs > 0)
        points += fmt::format(" of {} run{} of the bed each, {} runs in all", design.runs,
                              design.runs == 1 ? "" : "s", scan::size(design));
    lines.push_back({true, "scan: " + axes + ", " + points});
    if (plan.scan->subject == scene::ScanSubject::beds && plan.scene.measure)
        lines.push_back({false, "measures of scanned beds: a scan follows the rods alone, contact as in "
                                "measure.contact_distance"});
    if (plan.scan->critical)
        lines.push_back(
            {true,
             fmt::format("critical values of {} between {} at each point, to {:g}", design.axes.back().name,
                         fmt::join(plan.scan->critical->between, " and "), plan.scan->critical->tolerance)});
    if (design.boundary_tolerance > 0.0)
        lines.push_back({true, fmt::format("boundaries between outcomes to {:g} of the axis",
                                           design.boundary_tolerance)});
}

} // namespace

std::vector<PlanLine> describe(const Plan& plan) {
    Lines lines;
    add_medium_lines(plan.scene, lines);
    const scene::Scene& scene = plan.scene;
    if (const auto& field = scene.field)
        lines.push_back(
            {true, fmt::format("field of one rod: {} grid points, {} cuts",
                               field->x.empty() ? 0 : field->nx * field->ny, field->cuts.size())});
    else
        lines.push_back({false, "field maps: no [field] table"});
    add_rod_lines(plan, lines);
    add_similarity_line(plan, lines);
    add_crowd_lines(plan, lines);
    for (const RodsPlan& rods_plan : plan.rods) {
        if (!rods_plan.noise)
            continue;
        const rods::Noise& noise = rods_plan.noise->noise;
        std::string runs = fmt::format("{} runs", rods_plan.noise->runs);
        if (const auto& error = rods_plan.noise->capture_error)
            runs = fmt::format("{} to {} runs, until the capture probability is known to +- {:g}",
                               rods_plan.noise->runs,
                               std::max(rods_plan.noise->runs, rods_plan.noise->most_runs), *error);
        lines.push_back(
            {true,
             fmt::format("noise{}: D_r = {:g}, D_t = {:g}, {}, steps of at most {:.3g} "
                         "({}), strong order 1.5",
                         rods_plan.of.suffix(), noise.rotational, noise.translational, runs, noise.time_step,
                         rods_plan.of.scene.noise->time_step
                             ? "noise.time_step"
                             : "0.05 of the shortest of 1, 1/D_r and the wakes' turning time")});
    }
    const auto diffuses = [](const RodsPlan& item) {
        return item.noise && item.noise->noise.translational > 0.0;
    };
    if (noisy(plan.scene) && std::ranges::none_of(plan.rods, diffuses))
        lines.push_back({false, "diffusion of positions: noise.translational_diffusion is 0"});
    add_order_line(plan.scene, lines);
    add_scan_lines(plan, lines);
    // What the scene names and this run does not use.
    if (scene.medium && scene.medium->table && scene.medium->field == scene::FieldBackend::exact)
        lines.push_back({false, "medium.table.tolerance: not used with field = \"exact\""});
    if (scene.medium && scene.medium->measured && scene.medium->field != scene::FieldBackend::measured)
        lines.push_back({false, "medium.measured: only used with field = \"measured\""});
    if (scene.medium && scene.medium->dynamic && !scene.medium->is_dynamic())
        lines.push_back({false, "medium.dynamic: only used with field = \"dynamic\""});
    if (scene.noise && !noisy(scene))
        lines.push_back({false, "noise: rotational_diffusion and translational_diffusion are 0"});
    else if (scene.noise && !scene.rods_run)
        lines.push_back({false, "noise: no [rods_run]"});
    else if (scene.rods_run && !scene.noise)
        lines.push_back({false, "noise: no [noise] table"});
    describe_granular(plan, lines);
    describe_fit(plan, lines);
    return lines;
}

std::vector<std::string> doubts(const Plan& plan) {
    std::vector<std::string> list = scene::advice(plan.scene);
    for (const RodsPlan& rods_plan : plan.rods)
        if (const auto met = rods::contact_at_start(rods_plan.problem))
            list.push_back(fmt::format("rods{}: {} ({:g}): the run ends in contact at time 0",
                                       rods_plan.of.suffix(), met->outcome.reason,
                                       *rods_plan.problem.contact_distance));
    if (!plan.scan || plan.scan->subject != scene::ScanSubject::rods)
        return list;

    // Rods of a scan that turn towards each other with nothing to stop them.
    const scene::Scene& base = plan.scan->base;
    if (base.rods_run && !base.rods_run->contact_distance && base.coupling && !scene::bodies_of(base).any() &&
        std::ranges::count(plan.scan->keys, "rods_run.contact_distance", &ScanPlan::VariedKey::key) == 0)
        list.emplace_back("scan without rods_run.contact_distance: rods that meet run into the singularity "
                          "of their fields, and their points fail; set it, for example to 0.1");
    return list;
}

} // namespace rodwake::app
