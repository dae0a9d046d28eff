#include "check.hpp"

#include "rodwake/core/box_sides.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/medium/simulate.hpp"
#include "rodwake/rods/classify_outcome.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

namespace rodwake::scene {

namespace {

/// What bodies cannot be combined with, and where they start.
void bodies(const Scene& scene, const Report& report) {
    const bool some_without = std::ranges::any_of(scene.rods, [](const Rod& rod) { return !rod.body; });
    if (!scene.body && some_without)
        return report("rods", "rods: some have a body of their own and others none: give [body] for all, or "
                              "each rod a body");
    if (scene.scan && scene.scan->certificates)
        report("scan.certificates",
               "scan.certificates: outcomes of rods with bodies have no certificate; leave "
               "it out, or [body]");
    rods::RodProblem problem;
    for (const Rod& rod : scene.rods)
        problem.rods.push_back({rod.position[0], rod.position[1], rod.heading});
    problem.bodies = bodies_of(scene);
    problem.box = scene.medium ? scene.medium->box() : std::nullopt;
    problem.t_end = scene.rods_run->t_end;
    for (const rods::BodyShape& shape : problem.bodies.shapes)
        if (rods::fault_of(shape)) // reported
            return;
    try {
        rods::validate(problem);
        if (scene.medium && scene.medium->is_dynamic())
            medium::validate_bodies(scene.medium->memory(), problem);
    } catch (const InputError& error) {
        report("body", fmt::format("[body]: {}", error.what()));
    }
}

/// Noise has a method of its own.
void noise(const Scene& scene, const Report& report) {
    const RodsRun& run = *scene.rods_run;
    if (run.method)
        report(
            "rods_run.method",
            "rods_run.method: rods with [noise] are integrated by a method of their own (strong order 1.5, "
            "noise.time_step); bdf, adams and erk take no noise: set method to \"auto\" or leave it out");
    if (run.form != rods::Formulation::angle)
        report("rods_run.form",
               fmt::format("rods_run.form = \"{}\": rods with [noise] take form \"angle\" only",
                           rods::to_string(run.form)));
    if (scene.noise->capture_error && scene.rods.size() < 2)
        report("noise.capture_error",
               fmt::format("noise.capture_error = {:g}: a single rod captures none; leave it out",
                           *scene.noise->capture_error));
    if (scene.medium && scene.medium->field == FieldBackend::measured && scene.medium->measured &&
        scene.medium->measured->samples > 0)
        report("medium.measured.samples",
               fmt::format("medium.measured.samples = {}: an ensemble is drawn from the errors of the field "
                           "or from [noise], not both: set samples to 0",
                           scene.medium->measured->samples));
}

void order_of_rods(const Scene& scene, const Report& report) {
    const RodsOrder& order = *scene.rods_order;
    const bool bed = order_of_bed(scene);
    const char *length = bed ? "m" : "f/mu", *time = bed ? "s" : "f/(mu v0)";
    const double end = bed ? scene.granular->duration : scene.rods_run->t_end, counts = end - order.from;
    if (!(counts > 0.0))
        report(
            "rods_order.from",
            fmt::format("rods_order.from = {} {} is not before the end of the run, {}: nothing would count",
                        order.from, time, end));
    else if (order.block && *order.block > counts)
        report("rods_order.block", fmt::format("rods_order.block = {} {} is longer than what counts, {}",
                                               *order.block, time, counts));
    if (bed && scene.granular->container)
        return report("rods_order", "rods_order links rods in a periodic box, and this bed has a wall: leave "
                                    "[rods_order] out, or give granular.box instead of [granular.container]");
    const std::optional<PeriodicBox> box = bed            ? PeriodicBox(scene.granular->box.shorter())
                                           : scene.medium ? scene.medium->box()
                                                          : std::nullopt;
    if (!order.link && (bed || !bodies_of(scene).any()))
        return report("rods_order.link", "rods_order.link is missing: give the distance below which rods are "
                                         "linked, or [body] for rods that touch");
    if (box && order.link && *order.link > 0.5 * box->shorter())
        report("rods_order.link", fmt::format("rods_order.link = {} {}: at most half the periodic box of {}",
                                              *order.link, length, to_string(*box)));
}

} // namespace

void check_rods(const Scene& scene, const Report& report) {
    if (scene.rods_order && (scene.rods_run || scene.granular))
        order_of_rods(scene, report);
    if (order_of_bed(scene)) {
        // [rods_order] of a bed is made from frames of its motile rods.
        const auto motile = std::ranges::count_if(scene.granular->rods, [](const GranularRod& rod) {
            return rod.shape.kind == granular::RodKind::motile;
        });
        if (motile < 2)
            report("rods_order",
                   fmt::format("[rods_order] without [rods_run] analyses the motile rods of the "
                               "bed and needs at least 2; [[granular.rods]] has {}",
                               motile));
        const bool foreign = scene.measure && !scene.measure->trajectory.empty();
        if (!foreign && std::ranges::count(scene.granular->output.formats, "h5md") == 0)
            report("rods_order",
                   "[rods_order] of a bed is made from its frames: granular.output.formats must "
                   "have \"h5md\"");
    }
    if (!scene.rods_run)
        return;
    if (scene.rods_random) {
        const RandomRods& random = *scene.rods_random;
        if (scene.medium && scene.medium->box() && random.extent > scene.medium->box()->shorter())
            report("rods_random.extent", fmt::format("rods_random.extent is {} f/mu, more than the periodic "
                                                     "box of {}: rods would start on top of "
                                                     "each other's images",
                                                     random.extent, to_string(*scene.medium->box())));
    }
    if (bodies_of(scene).any())
        bodies(scene, report);
    // Only the sums of the exact field on the plane offer these.
    const RodsRun& run = *scene.rods_run;
    const bool exact = !scene.medium || scene.medium->field == FieldBackend::exact;
    const bool offered = exact && !(scene.medium && scene.medium->box());
    const auto want_plane = [&](bool asked, const char* key) {
        if (asked && !offered)
            report(
                std::string("rods_run.") + key,
                fmt::format("rods_run.{} needs the exact field on the plane: leave it out, or medium.field "
                            "(\"table\", \"dynamic\") and medium.periodic",
                            key));
    };
    want_plane(run.turning_tolerance > 0.0, "turning_tolerance");
    want_plane(run.precision != elastic::Accuracy::full, "precision");
    // Newton's method has a dense matrix, and its factors.
    constexpr std::size_t most = 9000; // 0.65 GB
    const std::size_t size = rods::state_size(run.form, scene.rods.size());
    if ((run.method == integrate::Method::bdf || run.form == rods::Formulation::dae) && size > most)
        report("rods_run.method",
               fmt::format(
                   "rods_run.method: \"bdf\" keeps dense matrices of {0} x {0} numbers for {1} rods in form "
                   "\"{2}\", {3:.2g} GB each: at most {4} rods; \"erk\" takes any number",
                   size, scene.rods.size(), rods::to_string(run.form),
                   8e-9 * static_cast<double>(size) * static_cast<double>(size),
                   most / rods::state_size(run.form, 1)));
    if (noisy(scene) || (scene.noise && scene.scan)) // whose points may have noise
        noise(scene, report);
}

namespace {

void dynamic(const Scene& scene, const Report& report) {
    const Medium& m = *scene.medium;
    if (m.periodic)
        report("medium.periodic", "medium.periodic cannot be combined with medium.field = \"dynamic\", whose "
                                  "box is medium.dynamic.box: leave one out");
    std::vector<rods::Pose> rods;
    for (const Rod& rod : scene.rods)
        rods.push_back({rod.position[0], rod.position[1], rod.heading});
    const elastic::Medium elastic = m.fitted ? elastic::Medium{} : elastic::Medium{m.eta, m.xi};
    try {
        medium::validate(elastic, m.memory(), rods.size());
        medium::validate_start(m.memory(), rods,
                               scene.rods_run ? scene.rods_run->contact_distance : std::nullopt);
        if (scene.rods_run)
            medium::validate_film(m.memory(), rods.size(), scene.rods_run->t_end);
    } catch (const InputError& error) {
        report("medium.dynamic", fmt::format("[medium.dynamic]: {}", error.what()));
    }
    if (noisy(scene))
        report("noise", "[noise] cannot be combined with medium.field = \"dynamic\": rods with noise are "
                        "integrated in the exact field, a table or a measured one; leave one out");
    if (!scene.rods_run)
        return;
    const RodsRun& run = *scene.rods_run;
    if (run.method)
        report("rods_run.method",
               fmt::format("rods_run.method = \"{}\": with medium.field = \"dynamic\" rods and medium "
                           "are integrated by a method of their own; leave it out, or \"auto\"",
                           integrate::to_string(*run.method)));
    if (run.form != rods::Formulation::angle)
        report("rods_run.form",
               fmt::format("rods_run.form = \"{}\": medium.field = \"dynamic\" takes \"angle\"",
                           rods::to_string(run.form)));
}

/// What gamma_flow and the rows need of the medium.
void turning(const Scene& scene, const Report& report) {
    const Coupling& c = *scene.coupling;
    const bool dynamic = scene.medium && scene.medium->is_dynamic();
    if (c.gamma_flow != 0.0 && !scene.medium)
        report("coupling.gamma_flow",
               "coupling.gamma_flow turns rods to the velocity of the medium: it needs [medium]");
    if (c.gamma_flow != 0.0 && scene.medium && scene.medium->field == FieldBackend::measured)
        report("coupling.gamma_flow", "coupling.gamma_flow takes the medium's velocity from the theory, "
                                      "which medium.field = \"measured\" is "
                                      "not: take \"exact\", or leave gamma_flow out");
    if (c.gamma_flow != 0.0 && dynamic && scene.medium->memory().inertia != 0.0)
        report("coupling.gamma_flow",
               "coupling.gamma_flow takes the medium's velocity from its forces, which needs "
               "medium.dynamic.inertia = 0");
    if (c.rows.any() && dynamic)
        report("coupling.gamma_rows",
               "coupling.gamma_rows is not integrated with medium.field = \"dynamic\": take "
               "\"exact\", or leave gamma_rows out");
}

} // namespace

void check_medium(const Scene& scene, const Report& report) {
    if (scene.medium && scene.medium->field == FieldBackend::measured) {
        const std::string path = "medium.field";
        if (!scene.medium->measured)
            report(path, "medium.field = \"measured\" needs [medium.measured] with file, the measure.h5 of "
                         "rodwake measure");
        if (!scene.scales)
            report(path, "medium.field = \"measured\" needs [scales] with f_over_mu: what f/mu is in the "
                         "bed that was measured");
        if (scene.medium->fitted)
            report(path, "medium.field = \"measured\" needs eta and xi of its own for theory beyond the "
                         "measured edge: medium.fitted = true takes them from [fit]");
    }

    // Tables have the symmetries of the square.
    if (scene.medium && scene.medium->field == FieldBackend::table && scene.medium->periodic &&
        !scene.medium->periodic->square())
        report("medium.field",
               fmt::format("medium.field = \"table\": tables are of square boxes, and medium.periodic is {}; "
                           "take \"exact\"",
                           to_string(*scene.medium->periodic)));
    if (scene.medium && scene.medium->is_dynamic())
        dynamic(scene, report);
    if (scene.coupling)
        turning(scene, report);
}

} // namespace rodwake::scene
