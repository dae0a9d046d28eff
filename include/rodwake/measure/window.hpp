#pragma once
// The part of the plane in which a camera sees particles: a convex polygon or a circle. Beyond it nothing is
// known, so what counts neighbours or pairs must know how much of a neighbourhood lies inside.

#include <cstddef>
#include <span>
#include <vector>

namespace rodwake::measure {

struct Corner {
    double x = 0.0, y = 0.0;
    bool operator==(const Corner&) const = default;
};

struct Window {
    std::vector<Corner> corners; ///< of a convex polygon, counter-clockwise, m; empty: a circle
    Corner centre;               ///< of the circle, m
    double radius = 0.0;

    static Window rectangle(double x0, double y0, double x1, double y1);
    static Window circle(double x, double y, double radius) { return {{}, {x, y}, radius}; }
    /// The convex hull of points; none of them is outside. Throws InputError if it has no area.
    static Window hull(std::span<const double> x, std::span<const double> y);

    double area() const;
    /// The smallest rectangle along the axes that holds it: its lower left and upper right corners.
    Corner low() const;
    Corner high() const;
    Window moved(double dx, double dy) const;
    /// From a point to the border; negative outside.
    double inside_by(double x, double y) const;

    bool operator==(const Window&) const = default;
};

/// Of circles about points of a window, the share that lies inside.
class CircleShares {
public:
    explicit CircleShares(const Window& window);

    /// Of the circle of radius (k + 1/2) bin about an inner point, for each k: exact. Of a polygon the circle
    /// lies inside where the border, seen from the point, is farther than the radius: edge by edge, in
    /// angles.
    void about(double x, double y, double bin, std::span<double> share);

private:
    /// Where it begins, and its directions along and outwards.
    struct Edge {
        Corner from;
        double length, tx, ty, normal;
    };
    /// A corner, from the point.
    struct RelativeCorner {
        double x, y, distance, angle;
    };
    void take(const Edge& edge, const RelativeCorner& from, const RelativeCorner& to, double bin,
              std::span<double> share);

    Window window_;
    std::vector<Edge> edges_;
    std::vector<RelativeCorner> seen_; ///< scratch
    std::vector<double> rest_;         ///< scratch
};

} // namespace rodwake::measure
