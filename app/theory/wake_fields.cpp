#include "wake_fields.hpp"

#include "bed/measured_file.hpp"

namespace rodwake::app {

namespace {

void tell(const Logger& log, const char* component, const elastic::SmoothingReport& report) {
    log->info("measured field, {}: smoothing {:.3g}, chi2 {:.4g} of {} bins, tr(HR) {:.0f}", component,
              report.lambda, report.chi2, report.points, report.trace);
}

} // namespace

std::shared_ptr<const elastic::WakeField> WakeFields::of(const scene::Scene& scene) {
    const scene::Medium& medium = *scene.medium;
    const elastic::Medium constants{medium.eta, medium.xi};
    if (medium.field == scene::FieldBackend::exact || medium.field == scene::FieldBackend::automatic ||
        medium.is_dynamic()) // of maps; rods in a dynamic medium have no wake field
        return elastic::exact_field(constants, medium.box());
    if (medium.field == scene::FieldBackend::measured)
        return measured(scene)->field(medium.periodic);
    const double tolerance = medium.table.value_or(scene::FieldTable{}).tolerance;
    if (medium.periodic && !medium.periodic->square())
        throw InputError(
            "medium.field = \"table\" takes a square medium.periodic: take \"exact\" in a rectangle");
    if (medium.periodic)
        return elastic::table_field(tables_.periodic(constants, medium.periodic->x, tolerance));
    return elastic::table_field(tables_.plane(medium.eta, tolerance), constants);
}

std::shared_ptr<const elastic::MeasuredDisplacement> WakeFields::measured(const scene::Scene& scene) {
    const double f_over_mu = scene.scales ? scene.scales->f_over_mu : 0.0;
    for (const Smoothed& one : measured_)
        if (one.medium == *scene.medium && one.f_over_mu == f_over_mu)
            return one.field;
    const MeasuredInput input = read_measured(scene, directory_);
    auto fitted = std::make_shared<const elastic::MeasuredDisplacement>(
        input.grid, elastic::Medium{scene.medium->eta, scene.medium->xi}, input.options);
    log_->info("measured field: {}", input.file.string());
    tell(log_, "Ux", fitted->report_x());
    tell(log_, "Uy", fitted->report_y());
    measured_.push_back({*scene.medium, f_over_mu, fitted});
    return fitted;
}

} // namespace rodwake::app
