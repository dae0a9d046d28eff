#include "rodwake/measure/camera.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/core/rng.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

namespace rodwake::measure {

namespace {

constexpr double strongest_distortion = 0.1; // r (1 - 0.1 r^2/d^2) grows up to 1.8 d, where it is 1.2 d

void require(bool holds, const char* what, double value, const char* range) {
    if (!holds)
        throw InputError(fmt::format("camera: {} = {:g}: must be {}", what, value, range));
}

bool is_round(const Layout& layout) { return layout.window && layout.window->corners.empty(); }

/// The largest view whose corners lie inside the bed.
double widest_view(const Camera& camera, const Layout& layout) {
    const PeriodicBox& box = layout.box;
    const double c = std::abs(std::cos(camera.turned)), s = std::abs(std::sin(camera.turned)),
                 stretch = 1.0 - std::min(camera.distortion, 0.0) * 1.5; // what a barrel draws in
    if (is_round(layout))
        return 2.0 * layout.window->radius / std::hypot(box.x, box.y) / stretch;
    const Corner low = layout.window ? layout.window->low() : Corner{},
                 high = layout.window ? layout.window->high() : Corner{box.x, box.y};
    return std::min((high.x - low.x) / (c * box.x + s * box.y), (high.y - low.y) / (s * box.x + c * box.y)) /
           stretch;
}

/// A pincushion would draw parts of a dish out of the picture.
bool sees_all(const Camera& camera, const Layout& layout) {
    return camera.sees_the_box() || (is_round(layout) && camera.view == 1.0 && camera.distortion <= 0.0);
}

void validate(const Camera& camera, const Layout& layout) {
    require(camera.pixel > 0.0 && camera.pixel < layout.box.shorter(), "pixel", camera.pixel,
            "above 0 and below the side of the box, m");
    require(camera.every >= 1, "every", static_cast<double>(camera.every), "1 or more");
    require(camera.exposure >= 1 && camera.exposure <= camera.every, "exposure",
            static_cast<double>(camera.exposure), "from 1 to the frames between pictures");
    require(camera.view > 0.0 && camera.view <= 1.0, "view", camera.view, "above 0 and at most 1");
    require(std::isfinite(camera.turned), "turned", camera.turned, "finite");
    require(std::abs(camera.distortion) <= strongest_distortion, "distortion", camera.distortion,
            "from -0.1 to 0.1");
    require(camera.lost >= 0.0 && camera.lost < 1.0, "lost", camera.lost, "0 or more and below 1");
    require(camera.noise >= 0.0 && camera.noise < layout.box.shorter(), "noise", camera.noise,
            "0 or more and below the side of the box, m");
    const double widest = widest_view(camera, layout);
    if (!sees_all(camera, layout) && camera.view > widest)
        throw InputError(
            fmt::format("camera: view = {:g}: so turned and distorted the picture reaches beyond the {}; "
                        "take {:.3g} or less{}",
                        camera.view, layout.window ? "bed" : "box", widest,
                        is_round(layout) ? ", or all of the dish: view = 1 and distortion 0 or less" : ""));
}

/// In [0, side).
double into_box(double x, double side) {
    const double inside = x - side * std::floor(x / side);
    return inside < side ? inside : 0.0;
}

double normal(RandomStream& random) {
    const double length = std::sqrt(-2.0 * std::log(random.uniform()));
    return length * std::cos(2.0 * M_PI * random.uniform());
}

} // namespace

PeriodicBox picture_of(const Camera& camera, const Layout& layout) {
    return {camera.view * layout.box.x, camera.view * layout.box.y};
}

std::optional<Window> seen_by(const Camera& camera, const Layout& layout) {
    const PeriodicBox picture = picture_of(camera, layout);
    if (!sees_all(camera, layout))
        return Window::rectangle(0.0, 0.0, picture.x, picture.y);
    std::optional<Window> seen = layout.window;
    if (is_round(layout)) {
        const double part = 2.0 * seen->radius / std::hypot(picture.x, picture.y);
        seen->radius *= 1.0 + camera.distortion * part * part;
    }
    return seen;
}

Film::Film(const Camera& camera, const Layout& layout)
    : camera_(camera), layout_(layout), picture_(picture_of(camera, layout)), x_(layout.beads + layout.rods),
      y_(x_.size()), seen_(x_.size()) {
    validate(camera, layout);
}

bool Film::expose(const Frame& frame) {
    const std::size_t in_turn = taken_++ % camera_.every;
    if (in_turn >= camera_.exposure)
        return false;
    add_places(frame);
    if (in_turn + 1 < camera_.exposure)
        return false;
    develop(frame);
    return true;
}

void Film::add_places(const Frame& frame) {
    for (std::size_t i = 0; i < layout_.beads; ++i) {
        x_[i] += frame.unwrapped_x[i];
        y_[i] += frame.unwrapped_y[i];
    }
    for (std::size_t i = 0; i < layout_.rods; ++i) {
        x_[layout_.beads + i] += frame.rods[i].x;
        y_[layout_.beads + i] += frame.rods[i].y;
    }
}

void Film::develop(const Frame& frame) {
    ++pictures_;
    spots_.clear();
    const double frames = static_cast<double>(camera_.exposure);
    for (std::size_t i = 0; i < x_.size(); ++i) {
        const bool is_bead = i < layout_.beads;
        if (is_bead && camera_.exposure == 1) // the bits of the bed
            find(i, frame.x[i], frame.y[i], std::numeric_limits<double>::quiet_NaN());
        else
            find(i, into_box(x_[i] / frames, layout_.box.x), into_box(y_[i] / frames, layout_.box.y),
                 is_bead ? std::numeric_limits<double>::quiet_NaN() : frame.rods[i - layout_.beads].heading);
        x_[i] = y_[i] = 0.0;
    }
}

void Film::find(std::size_t body, double x, double y, double heading) {
    if (!camera_.sees_the_box()) {
        const double rx = x - 0.5 * layout_.box.x, ry = y - 0.5 * layout_.box.y, c = std::cos(camera_.turned),
                     s = std::sin(camera_.turned),
                     far2 =
                         (rx * rx + ry * ry) / (0.25 * (picture_.x * picture_.x + picture_.y * picture_.y)),
                     stretch = 1.0 + camera_.distortion * far2;
        if (far2 > 3.0) // a barrel would fold it back
            return;
        x = stretch * (c * rx + s * ry) + 0.5 * picture_.x;
        y = stretch * (c * ry - s * rx) + 0.5 * picture_.y;
        heading -= camera_.turned;
        if (!(x >= 0.0 && x < picture_.x && y >= 0.0 && y < picture_.y))
            return;
    }
    RandomStream random(camera_.seed, static_cast<std::uint32_t>(pictures_),
                        static_cast<std::uint32_t>(body));
    if (camera_.lost > 0.0 && random.uniform() < camera_.lost)
        return;
    if (camera_.noise > 0.0) {
        x += camera_.noise * normal(random);
        y += camera_.noise * normal(random);
        if (!layout_.window && camera_.sees_the_box()) {
            x = into_box(x, layout_.box.x);
            y = into_box(y, layout_.box.y);
        }
    }
    Seen& seen = seen_[body];
    if (seen.picture == 0 || pictures_ - seen.picture > camera_.memory + 1)
        seen.number = numbers_++;
    seen.picture = pictures_;
    spots_.push_back({seen.number, x / camera_.pixel, y / camera_.pixel, heading});
}

} // namespace rodwake::measure
