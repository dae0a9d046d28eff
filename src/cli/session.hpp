#pragma once
// What the stages of one command share: the scene, the run directory, the result file and the log.

#include "log.hpp"
#include "options.hpp"
#include "problems.hpp"
#include "rodwake/store/hdf5_writer.hpp"
#include "rodwake/store/run_directory.hpp"

#include <chrono>

namespace rodwake::cli {

/// How a stage ended; what it computed is kept in each case.
enum class StageEnd { finished, failed, interrupted };

class Session {
public:
    /// Reads the scene, takes the run directory and marks it unfinished.
    Session(const Options& options, scene::Scene scene);

    const Options options;
    const scene::Scene scene;
    const store::RunDirectory directory;
    const Logger log;
    const OutputUnits units;
    store::Hdf5Writer results;

    /// The scene with the medium that was fitted, once it was; else as read. What the theory stages model.
    const scene::Scene& modelled() const { return fitted_ ? *fitted_ : scene; }
    void use_medium(double eta, double xi);

    /// Puts the result file in place and records how the run ended.
    void close(StageEnd end);
    /// Records that an exception ended the run; its results are dropped.
    void fail(const std::string& why) const noexcept;

private:
    void write_provenance(const std::string& status) const;
    std::optional<scene::Scene> fitted_;
    std::chrono::steady_clock::time_point start_;
};

/// -o, or results/<scene name>.
std::filesystem::path output_folder(const Options& options);

} // namespace rodwake::cli
