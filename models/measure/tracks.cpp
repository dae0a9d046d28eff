#include "rodwake/measure/tracks.hpp"

#include "track_rods.hpp"

#include "rodwake/core/box_sides.hpp"
#include "rodwake/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <unordered_map>

namespace rodwake::measure {

namespace {

using Index = std::vector<std::uint32_t>;

[[noreturn]] void refuse_film(const std::string& file, const std::string& why) {
    throw InputError(file + ": " + why);
}

/// When the frames were, and which each row belongs to.
struct Film {
    std::vector<double> time;
    std::vector<std::int64_t> tick;
    double interval = 0.0;
    bool on_grid = true;
    Index frame; ///< [rows]
};

/// A grid of which more is missing says nothing: displacements then go by the times themselves.
constexpr double sparsest_grid = 4.0;

void leave_grid(Film& film) {
    film.on_grid = false;
    film.tick.resize(film.time.size());
    std::iota(film.tick.begin(), film.tick.end(), 0);
    film.interval = (film.time.back() - film.time.front()) / static_cast<double>(film.time.size() - 1);
}

/// Different values, rising, and which of them each row has.
template<class T>
std::vector<T> different(const std::vector<T>& values) {
    std::vector<T> found;
    std::unordered_map<T, bool> seen;
    for (std::size_t i = 0; i < values.size(); ++i)
        if ((i == 0 || values[i] != values[i - 1]) && seen.emplace(values[i], true).second)
            found.push_back(values[i]);
    std::ranges::sort(found);
    return found;
}

/// Frames may be numbered 0, 5, 10, ..., or 0, 1, 2, 4, 8, ...
Film film_of_frames(const std::vector<std::int64_t>& frame, double per_second, const std::string& file) {
    const std::vector<std::int64_t> all = different(frame);
    if (all.size() < 2)
        refuse_film(file, fmt::format("all rows are of frame {}: tracks need at least two frames", all[0]));
    const auto since = [&](std::int64_t f) { // the difference of any two fits into 64 bits without a sign
        return static_cast<std::uint64_t>(f) - static_cast<std::uint64_t>(all.front());
    };
    std::uint64_t step = 0;
    for (const std::int64_t f : all)
        step = std::gcd(step, since(f));
    Film film;
    film.interval = static_cast<double>(step) / per_second;
    for (const std::int64_t f : all) {
        film.time.push_back(static_cast<double>(since(f)) / per_second);
        film.tick.push_back(static_cast<std::int64_t>(since(f) / step));
    }
    if (static_cast<double>(film.tick.back()) >= sparsest_grid * static_cast<double>(all.size()))
        leave_grid(film);
    film.frame.reserve(frame.size());
    for (const std::int64_t f : frame)
        film.frame.push_back(static_cast<std::uint32_t>(std::ranges::lower_bound(all, f) - all.begin()));
    return film;
}

/// Times as they are if evenly spaced to a millionth, else on the grid nearest to them if they lie within a
/// tenth of its step, else as they are and on no grid.
Film film_of_times(const std::vector<double>& time, const std::string& file) {
    std::vector<double> all = different(time);
    const double rounding = 1e-12 * std::max(std::abs(all.front()), std::abs(all.back()));
    all.erase(std::unique(all.begin(), all.end(), [&](double a, double b) { return b - a <= rounding; }),
              all.end());
    if (all.size() < 2)
        refuse_film(file,
                    fmt::format("all rows are of time {:g} s: tracks need at least two frames", all[0]));
    double step = all.back() - all.front();
    for (std::size_t i = 1; i < all.size(); ++i)
        step = std::min(step, all[i] - all[i - 1]);
    const double count = std::round((all.back() - all.front()) / step);
    Film film;
    film.on_grid = count < sparsest_grid * static_cast<double>(all.size());
    film.interval = step = (all.back() - all.front()) / count;
    for (std::size_t i = 0; i < all.size() && film.on_grid; ++i) {
        const double k = std::round((all[i] - all.front()) / step), on = all.front() + k * step;
        film.on_grid = std::abs(all[i] - on) <= 0.1 * step;
        film.tick.push_back(static_cast<std::int64_t>(k));
        film.time.push_back(std::abs(all[i] - on) <= 1e-9 * step ? all[i] : on);
    }
    if (!film.on_grid) {
        film.time = all;
        leave_grid(film);
    } else if (film.tick[1] == 1) {
        film.interval = film.time[1] - film.time[0];
    }
    film.frame.reserve(time.size());
    for (const double t : time)
        film.frame.push_back(static_cast<std::uint32_t>(std::ranges::upper_bound(all, t) - all.begin() - 1));
    return film;
}

/// In the layout's box, with image indices.
struct BoxPosition {
    double x, y;
    std::int32_t image_x = 0, image_y = 0;
};

/// Where a number of the file was seen last (unwrapped, if there are image indices), and which bead or rod
/// that was.
struct Trail {
    std::size_t frame = 0;
    double x = 0.0, y = 0.0;
    std::uint32_t particle = untracked;
    bool rod = false;
};

class Ordering {
public:
    Ordering(TrackRows rows, const TrackScale& scale, const std::string& file)
        : rows_(std::move(rows)), scale_(scale), file_(file) {}

