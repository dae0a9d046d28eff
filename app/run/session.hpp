#pragma once
// What the stages of one command share: the scene, the run directory, the result file and the log.

#include "log.hpp"
#include "rodwake/app/plan.hpp"
#include "rodwake/app/run_folder.hpp"
#include "rodwake/store/hdf5_writer.hpp"

#include <chrono>

namespace rodwake::app {

class Session {
public:
    /// Takes the run folder and marks its stages unfinished.
    Session(Plan plan, const std::filesystem::path& folder, RunContext context);

    const RunContext context;
    const Plan plan;
    const RunFolder directory;
    const Logger log;
    const OutputUnits units;
    store::Hdf5Writer results;

    /// The scene with the medium that was fitted, once it was; else as read. What the theory stages model.
    bool fitted() const { return fitted_.has_value(); }
    const scene::Scene& modelled() const { return fitted_ ? *fitted_ : plan.scene; }
    void use_medium(double eta, double xi);

    /// A stage is done, whatever becomes of those after it.
    void finished(Stage stage) { finished_.push_back(stage); }
    /// Puts the result file in place and records how the run ended.
    void close(StageEnd end);
    /// Records that an exception ended the run; its results are dropped.
    void fail(const std::string& why) noexcept;

private:
    void tell_lost() const;
    void write_provenance(const std::string& status, bool results_kept) const;
    std::vector<Stage> finished_;
    bool closing_ = false;
    std::optional<scene::Scene> fitted_;
    std::chrono::steady_clock::time_point start_;
};

/// Attributes of a group, in output units.
void write_couplings(store::Hdf5Writer& results, const std::string& group, const scene::Coupling& coupling,
                     const OutputUnits& units);

} // namespace rodwake::app
