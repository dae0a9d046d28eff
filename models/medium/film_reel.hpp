#pragma once
// The frames of one run, as it reaches their times.

#include "rodwake/medium/film.hpp"

#include <optional>

namespace rodwake::medium {

class FilmReel {
public:
    /// No frames without a sink.
    FilmReel(const elastic::Medium& elastic, const DynamicMedium& medium, std::size_t rods, double t_end,
             FilmSink sink);

    /// Leaves out the frames up to `time`: they were made before.
    void skip(double time);
    /// Whether a frame is due at `until` or before it.
    bool due(double until) const { return next_ < times_.size() && times_[next_] <= until; }
    double next_time() const { return times_[next_]; }
    /// Hands on the next frame. `fields`: Coupled::fields.
    void add(std::span<const double> poses, std::span<const double> fields);

private:
    DynamicMedium medium_;
    std::size_t rods_;
    FilmSink sink_;
    std::vector<double> times_;
    std::size_t next_ = 0;
    std::optional<ModalField> modes_; ///< if there are frames
    std::optional<FieldGrid> grid_;
    std::vector<double> ux_, uy_;
};

} // namespace rodwake::medium
