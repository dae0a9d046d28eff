#include "rodwake/measure/tracks.hpp"

#include "track_rods.hpp"

#include "rodwake/core/box_sides.hpp"
#include "rodwake/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
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
    Index frame; ///< [rows]
};

constexpr double most_frames = 1e7;

/// One wrong number among the frames makes a film that is empty but for its ends.
void check_gaps(double count, std::size_t seen, const std::string& file) {
    if (count > 1e4 + 1e3 * static_cast<double>(seen))
        refuse_film(file,
                    fmt::format("{:g} frames from the first to the last, of which {} have rows: is a frame "
                                "or time wrong?",
                                count, seen));
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

/// Steps of the film: frames may be numbered 0, 5, 10, ...
Film film_of_frames(const std::vector<std::int64_t>& frame, double per_second, const std::string& file) {
    const std::vector<std::int64_t> all = different(frame);
    std::int64_t step = 0;
    for (std::size_t i = 1; i < all.size(); ++i)
        step = std::gcd(step, all[i] - all[i - 1]);
    if (step == 0)
        refuse_film(file, fmt::format("all rows are of frame {}: tracks need at least two frames", all[0]));
    const std::int64_t count = (all.back() - all.front()) / step + 1;
    if (static_cast<double>(count) > most_frames)
        refuse_film(file, fmt::format("frames from {} to {}: more than {:g}; is the right column named in "
                                      "tracks.columns?",
                                      all.front(), all.back(), most_frames));
    check_gaps(static_cast<double>(count), all.size(), file);
    Film film;
    for (std::int64_t k = 0; k < count; ++k)
        film.time.push_back(static_cast<double>(k * step) / per_second);
    film.frame.reserve(frame.size());
    for (const std::int64_t f : frame)
        film.frame.push_back(static_cast<std::uint32_t>((f - all.front()) / step));
    return film;
}

/// Times as they are if evenly spaced to a millionth, else on the grid nearest to them.
Film film_of_times(const std::vector<double>& time, const std::string& file) {
    const std::vector<double> all = different(time);
    if (all.size() < 2)
        refuse_film(file,
                    fmt::format("all rows are of time {:g} s: tracks need at least two frames", all[0]));
    double step = all.back() - all.front();
    for (std::size_t i = 1; i < all.size(); ++i)
        step = std::min(step, all[i] - all[i - 1]);
    const double count = std::round((all.back() - all.front()) / step);
    if (count > most_frames)
        refuse_film(file, fmt::format("two frames are {:g} s apart, and all of them take {:g} s: times must "
                                      "be those of frames, evenly spaced; round them",
                                      step, all.back() - all.front()));
    step = (all.back() - all.front()) / count;
    check_gaps(count, all.size(), file);
    Film film;
    for (double k = 0.0; k <= count; k += 1.0)
        film.time.push_back(all.front() + k * step);
    std::unordered_map<double, std::uint32_t> number;
    for (const double t : all) {
        const double k = std::round((t - all.front()) / step), off = t - (all.front() + k * step);
        if (std::abs(off) > 0.1 * step)
            refuse_film(file,
                        fmt::format("a frame at {:g} s between those {:g} s apart: times must be evenly "
                                    "spaced; leave the frames between out",
                                    t, step));
        number.emplace(t, static_cast<std::uint32_t>(k));
        if (std::abs(off) <= 1e-9 * step)
            film.time[static_cast<std::size_t>(k)] = t;
    }
    film.frame.reserve(time.size());
    for (const double t : time)
        film.frame.push_back(number.at(t));
    return film;
}

/// Rows by frame, in a frame by id, else as in the file.
Index row_order(const Film& film, const std::vector<std::int64_t>& id, std::vector<std::size_t>& start) {
    start.assign(film.time.size() + 1, 0);
    for (const std::uint32_t f : film.frame)
        ++start[f + 1];
    std::partial_sum(start.begin(), start.end(), start.begin());
    Index order(film.frame.size());
    std::vector<std::size_t> next(start.begin(), start.end() - 1);
    for (std::size_t i = 0; i < order.size(); ++i)
        order[next[film.frame[i]]++] = static_cast<std::uint32_t>(i);
    const auto by_id = [&](std::uint32_t i) { return id[i]; };
    for (std::size_t f = 0; f + 1 < start.size(); ++f) {
        const auto rows = std::span(order).subspan(start[f], start[f + 1] - start[f]);
        if (!std::ranges::is_sorted(rows, {}, by_id))
            std::ranges::stable_sort(rows, {}, by_id);
    }
    return order;
}

/// Where a number of the file was seen last, and which bead or rod that was.
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
        rows_.frame = {};
        rows_.time = {};
        std::vector<std::size_t> start;
        const Index order = row_order(film, rows_.id, start);
        film.frame = {};
        out_.time = std::move(film.time);
        take_all(order, start);
        settle_rods(out_, spacing_, scale_.thin_end_ahead);
        return std::move(out_);
    }

