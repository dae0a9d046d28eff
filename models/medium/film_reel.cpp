#include "film_reel.hpp"

#include "coupled_step.hpp"

#include <algorithm>

namespace rodwake::medium {

FilmReel::FilmReel(const elastic::Medium& elastic, const DynamicMedium& medium, std::size_t rods,
                   double t_end, FilmSink sink)
    : medium_(medium), rods_(rods), sink_(std::move(sink)) {
    if (!sink_ || !medium.film_interval)
        return;
    grid_.emplace(medium.film_grid);
    times_ = film_times(medium, t_end);
    modes_.emplace(elastic, medium);
    ux_.resize(grid_->points() * grid_->points());
    uy_.resize(ux_.size());
}

void FilmReel::skip(double time) {
    next_ = static_cast<std::size_t>(std::ranges::upper_bound(times_, time) - times_.begin());
}

void FilmReel::add(std::span<const double> poses, std::span<const double> fields) {
    grid_->evaluate(*modes_, summed_amplitudes(*modes_, medium_, rods_, fields), ux_, uy_);
    sink_({times_[next_++], poses, ux_, uy_});
}

} // namespace rodwake::medium
