#pragma once
// Frames of a dynamic medium (medium/film.hpp) on disk: a log while the run goes on, medium_film.h5 at its
// end.
//
// A checkpoint at a time counts on the frames up to it, so the log is synced before the checkpoint is
// written, and a run that is resumed keeps as many.

#include "rodwake/app/plan.hpp"
#include "rodwake/medium/film.hpp"
#include "rodwake/store/journal.hpp"

#include <filesystem>
#include <string>

namespace rodwake::app {

class RodsFilm {
public:
    /// The film of a case in the folder of its files, with the frames up to `kept_until`; negative: none.
    /// Throws InputError if these are not all there, RunError if the log cannot be written.
    RodsFilm(std::filesystem::path folder, const RodsPlan& plan, double kept_until);

    /// Throws RunError.
    void add(const medium::FilmFrame& frame);
    /// To be done before a checkpoint. Throws RunError.
    void sync() { log_.sync(); }
    /// Writes medium_film.h5 of the frames so far. Throws RunError.
    void write(const OutputUnits& units, const std::string& command);
    /// Of a run that is over.
    void remove_log();

private:
    std::filesystem::path folder_;
    const RodsPlan& plan_;
    medium::DynamicMedium medium_;
    std::size_t rods_, size_;
    store::Journal log_;
};

} // namespace rodwake::app
