#include "check_medium.hpp"

#include "rodwake/core/box_sides.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/medium/simulate.hpp"

#include <fmt/format.h>

#include <vector>

namespace rodwake::scene {

namespace {

using Report = std::function<void(const std::string&, const std::string&)>;

void measured(const Scene& scene, const Report& report) {
    if (!scene.medium->measured)
        report("medium.field",
               "medium.field = \"measured\" needs [medium.measured] with file, the measure.h5 of "
               "rodwake measure");
    if (!scene.scales)
        report("medium.field",
               "medium.field = \"measured\" needs [scales] with f_over_mu: what f/mu is in the "
               "bed that was measured");
    if (scene.medium->fitted)
        report("medium.field",
               "medium.field = \"measured\" needs eta and xi of its own for theory beyond the "
               "measured edge: medium.fitted = true takes them from [fit]");
}

/// The rods' run as a dynamic medium can take it.
void dynamic_run(const RodsRun& run, const Report& report) {
    if (run.method)
        report("rods_run.method",
               fmt::format("rods_run.method = \"{}\": with medium.field = \"dynamic\" rods and medium "
                           "are integrated by a method of their own; leave it out, or \"auto\"",
                           integrate::to_string(*run.method)));
    if (run.form != rods::Form::angle)
        report("rods_run.form",
               fmt::format("rods_run.form = \"{}\": medium.field = \"dynamic\" takes \"angle\"",
                           rods::to_string(run.form)));
}

void dynamic(const Scene& scene, const Report& report) {
    const Medium& m = *scene.medium;
    if (m.periodic)
        report("medium.periodic", "medium.periodic is given beside medium.field = \"dynamic\", whose box is "
                                  "medium.dynamic.box: leave one out");
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
        report("noise", "[noise] beside medium.field = \"dynamic\": rods with noise are integrated in the "
                        "exact field, a table or a measured one; leave out one of the two");
    if (scene.rods_run)
        dynamic_run(*scene.rods_run, report);
}

/// Tables have the symmetries of the square.
void table(const Medium& m, const Report& report) {
    if (m.periodic && !m.periodic->square())
        report("medium.field",
               fmt::format("medium.field = \"table\": tables are of square boxes, and medium.periodic is {}; "
                           "take \"exact\"",
                           to_string(*m.periodic)));
}

} // namespace

void check_medium(const Scene& scene, const Report& report) {
    if (scene.medium && scene.medium->field == FieldBackend::measured)
        measured(scene, report);
    if (scene.medium && scene.medium->field == FieldBackend::table)
        table(*scene.medium, report);
    if (scene.medium && scene.medium->is_dynamic())
        dynamic(scene, report);
}

} // namespace rodwake::scene
