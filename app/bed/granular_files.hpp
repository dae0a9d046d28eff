#pragma once
// The files of one granular run. While it goes on, frames and rows are appended to logs whose lengths a
// checkpoint remembers; at its end they become table.csv, tracks.csv, trajectory.h5md (.xyz) and
// last_period.h5md.

#include "rodwake/app/granular.hpp"
#include "rodwake/granular/record.hpp"
#include "rodwake/store/h5md.hpp"
#include "rodwake/store/journal.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace rodwake::app {

/// Records of each log that count.
struct LogLengths {
    std::uint64_t rows = 0, frames = 0, period_frames = 0;
};

class GranularFiles {
public:
    /// Takes the logs up at these lengths, that of the archive with so many states; from zero on, makes them
    /// anew. `state`: any of the run, for the sizes of its beads.
    GranularFiles(std::filesystem::path folder, const granular::GranularProblem& problem,
                  const granular::State& state, const GranularSchedule& schedule, const LogLengths& kept,
                  std::size_t states = 0);

    void add_row(const granular::TableRow& row, const std::vector<granular::TrackPoint>& track);
    void add_frame(const granular::State& state, double time);
    void add_period_frame(const granular::State& state, double time);
    /// For the archive.
    void keep(const granular::State& state);
    std::vector<granular::State> kept_states();
    /// Everything is on the disk when this returns. Throws RunError.
    LogLengths sync();

    /// table.csv and tracks.csv of the rows so far.
    void write_tables();
    /// Turns the logs of frames into their final files.
    void finish_frames(const store::H5mdInfo& info);

private:
    std::vector<double> frame_record(const granular::State& state, double time) const;
    void write_trajectory(const std::string& name, store::Journal& log, const store::H5mdInfo& info,
                          bool for_viewers);

    std::filesystem::path folder_;
    granular::GranularProblem problem_;
    GranularSchedule schedule_;
    std::vector<granular::Clump> clumps_;
    store::FrameLayout layout_;
    std::size_t frame_doubles_, row_doubles_;
    std::optional<store::Journal> rows_, frames_, period_, states_;
};

/// Removes what an unfinished run goes on from: the checkpoints and then, once these are surely gone, the
/// logs that they need. Everything final is in place.
void remove_progress(const std::filesystem::path& folder);

} // namespace rodwake::app
