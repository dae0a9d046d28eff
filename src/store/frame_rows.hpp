#pragma once
// Rows of formats that come frame by frame, with a box and a step or a time of each: what they have in
// common.

#include "track_formats.hpp"

#include "rodwake/core/error.hpp"

#include <fmt/format.h>

#include <cmath>
#include <functional>

namespace rodwake::store {

/// Of a file, in a frame.
struct FileBox {
    double x = 0.0, y = 0.0; ///< sides
    bool periodic = false;   ///< in x and y
    bool tilted = false;     ///< in the plane
    bool operator==(const FileBox&) const = default;
};

class FrameRows {
public:
    /// `where` names the place in the file that was read last.
    FrameRows(const TrackColumns& given, std::function<std::string()> where)
        : given_(given), timed_(given.own_times || !given.time.empty()), where_(std::move(where)) {}

    [[noreturn]] void fail(const std::string& what) const {
        throw InputError(fmt::format("{}: {}", where_(), what));
    }

    void begin(std::int64_t step, std::optional<double> time) {
        if (timed_ && !time)
            fail("the frame has no time: set tracks.frames_per_second, how many frames (of files with time "
                 "steps: steps) a second has");
        if (time && !std::isfinite(*time))
            fail(fmt::format("the time {} is no time", *time));
        constexpr std::int64_t most = std::int64_t{1} << 53;
        if (step <= -most || step >= most)
            fail(fmt::format("the step {} is no step", step));
        end_frame();
        step_ = step;
        time_ = time;
        ++frames_;
    }

    /// Of the frame that has begun.
    void box(const FileBox& box) {
        if (box.periodic && !(box.x > 0.0 && box.y > 0.0 && std::isfinite(box.x) && std::isfinite(box.y)))
            fail(fmt::format("the sides of the box, {} and {}, are not positive and finite", box.x, box.y));
        if (frames_ == 1)
            box_ = box;
        if (rows_.no_box.empty() && box.periodic && box.tilted)
            rows_.no_box = fmt::format("its box is not upright ({})", where_());
        if (rows_.no_box.empty() && !(box == box_) && (box.periodic || box_.periodic))
            rows_.no_box = fmt::format("its box changes ({})", where_());
    }

    /// Without an id, the place in the frame tells who it is.
    void add(std::optional<std::int64_t> id, double x, double y, std::optional<double> heading = {},
             std::optional<bool> is_rod = {}) {
        const std::int64_t place = in_frame_++;
        if (!std::isfinite(x) || !std::isfinite(y)) {
            if (rows_.without_place++ == 0)
                rows_.first_without_place = where_();
            return;
        }
        by_place_ |= !id;
        if (timed_)
            rows_.time.push_back(*time_);
        else
            rows_.frame.push_back(step_);
        rows_.id.push_back(id.value_or(place));
        rows_.x.push_back(x);
        rows_.y.push_back(y);
        if (heading) {
            rows_.heading.resize(rows_.size() - 1, std::nan("")); // frames may differ in their columns
            rows_.heading.push_back(*heading);
        }
        if (is_rod) {
            rows_.is_rod.resize(rows_.size() - 1, 0);
            rows_.is_rod.push_back(*is_rod);
        }
    }

    /// Of the frame that has begun.
    std::int64_t particles() const { return in_frame_; }

    TrackRows take(const std::string& file) {
        end_frame();
        if (rows_.size() == 0)
            throw InputError(fmt::format("{}: has no particle with a place in its {} frames", file, frames_));
        if (!rows_.heading.empty())
            rows_.heading.resize(rows_.size(), std::nan(""));
        if (!rows_.is_rod.empty())
            rows_.is_rod.resize(rows_.size(), 0);
        if (by_place_ && changing_)
            std::ranges::fill(rows_.id, no_track); // who is who is not known
        if (box_.periodic && rows_.no_box.empty())
            rows_.box = PeriodicBox(box_.x, box_.y);
        return std::move(rows_);
    }

    TrackRows& rows() { return rows_; }

private:
    void end_frame() {
        if (frames_ > 0) {
            changing_ |= before_ >= 0 && before_ != in_frame_;
            before_ = in_frame_;
        }
        in_frame_ = 0;
    }

    const TrackColumns& given_;
    bool timed_;
    std::function<std::string()> where_;
    TrackRows rows_;
    FileBox box_;
    std::int64_t step_ = 0, in_frame_ = 0, before_ = -1;
    std::optional<double> time_;
    std::size_t frames_ = 0;
    bool by_place_ = false, changing_ = false;
};

} // namespace rodwake::store
