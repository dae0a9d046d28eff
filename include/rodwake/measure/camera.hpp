#pragma once
// A camera over a bed whose truth is known: what its tracks would be, in pixels, with the faults that real
// ones have. Measured again, they show what a measure makes of such faults.
//
// A place r of the bed, relative to the middle of its box, appears at R(-turned) r (1 + distortion r^2/d^2)
// from the middle of the picture, d half of the picture's diagonal; x to the right, y upwards, the corner (0,
// 0) below on the left. Faults come in this order: the exposure's mean of the place, the picture's edge,
// spots that are not found, the localisation's normal error.
//
// What a picture itself shows has none of the latter two: they are made by who finds spots in it. A sphere is
// a disc of its radius (the camera's distortion moves it and does not stretch it), its edge smoothed by the
// lens; a pixel of mean value v has counted k photons, k normal of mean and variance photons v.

#include "rodwake/measure/frame.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace rodwake::measure {

struct Camera {
    double pixel = 0.0;       ///< m
    std::size_t every = 1;    ///< frames from one picture to the next
    std::size_t exposure = 1; ///< frames whose mean place a spot has, at most `every`
    double view = 1.0;        ///< sides of the picture over those of the box, in (0, 1]
    double turned = 0.0;      ///< of the camera, anticlockwise, rad
    double distortion = 0.0;  ///< at the corners; negative: barrel; from -0.1 to 0.1
    double lost = 0.0;        ///< share of the spots that are not found, in [0, 1)
    std::size_t memory = 3;   ///< pictures without a particle after which it gets another number
    double noise = 0.0;       ///< standard deviation of a coordinate, m
    std::uint64_t seed = 1;
    std::size_t images = 0;  ///< pictures that are drawn, from the first on
    double blur = 1.0;       ///< standard deviation of the lens, pixels, from 0.1 to 20
    double photons = 1000.0; ///< that a white pixel counts, from 1 to 1e9

    bool sees_the_box() const { return view == 1.0 && turned == 0.0 && distortion == 0.0; }
    bool operator==(const Camera&) const = default;
};

struct Spot {
    std::uint32_t particle = 0; ///< from 0, in the order of first sight
    double x = 0.0, y = 0.0;    ///< pixels
    double heading = 0.0;       ///< of a rod, rad in the picture; NaN: a bead
};

/// Sides of the picture, m.
PeriodicBox picture_of(const Camera& camera, const Layout& layout);

/// What of the bed is seen, m in the picture; nothing: all of a periodic box. Of a bed with a wall that is
/// all of it (view = 1; a dish may be turned and distorted), or a picture within.
std::optional<Window> seen_by(const Camera& camera, const Layout& layout);

/// Where a place of the bed appears, m in the picture; nothing: far outside, where a barrel folds back.
std::optional<Corner> in_picture(const Camera& camera, const PeriodicBox& box, double x, double y);

class Film {
public:
    /// Throws InputError for values out of range and a picture that reaches beyond the bed, unless all of it
    /// is seen.
    Film(const Camera& camera, const Layout& layout);

    /// Takes the frames in order; true when a picture is complete, its spots are in spots(), beads first.
    bool expose(const Frame& frame);
    const std::vector<Spot>& spots() const { return spots_; }
    std::size_t pictures() const { return pictures_; }
    /// Whether the next frame is one of a picture's exposure.
    bool is_open() const { return taken_ % camera_.every < camera_.exposure; }

private:
    struct Seen {
        std::uint32_t number = 0;
        std::size_t picture = 0; ///< the last one that had it, from 1; 0: none
    };
    void add_places(const Frame& frame);
    void develop(const Frame& frame);
    void find(std::size_t body, double x, double y, double heading);

    Camera camera_;
    Layout layout_;
    PeriodicBox picture_;
    std::size_t taken_ = 0, pictures_ = 0; ///< frames, complete pictures
    std::uint32_t numbers_ = 0;
    std::vector<double> x_, y_; ///< [bodies], sums over the exposure, unwrapped, m
    std::vector<Seen> seen_;    ///< [bodies]
    std::vector<Spot> spots_;
};

/// A sphere seen from above.
struct Disc {
    double x = 0.0, y = 0.0; ///< in the bed, m
    double radius = 0.0;     ///< m
    double value = 1.0;      ///< 0 black, 1 white
};

/// The camera's pixels, while a picture is exposed.
class Sensor {
public:
    /// Throws InputError for values out of range and a picture of more than 10^8 pixels.
    Sensor(const Camera& camera, const Layout& layout);

    std::size_t width() const { return width_; }
    std::size_t height() const { return height_; }
    /// One frame of an exposure. Where discs lie above each other the brightest is seen.
    void expose(std::span<const Disc> discs);
    /// Grey values of the mean over the frames, row by row from the top; the next picture begins.
    std::vector<std::uint8_t> develop();

private:
    void draw(const Disc& disc, const Corner& at);

    Camera camera_;
    PeriodicBox box_;
    std::size_t width_, height_, frames_ = 0;
    std::uint32_t pictures_ = 0;
    std::vector<float> sum_, frame_; ///< [height][width], from the bottom
};

} // namespace rodwake::measure
