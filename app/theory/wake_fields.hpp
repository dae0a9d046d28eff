#pragma once
// The wakes that the scenes of a run ask for, by medium.field: exact, from a table, or measured.

#include "rodwake/app/wake_tables.hpp"
#include "rodwake/elastic/measured_field.hpp"
#include "run/stage_kind.hpp"

#include <memory>
#include <vector>

namespace rodwake::app {

/// medium.field of these rods; exact without a medium.
scene::FieldBackend field_of(const RodsPlan& plan);

/// Whether the field comes from a fit or a map that is made anew.
bool has_new_field(const scene::Scene& scene, const StageChanges& all);

/// StageKind::read of the stages in a field: requires the file of a measured one.
void read_field_file(PlanInputs& inputs, const scene::Scene& scene, const InputRequest& request);

/// Of one stage. Not thread-safe.
class WakeFields {
public:
    /// `directory`: of the run, where measures of its own may stand. The context must outlive this.
    WakeFields(const RunContext& context, std::filesystem::path directory, Logger log)
        : directory_(std::move(directory)), log_(std::move(log)), tables_(context) {}
    explicit WakeFields(const Session& session)
        : WakeFields(session.context, session.directory.path(), session.log) {}

    std::shared_ptr<const elastic::WakeField> of(const scene::Scene& scene);
    /// With field = "measured"; smoothed at most once. Throws InputError as read_measured does.
    std::shared_ptr<const elastic::MeasuredDisplacement> measured(const scene::Scene& scene);

private:
    std::filesystem::path directory_;
    Logger log_;
    WakeTables tables_;
    struct Smoothed {
        scene::Medium medium;
        double f_over_mu; ///< the data are in units of it
        std::shared_ptr<const elastic::MeasuredDisplacement> field;
    };
    std::vector<Smoothed> measured_;
};

} // namespace rodwake::app
