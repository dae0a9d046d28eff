#pragma once
// Checkpoint of one granular run: state, sums and how much of the logs counts. It belongs to one scene, seed
// and run number.

#include "granular_cost.hpp"
#include "granular_files.hpp"
#include "rodwake/granular/record.hpp"

#include <filesystem>
#include <optional>
#include <string>

namespace rodwake::app {

struct GranularCheckpoint {
    std::string scene; ///< text that says what the run models; another text is another run
    std::string build; ///< version and git id that wrote it
    std::uint64_t seed = 0;
    std::uint32_t run = 0;
    double cpu_seconds = 0.0, wall_seconds = 0.0;
    granular::State state;
    granular::Counters tallies;
    granular::RecordSums sums{};
    granular::PressureSums pressure{};
    std::vector<granular::RodProgress> progress;
    std::vector<granular::RodThrust> thrust{};
    std::vector<granular::SampleSums> kinds{};
    LogLengths logs;
    std::string measure_keys{}; ///< MeasurePlan::key_text; empty: nothing is measured on the way
    std::vector<double> measures{};
    RunCost cost{};
};

/// States of a run at even intervals, of which all between can be made again: archive.rwc.
struct GranularArchive {
    std::string scene; ///< as GranularCheckpoint::scene
    std::string build;
    std::uint64_t seed = 0;
    std::uint32_t run = 0;
    std::vector<granular::State> states; ///< by step; the last one is the end of the run

    /// The last one at this step or before; null: that is before the first.
    const granular::State* before(std::int64_t step) const;
};

/// Throws RunError.
void write_archive(const std::filesystem::path& file, const GranularArchive& archive);
/// Throws InputError for a damaged file, or one of another version's states.
GranularArchive load_archive(const std::filesystem::path& file);

/// Throws InputError for a step after the run's end.
void require_end(std::int64_t step, const granular::GranularProblem& problem, const std::string& file);

/// A state as bytes, of one length for all states of a run, and back.
std::vector<std::byte> state_bytes(const granular::State& state);
granular::State state_of(const std::vector<std::byte>& bytes, const std::string& file);

/// Puts the checkpoint in place as the newest of two generations. Throws RunError.
void write_checkpoint(const std::filesystem::path& file, const GranularCheckpoint& checkpoint);

struct LoadedCheckpoint {
    GranularCheckpoint checkpoint;
    std::string notice; ///< why the newest generation could not be used; empty if it was
};

/// The newest usable generation; nothing if there is none. Throws InputError if there are only damaged ones,
/// or it is of a version that kept other numbers.
std::optional<LoadedCheckpoint> load_checkpoint(const std::filesystem::path& file);

} // namespace rodwake::app
