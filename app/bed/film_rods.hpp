#pragma once
// Rods of a film: what measures take of them, and rod_tracks.csv.

#include "bed/measure_kind.hpp"
#include "rodwake/core/record.hpp"
#include "rodwake/measure/tracks.hpp"

#include <limits>
#include <string>
#include <vector>

namespace rodwake::app {

/// A rod of the film, in tracks.json.
struct FilmRod {
    std::int64_t number = 0;
    std::size_t frames = 0, known = 0;
    double from = 0.0, to = 0.0, length = std::numeric_limits<double>::quiet_NaN();

    static constexpr auto fields() {
        using R = FilmRod;
        return std::tuple{field("number", &R::number, {"1", "in the file"}),
                          field("frames", &R::frames, {"1", "in which it is seen"}),
                          field("known", &R::known, {"1", "of them, those in which its heading is known"}),
                          field("from", &R::from, {"s", "when it is seen first"}),
                          field("to", &R::to, {"s", "when it is seen last"}),
                          field("length", &R::length,
                                {"m", "mean distance of its ends (null: the file does not have them)"})};
    }
};

std::vector<FilmRod> film_rods(const measure::Tracks& tracks);

/// Throws InputError if what [measure] asks for needs rods, or headings, that the film does not have.
void require_rods(const scene::Scene& scene, const measure::Tracks& tracks, const std::string& file);

/// Poses of all rods in every frame of the film, as a run of a bed has them in tracks.csv.
class FilmRods {
public:
    explicit FilmRods(const measure::Tracks& tracks);

    /// Names "t", "x0", "y0", "theta0", "x1", ... Keeps no reference.
    RunTables tables() const;
    std::string csv() const;

private:
    std::vector<measure::HeadingTrack> poses_; ///< [rods]
};

/// Of rod_tracks.csv.
std::span<const ColumnInfo> film_rod_columns();

} // namespace rodwake::app
