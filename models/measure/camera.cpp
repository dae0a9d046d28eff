#include "rodwake/measure/camera.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/core/rng.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

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
    require(camera.blur >= 0.1 && camera.blur <= 20.0, "blur", camera.blur, "from 0.1 to 20 pixels");
    require(camera.photons >= 1.0 && camera.photons <= 1e9, "photons", camera.photons, "from 1 to 1e9");
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

std::optional<Corner> in_picture(const Camera& camera, const PeriodicBox& box, double x, double y) {
    const double rx = x - 0.5 * box.x, ry = y - 0.5 * box.y, c = std::cos(camera.turned),
                 s = std::sin(camera.turned), width = camera.view * box.x, height = camera.view * box.y,
                 far2 = (rx * rx + ry * ry) / (0.25 * (width * width + height * height)),
                 stretch = 1.0 + camera.distortion * far2;
    if (far2 > 3.0)
        return std::nullopt;
    return Corner{stretch * (c * rx + s * ry) + 0.5 * width, stretch * (c * ry - s * rx) + 0.5 * height};
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
        const std::optional<Corner> at = in_picture(camera_, layout_.box, x, y);
        if (!at || !(at->x >= 0.0 && at->x < picture_.x && at->y >= 0.0 && at->y < picture_.y))
            return;
        x = at->x;
        y = at->y;
        heading -= camera_.turned;
    }
    RandomStream random(camera_.seed, static_cast<std::uint32_t>(pictures_),
                        static_cast<std::uint32_t>(body));
    if (camera_.lost > 0.0 && random.uniform() < camera_.lost)
        return;
    if (camera_.noise > 0.0) {
        x += camera_.noise * random.normal();
        y += camera_.noise * random.normal();
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

namespace {

constexpr double most_pixels = 1e8;
constexpr double background = 0.1, white = 220.0; // a photon's noise has room above

std::size_t pixels_of(double side, double pixel) {
    return static_cast<std::size_t>(std::ceil(side / pixel * (1.0 - 1e-12)));
}

} // namespace

Sensor::Sensor(const Camera& camera, const Layout& layout)
    : camera_(camera), box_(layout.box), width_(pixels_of(camera.view * box_.x, camera.pixel)),
      height_(pixels_of(camera.view * box_.y, camera.pixel)) {
    validate(camera, layout);
    if (static_cast<double>(width_) * static_cast<double>(height_) > most_pixels)
        throw InputError(fmt::format("camera: pictures of {} x {} pixels: at most 1e8; take a larger pixel, "
                                     "or a smaller view",
                                     width_, height_));
    sum_.assign(width_ * height_, 0.0F);
    frame_ = sum_;
}

void Sensor::expose(std::span<const Disc> discs) {
    std::ranges::fill(frame_, static_cast<float>(background));
    for (const Disc& disc : discs)
        if (const auto at = in_picture(camera_, box_, into_box(disc.x, box_.x), into_box(disc.y, box_.y)))
            draw(disc, *at);
    for (std::size_t k = 0; k < sum_.size(); ++k)
        sum_[k] += frame_[k];
    ++frames_;
}

/// Pixel k reaches from k to k + 1.
void Sensor::draw(const Disc& disc, const Corner& at) {
    const double x = at.x / camera_.pixel, y = at.y / camera_.pixel, radius = disc.radius / camera_.pixel,
                 reach = radius + 4.0 * camera_.blur;
    const auto pixel = [](double place, std::size_t count) {
        return static_cast<std::size_t>(std::clamp(place, 0.0, static_cast<double>(count)));
    };
    for (std::size_t j = pixel(y - reach, height_); j < pixel(y + reach + 1.0, height_); ++j)
        for (std::size_t i = pixel(x - reach, width_); i < pixel(x + reach + 1.0, width_); ++i) {
            const double off = std::hypot(static_cast<double>(i) + 0.5 - x, static_cast<double>(j) + 0.5 - y),
                         inside = 0.5 * std::erfc((off - radius) / (std::numbers::sqrt2 * camera_.blur));
            float& value = frame_[j * width_ + i];
            value = std::max(value, static_cast<float>(background + (disc.value - background) * inside));
        }
}

std::vector<std::uint8_t> Sensor::develop() {
    RandomStream random(camera_.seed, ++pictures_, 0xffffffffU); // Film's bodies are below
    std::vector<std::uint8_t> grey;
    grey.reserve(sum_.size());
    for (std::size_t row = height_; row-- > 0;)
        for (std::size_t i = 0; i < width_; ++i) {
            const double mean = static_cast<double>(sum_[row * width_ + i]) / static_cast<double>(frames_);
            const double seen = mean + std::sqrt(mean / camera_.photons) * random.normal();
            grey.push_back(static_cast<std::uint8_t>(std::clamp(std::round(white * seen), 0.0, 255.0)));
        }
    std::ranges::fill(sum_, 0.0F);
    frames_ = 0;
    return grey;
}

} // namespace rodwake::measure