private:
    void scale_places() {
        out_.counts.rows = rows_.size();
        out_.bead_radius = scale_.bead_radius;
        for (std::size_t i = 0; i < rows_.size(); ++i) {
            rows_.x[i] *= scale_.pixel;
            rows_.y[i] *= scale_.pixel;
        }
        if (scale_.box) {
            out_.box = *scale_.box;
            return;
        }
        const Window window = scale_.window ? *scale_.window : hull();
        low_ = window.low();
        out_.window = window.moved(-low_.x, -low_.y);
        // The farthest corner as it comes out of the same subtraction as places do.
        const Corner high = window.high();
        out_.box = {high.x - low_.x, high.y - low_.y};
        hull_ = !scale_.window;
    }

    Window hull() const {
        try {
            return Window::hull(rows_.x, rows_.y);
        } catch (const InputError& error) {
            refuse_film(file_, error.what());
        }
    }

    /// In the layout's box; false: outside of the window.
    bool put_in(double& x, double& y) const {
        if (scale_.box) {
            x = into_box(x, out_.box.x);
            y = into_box(y, out_.box.y);
            return true;
        }
        x -= low_.x;
        y -= low_.y;
        const bool inside = hull_ || out_.window->inside_by(x, y) >= 0.0;
        x = std::clamp(x, 0.0, out_.box.x); // rounding, of a circle
        y = std::clamp(y, 0.0, out_.box.y);
        return inside;
    }

    void take_all(const Index& order, const std::vector<std::size_t>& start) {
        const double area = out_.window ? out_.window->area() : out_.box.area();
        const double each = area * static_cast<double>(out_.frames()) / static_cast<double>(rows_.size());
        spacing_ = std::sqrt(2.0 / std::sqrt(3.0) * each);
        out_.x.reserve(order.size());
        out_.y.reserve(order.size());
        out_.bead.reserve(order.size());
        for (std::size_t f = 0; f < out_.frames(); ++f) {
            out_.start.push_back(out_.x.size());
            out_.counts.empty_frames += start[f] == start[f + 1];
            take_frame(f, std::span(order).subspan(start[f], start[f + 1] - start[f]));
        }
        out_.start.push_back(out_.x.size());
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
        if (!std::ranges::is_sorted(frame_beads_, {}, &Seen::bead))
            std::ranges::stable_sort(frame_beads_, {}, &Seen::bead);
        for (const Seen& seen : frame_beads_) {
            out_.bead.push_back(seen.bead);
            out_.x.push_back(seen.x);
            out_.y.push_back(seen.y);
        }
    }

    bool is_rod(std::uint32_t row) const { return !rows_.is_rod.empty() && rows_.is_rod[row] != 0; }

    void take_row(std::size_t frame, std::uint32_t row) {
        double x = rows_.x[row], y = rows_.y[row];
        if (!put_in(x, y)) {
            ++out_.counts.outside;
            return;
        }
        const bool rod = is_rod(row);
        if (rows_.id[row] == no_track) {
            ++out_.counts.untracked;
            if (!rod)
                frame_beads_.push_back({untracked, x, y});
            return;
        }
        Trail& trail = (rod ? rod_trails_ : trails_)[rows_.id[row]];
        follow(trail, rows_.id[row], frame, x, y, rod);
        if (!rod)
            frame_beads_.push_back({trail.particle, x, y});
        else
            add_rod(trail, frame, row, x, y);
    }

    /// The particle goes on, or another begins under its number.
    void follow(Trail& trail, std::int64_t number, std::size_t frame, double x, double y, bool rod) {
        const bool known = trail.particle != untracked && trail.rod == rod;
        bool restarts = !known;
        if (known) {
            const double dx = x - trail.x, dy = y - trail.y,
                         away = scale_.box ? nearest_distance(dx, dy, out_.box) : std::hypot(dx, dy);
            // rods are few, and go on while they are not seen
            const double most = rod                       ? 3.0 * static_cast<double>(frame - trail.frame)
                                : frame > trail.frame + 1 ? 1.0
                                                          : 3.0;
            restarts = away > most * spacing_;
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

    void add_rod(const Trail& trail, std::size_t frame, std::uint32_t row, double x, double y) {
        RodTrack& rod = out_.rods[trail.particle];
        rod.frame.push_back(frame);
        rod.x.push_back(x);
        rod.y.push_back(y);
        rod.heading.push_back(rows_.heading.empty() ? std::nan("") : rows_.heading[row] * scale_.angle);
    }

    struct Seen {
        std::uint32_t bead;
        double x, y;
    };

    TrackRows rows_;
    const TrackScale& scale_;
    const std::string& file_;
    Tracks out_;
    Corner low_;
    bool hull_ = false;
    double spacing_ = 0.0;
    std::unordered_map<std::int64_t, Trail> trails_, rod_trails_; ///< a bead and a rod may have one number
    std::vector<Seen> frame_beads_;
};

} // namespace