    Tracks tracks() {
        scale_places();
        Film film = rows_.time.empty() ? film_of_frames(rows_.frame, scale_.frames_per_second, file_)
                                       : film_of_times(rows_.time, file_);
        if (hull_)
            warn_of_far_spot();
        rows_.frame = {};
        rows_.time = {};

        // Rows by frame, in a frame by id, else as in the file.
        std::vector<std::size_t> start(film.time.size() + 1, 0);
        for (const std::uint32_t f : film.frame)
            ++start[f + 1];
        std::partial_sum(start.begin(), start.end(), start.begin());
        Index order(film.frame.size());
        std::vector<std::size_t> next(start.begin(), start.end() - 1);
        for (std::size_t i = 0; i < order.size(); ++i)
            order[next[film.frame[i]]++] = static_cast<std::uint32_t>(i);
        const auto by_id = [&](std::uint32_t i) { return rows_.id[i]; };
        for (std::size_t f = 0; f + 1 < start.size(); ++f) {
            const auto rows = std::span(order).subspan(start[f], start[f + 1] - start[f]);
            if (!std::ranges::is_sorted(rows, {}, by_id))
                std::ranges::stable_sort(rows, {}, by_id);
        }
        film.frame = {};
        out_.time = std::move(film.time);
        out_.tick = std::move(film.tick);
        out_.interval = film.interval;
        out_.on_grid = film.on_grid;
        take_all(order, start);
        settle_rods(out_, spacing_, scale_.thin_end_ahead, !rows_.certain_ids && !out_.has_images);

        // A wrong unit shows in the cover: it is off by 1000 and more. The sparsest suspensions that are
        // filmed cover some 1e-3; discs cover pi/sqrt(12) = 0.907 at most.
        const double a = scale_.bead_radius,
                     side = std::sqrt(seen_area(layout_of(out_))) +
                            (hull_ ? std::sqrt(std::numbers::pi) * a : 0.0), // a hull is one of centres
            covered =
                out_.beads_per_frame() * std::numbers::pi * std::pow(a / side, 2) * out_.mean_square_radius();
        if (!out_.x.empty() && (covered < 1e-3 || covered > 0.91))
            out_.warnings.push_back(fmt::format("{}: beads cover {:.2g} of the window: is tracks.pixel or "
                                                "tracks.bead_radius right?",
                                                file_, covered));
        return std::move(out_);
    }

private:
    void scale_places() {
        out_.counts.rows = rows_.size();
        out_.counts.dangling = rows_.dangling;
        out_.warnings = std::move(rows_.warnings);
        out_.bead_radius = scale_.bead_radius;
        out_.kind_radii = scale_.kind_radii;
        out_.has_images = scale_.box && !rows_.image_x.empty();
        for (std::size_t i = 0; i < rows_.size(); ++i) {
            rows_.x[i] *= scale_.pixel;
            rows_.y[i] *= scale_.pixel;
        }
        if (scale_.box) {
            out_.box = *scale_.box;
            return;
        }
        Window window;
        try {
            window = scale_.window ? *scale_.window : Window::hull(rows_.x, rows_.y);
        } catch (const InputError& error) {
            refuse_film(file_, error.what());
        }
        low_ = window.low();
        out_.window = window.moved(-low_.x, -low_.y);
        // The farthest corner as it comes out of the same subtraction as places do.
        const Corner high = window.high();
        out_.box = {high.x - low_.x, high.y - low_.y};
        hull_ = !scale_.window;
    }

