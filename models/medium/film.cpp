#include "rodwake/medium/film.hpp"

#include "coupled_step.hpp"
#include "elastic/nonuniform_fft.hpp"
#include "film_reel.hpp"
#include "rodwake/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rodwake::medium {

namespace {

constexpr std::size_t fewest_points = 4, most_points = 1024;
constexpr double most_frames = 1e6;

} // namespace

std::vector<double> film_times(const DynamicMedium& medium, double t_end) {
    std::vector<double> times;
    if (!medium.film_interval)
        return times;
    constexpr double rounding = 1e-12; // of t_end over the interval
    const auto last = static_cast<std::size_t>(t_end / *medium.film_interval * (1.0 + rounding));
    times.reserve(last + 1);
    for (std::size_t k = 0; k <= last; ++k)
        times.push_back(std::min(static_cast<double>(k) * *medium.film_interval, t_end));
    return times;
}

std::size_t film_frame_size(const DynamicMedium& medium, std::size_t rods) {
    return 1 + 3 * rods + 2 * medium.film_grid * medium.film_grid;
}

void validate_film(const DynamicMedium& m, std::size_t rods, double t_end) {
    if (!m.film_interval)
        return;
    if (!(*m.film_interval > 0.0 && std::isfinite(*m.film_interval)))
        throw InputError(fmt::format("film_interval = {}: must be > 0 and finite; leave it out for no film",
                                     *m.film_interval));
    if (m.closure != Closure::none)
        throw InputError("film_interval needs a medium that is integrated, and a closure replaces it: leave "
                         "film_interval out, or set closure = \"none\"");
    if (m.film_grid < fewest_points || m.film_grid > most_points ||
        fourier::Fft::suitable(m.film_grid) != m.film_grid)
        throw InputError(fmt::format("film_grid = {}: must be {} to {}, even and without prime factors but "
                                     "2, 3 and 5, such as {}",
                                     m.film_grid, fewest_points, most_points,
                                     std::min(fourier::Fft::suitable(std::max(m.film_grid, fewest_points)),
                                              fourier::Fft::suitable(most_points))));
    const double spacing = m.box / static_cast<double>(m.film_grid);
    const auto points_needed = static_cast<std::size_t>(std::ceil(m.box / m.force_width));
    if (spacing > m.force_width)
        throw InputError(fmt::format("film_grid = {}: its spacing box/film_grid = {:.4g} is above "
                                     "force_width = {}, so that rods would fall between the points; take {} "
                                     "or more",
                                     m.film_grid, spacing, m.force_width,
                                     fourier::Fft::suitable(std::max(points_needed, fewest_points))));
    const double frames = std::floor(t_end / *m.film_interval) + 1.0,
                 bytes = 8.0 * frames * static_cast<double>(film_frame_size(m, rods));
    if (frames > most_frames || bytes > most_film_bytes)
        throw InputError(fmt::format("film_interval = {} and film_grid = {} make {:g} frames, {:.3g} GB: at "
                                     "most {:g} and {:.3g} GB; take a longer interval or fewer points",
                                     *m.film_interval, m.film_grid, frames, 1e-9 * bytes, most_frames,
                                     1e-9 * most_film_bytes));
}

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