double Tracks::mean_length() const {
    const std::size_t tracked = x.size() - static_cast<std::size_t>(std::ranges::count(bead, untracked));
    return beads > 0 ? static_cast<double>(tracked + counts.missing) / static_cast<double>(beads) : 0.0;
}

double Tracks::lost_share() const {
    const double seen = mean_length() * static_cast<double>(beads);
    return seen > 0.0 ? static_cast<double>(counts.missing) / seen : 0.0;
}

Tracks ordered_tracks(TrackRows rows, const TrackScale& scale, const std::string& file) {
    return Ordering(std::move(rows), scale, file).tracks();
}

Layout layout_of(const Tracks& tracks) {
    Layout layout{tracks.box, tracks.bead_radius, 0.0,
                  static_cast<std::size_t>(std::max(1.0, std::round(tracks.beads_per_frame()))),
                  tracks.rods.size()};
    layout.window = tracks.window;
    layout.velocities = false;
    for (const RodTrack& rod : tracks.rods) // where there is none yet, along x
        layout.headings.push_back(first_heading(rod).value_or(0.0));
    const bool all = tracks.beads > 0 && tracks.x.size() == tracks.frames() * tracks.beads &&
                     std::ranges::count(tracks.bead, untracked) == 0;
    layout.all_beads = all ? 0 : std::max<std::size_t>(tracks.beads, 1);
    return layout;
}

void for_each_frame(const Tracks& tracks, std::size_t stride,
                    const std::function<bool(const Frame&, double)>& use) {
    const Layout layout = layout_of(tracks);
    Unwrapping unwrap_x(tracks.beads), unwrap_y(tracks.beads);
    RodPlayer rods(tracks);
    Frame frame;
    for (std::size_t f = 0; f < tracks.frames(); ++f) {
        const auto from = static_cast<std::ptrdiff_t>(tracks.start[f]),
                   to = static_cast<std::ptrdiff_t>(tracks.start[f + 1]);
        frame.time = tracks.time[f];
        frame.x.assign(tracks.x.begin() + from, tracks.x.begin() + to);
        frame.y.assign(tracks.y.begin() + from, tracks.y.begin() + to);
        frame.unwrapped_x = frame.x;
        frame.unwrapped_y = frame.y;
        frame.bead.assign(tracks.bead.begin() + from, tracks.bead.begin() + to);
        for (std::size_t i = 0; !tracks.window && i < frame.x.size(); ++i)
            if (const std::uint32_t bead = frame.bead[i]; bead != untracked) {
                frame.unwrapped_x[i] = unwrap_x(bead, frame.x[i], tracks.box.x);
                frame.unwrapped_y[i] = unwrap_y(bead, frame.y[i], tracks.box.y);
            }
        if (layout.all_beads == 0)
            frame.bead.clear();
        rods.play(f, frame.rods);
        if (f % stride == 0 && !use(frame, static_cast<double>(f + 1) / static_cast<double>(tracks.frames())))
            return;
    }
}

} // namespace rodwake::measure