    /// One wrong row makes a hull that is mostly empty.
    void warn_of_far_spot() {
        constexpr double far = 20.0; // interquartile ranges from the median
        double farthest = far;
        std::optional<std::size_t> row;
        for (const auto* positions : {&rows_.x, &rows_.y}) {
            std::vector<double> sorted = *positions;
            const auto at = [&](std::size_t quarter) {
                const auto nth = sorted.begin() + static_cast<std::ptrdiff_t>(quarter * sorted.size() / 4);
                std::ranges::nth_element(sorted, nth);
                return *nth;
            };
            const double low = at(1), middle = at(2), range = at(3) - low;
            for (std::size_t i = 0; i < positions->size(); ++i)
                if (const double off = std::abs((*positions)[i] - middle);
                    off > farthest * range && range > 0.0) {
                    farthest = off / range;
                    row = i;
                }
        }
        if (!row)
            return;
        const std::string frame = rows_.time.empty() ? fmt::format("frame {}", rows_.frame[*row])
                                                     : fmt::format("t = {:g} s", rows_.time[*row]);
        out_.warnings.push_back(fmt::format(
            "{}: {}: a spot at ({:g}, {:g}) of the file lies far from all others, and the window is the hull "
            "of all: set tracks.window to leave such spots out",
            file_, frame, rows_.x[*row] / scale_.pixel, rows_.y[*row] / scale_.pixel));
    }

    void take_all(const Index& order, const std::vector<std::size_t>& start) {
        const double area = out_.window ? out_.window->area() : out_.box.area();
        const double each = area * static_cast<double>(out_.frames()) / static_cast<double>(rows_.size());
        spacing_ = std::sqrt(2.0 / std::sqrt(3.0) * each);

        // How far a number may go between two frames (gap: it was missing in between) and still be the same.
        step_ = gap_ = HUGE_VAL;
        if (scale_.longest_step) {
            step_ = gap_ = *scale_.longest_step;
            out_.cut_rule =
                fmt::format("more than tracks.longest_step = {:.3g} a away", step_ / scale_.bead_radius);
        } else if (!scale_.box && rows_.certain_ids && rows_.box) {
            // The window shows a periodic box: particles that leave on one side come in on the other.
            step_ = gap_ = 0.5 * scale_.pixel * rows_.box->shorter();
            out_.cut_rule = "across the border of the file's box";
        } else if (!scale_.box && !rows_.certain_ids) {
            step_ = 3.0 * spacing_;
            gap_ = spacing_;
            out_.cut_rule = fmt::format("more than 3 mean spacings of {:.3g} a away, or 1 after a gap; "
                                        "tracks.longest_step sets another distance",
                                        spacing_ / scale_.bead_radius);
        }

        out_.x.reserve(order.size());
        out_.y.reserve(order.size());
        out_.bead.reserve(order.size());
        for (std::size_t f = 0; f < out_.frames(); ++f) {
            out_.start.push_back(out_.x.size());
            take_frame(f, std::span(order).subspan(start[f], start[f + 1] - start[f]));
        }
        out_.start.push_back(out_.x.size());
        out_.counts.empty_frames = static_cast<std::size_t>(out_.tick.back()) + 1 - out_.frames();
        if (out_.x.empty() && out_.rods.empty())
            refuse_film(file_,
                        fmt::format("no bead lies in the window: {} rows are outside; see tracks.window "
                                    "and tracks.pixel",
                                    out_.counts.outside));
    }

    void take_frame(std::size_t frame, std::span<const std::uint32_t> rows) {
        frame_beads_.clear();
        const std::uint32_t* before = nullptr;
        for (const std::uint32_t& row : rows) {
            const bool again = before && rows_.id[row] != no_track && rows_.id[row] == rows_.id[*before] &&
                               is_rod(row) == is_rod(*before);
            before = &row;
            if (again)
                ++out_.counts.repeated;
            else
                take_row(frame, row);
        }
        if (!std::ranges::is_sorted(frame_beads_, {}, &TrackedBead::bead))
            std::ranges::stable_sort(frame_beads_, {}, &TrackedBead::bead);
        for (const TrackedBead& seen : frame_beads_) {
            out_.bead.push_back(seen.bead);
            out_.x.push_back(seen.place.x);
            out_.y.push_back(seen.place.y);
            if (!rows_.radius.empty())
                out_.radius.push_back(seen.radius);
            if (out_.has_images) {
                out_.image_x.push_back(seen.place.image_x);
                out_.image_y.push_back(seen.place.image_y);
            }
        }
    }

    bool is_rod(std::uint32_t row) const { return !rows_.is_rod.empty() && rows_.is_rod[row] != 0; }

    void take_row(std::size_t frame, std::uint32_t row) {
        BoxPosition place{rows_.x[row], rows_.y[row]};
        if (out_.has_images) {
            place.image_x = rows_.image_x[row];
            place.image_y = rows_.image_y[row];
        }
        if (scale_.box) {
            const BoxPosition given = place;
            place.x = into_box(given.x, out_.box.x);
            place.y = into_box(given.y, out_.box.y);
            place.image_x += static_cast<std::int32_t>(std::lround((given.x - place.x) / out_.box.x));
            place.image_y += static_cast<std::int32_t>(std::lround((given.y - place.y) / out_.box.y));
        } else {
            place.x -= low_.x;
            place.y -= low_.y;
            if (!hull_ && !(out_.window->inside_by(place.x, place.y) >= 0.0)) {
                ++out_.counts.outside;
                return;
            }
            place.x = std::clamp(place.x, 0.0, out_.box.x); // rounding, of a circle
            place.y = std::clamp(place.y, 0.0, out_.box.y);
        }
        const bool rod = is_rod(row);
        const bool own = !rows_.radius.empty() && !std::isnan(rows_.radius[row]);
        const double radius = own ? rows_.radius[row] * scale_.pixel : scale_.bead_radius;
        if (rows_.id[row] == no_track) {
            ++out_.counts.untracked;
            if (!rod)
                frame_beads_.push_back({untracked, place, radius});
            return;
        }
        const double x = out_.has_images ? std::fma(place.image_x, out_.box.x, place.x) : place.x,
                     y = out_.has_images ? std::fma(place.image_y, out_.box.y, place.y) : place.y;
        Trail& trail = (rod ? rod_trails_ : trails_)[rows_.id[row]];
        follow(trail, rows_.id[row], frame, x, y, rod);
        if (!rod) {
            frame_beads_.push_back({trail.particle, place, radius});
            return;
        }
        RodTrack& track = out_.rods[trail.particle];
        track.frame.push_back(frame);
        track.x.push_back(x);
        track.y.push_back(y);
        track.heading.push_back(rows_.heading.empty() ? std::nan("") : rows_.heading[row] * scale_.angle);
    }

    /// The particle goes on, or another begins under its number.
    void follow(Trail& trail, std::int64_t number, std::size_t frame, double x, double y, bool rod) {
        const bool known = trail.particle != untracked && trail.rod == rod;
        bool restarts = !known;
        if (known) {
            const double dx = x - trail.x, dy = y - trail.y,
                         away = scale_.box && !out_.has_images ? nearest_distance(dx, dy, out_.box)
                                                               : std::hypot(dx, dy);
            const auto ticks = static_cast<double>(out_.tick[frame] - out_.tick[trail.frame]);
            // rods are few, and go on while they are not seen
            restarts = away > (rod && !scale_.longest_step ? step_ * ticks : ticks > 1.0 ? gap_ : step_);
            out_.counts.restarts += restarts;
        }
        if (restarts) {
            trail.particle = static_cast<std::uint32_t>(rod ? out_.rods.size() : out_.beads);
            if (rod)
                out_.rods.emplace_back().number = number;
            else
                ++out_.beads;
        } else if (!rod) {
            out_.counts.missing += frame - trail.frame - 1;
        }
        trail = {frame, x, y, trail.particle, rod};
    }

    struct TrackedBead {
        std::uint32_t bead;
        BoxPosition place;
        double radius; ///< m
    };

    TrackRows rows_;
    const TrackScale& scale_;
    const std::string& file_;
    Tracks out_;
    Corner low_;
    bool hull_ = false;
    double spacing_ = 0.0, step_ = 0.0, gap_ = 0.0;               ///< m
    std::unordered_map<std::int64_t, Trail> trails_, rod_trails_; ///< a bead and a rod may have one number
    std::vector<TrackedBead> frame_beads_;
};

} // namespace

Tracks ordered_tracks(TrackRows rows, const TrackScale& scale, const std::string& file) {
    return Ordering(std::move(rows), scale, file).tracks();
}

} // namespace rodwake::measure
