#include "rodwake/measure/window.hpp"

#include "edge_shares.hpp"
#include "rodwake/core/error.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace rodwake::measure {

namespace {

constexpr double pi = std::numbers::pi;

double cross(const Corner& a, const Corner& b, const Corner& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// The end of the edge that begins at corner k.
const Corner& end_of_edge(const std::vector<Corner>& corners, std::size_t k) {
    return corners[k + 1 == corners.size() ? 0 : k + 1];
}

/// One half of the hull of sorted points, left to right or back.
void append_chain(const std::vector<Corner>& points, std::vector<Corner>& hull) {
    const std::size_t first = hull.size();
    for (const Corner& p : points) {
        while (hull.size() >= first + 2 && cross(hull[hull.size() - 2], hull.back(), p) <= 0.0)
            hull.pop_back();
        hull.push_back(p);
    }
    hull.pop_back(); // begins the other half
}

std::vector<Corner> convex_hull(std::vector<Corner> points) {
    const auto before = [](const Corner& a, const Corner& b) { return a.x != b.x ? a.x < b.x : a.y < b.y; };
    std::ranges::sort(points, before);
    points.erase(std::unique(points.begin(), points.end()), points.end());
    std::vector<Corner> hull;
    if (points.size() < 3)
        return hull;
    append_chain(points, hull);
    std::ranges::reverse(points);
    append_chain(points, hull);
    return hull;
}

} // namespace

Window Window::rectangle(double x0, double y0, double x1, double y1) {
    return {{{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}, {}, 0.0};
}

Window Window::hull(std::span<const double> x, std::span<const double> y) {
    // The extreme points of sixteen directions first: most others lie inside their polygon and need not be
    // sorted.
    constexpr std::size_t directions = 16;
    std::vector<Corner> far(directions);
    for (std::size_t d = 0; d < directions; ++d) {
        const double c = std::cos(2.0 * pi * static_cast<double>(d) / directions),
                     s = std::sin(2.0 * pi * static_cast<double>(d) / directions);
        double most = -HUGE_VAL;
        for (std::size_t i = 0; i < x.size(); ++i)
            if (const double along = c * x[i] + s * y[i]; along > most) {
                most = along;
                far[d] = {x[i], y[i]};
            }
    }
    const std::vector<Corner> inner = convex_hull(far);
    std::vector<Corner> points = far;
    for (std::size_t i = 0; i < x.size(); ++i) {
        bool inside = !inner.empty(); // by more than rounding
        for (std::size_t k = 0; k < inner.size() && inside; ++k)
            inside = cross(inner[k], end_of_edge(inner, k), {x[i], y[i]}) > 0.0;
        if (!inside)
            points.push_back({x[i], y[i]});
    }
    Window window{convex_hull(std::move(points)), {}, 0.0};
    if (window.corners.size() < 3 || !(window.area() > 0.0))
        throw InputError("measure: all particles lie on one line: a hull around them has no area; give "
                         "tracks.window as a rectangle or a circle");
    return window;
}

double Window::area() const {
    if (corners.empty())
        return pi * radius * radius;
    double twice = 0.0;
    for (std::size_t k = 0; k < corners.size(); ++k) {
        const Corner &a = corners[k], &b = end_of_edge(corners, k);
        twice += (a.x - corners[0].x) * (b.y - corners[0].y) - (a.y - corners[0].y) * (b.x - corners[0].x);
    }
    return 0.5 * twice;
}

Corner Window::low() const {
    if (corners.empty())
        return {centre.x - radius, centre.y - radius};
    return {std::ranges::min(corners, {}, &Corner::x).x, std::ranges::min(corners, {}, &Corner::y).y};
}

Corner Window::high() const {
    if (corners.empty())
        return {centre.x + radius, centre.y + radius};
    return {std::ranges::max(corners, {}, &Corner::x).x, std::ranges::max(corners, {}, &Corner::y).y};
}

Window Window::moved(double dx, double dy) const {
    Window other = *this;
    for (Corner& c : other.corners)
        c = {c.x + dx, c.y + dy};
    other.centre = {centre.x + dx, centre.y + dy};
    return other;
}

double Window::inside_by(double x, double y) const {
    if (corners.empty())
        return radius - std::hypot(x - centre.x, y - centre.y);
    double least = HUGE_VAL;
    for (std::size_t k = 0; k < corners.size(); ++k) {
        const Corner &a = corners[k], &b = end_of_edge(corners, k);
        least = std::min(least, cross(a, b, {x, y}) / std::hypot(b.x - a.x, b.y - a.y));
    }
    return least;
}

namespace {

double within_half_turn(double angle) {
    return angle > pi ? angle - 2.0 * pi : angle < -pi ? angle + 2.0 * pi : angle;
}

} // namespace

CircleShares::CircleShares(const Window& window) : window_(window), seen_(window.corners.size()) {
    for (std::size_t k = 0; k < window.corners.size(); ++k) {
        const Corner &a = window.corners[k], &b = end_of_edge(window.corners, k);
        const double length = std::hypot(b.x - a.x, b.y - a.y);
        edges_.push_back(
            {a, length, (b.x - a.x) / length, (b.y - a.y) / length, std::atan2(a.x - b.x, b.y - a.y)});
    }
}

/// Takes off what lies beyond one edge: of the directions in which it is seen, those in which it is nearer
/// than the radius. All of it, from some bin on, is left to `rest`.
void CircleShares::take(const Edge& edge, const RelativeCorner& from, const RelativeCorner& to, double bin,
                        std::span<double> share) {
    const double distance = std::max(0.0, edge.ty * from.x - edge.tx * from.y);
    double low = within_half_turn(from.angle - edge.normal),
           high = low + within_half_turn(to.angle - from.angle);
    if (distance < 1e-9 * edge.length) { // an end may be the point itself, which has no direction
        const double along = edge.tx * from.x + edge.ty * from.y;
        low = std::atan2(along, distance);
        high = std::atan2(along + edge.length, distance);
    }
    const double nearest = low > 0.0 ? from.distance : high < 0.0 ? to.distance : distance;
    const auto bin_of = [&](double r) {
        return static_cast<std::size_t>(
            std::clamp(std::ceil(r / bin - 0.5), 0.0, static_cast<double>(share.size())));
    };
    const std::size_t first = bin_of(nearest),
                      last = std::max(first, bin_of(std::max(from.distance, to.distance)));
    take_edge_row(distance / bin, low, high, first, last, share.data());
    rest_[last] += (high - low) / (2.0 * pi);
}

void CircleShares::about(double x, double y, double bin, std::span<double> share) {
    if (edges_.empty()) {
        // The circle's centre is `off` from the point.
        const double radius = window_.radius, off = std::hypot(x - window_.centre.x, y - window_.centre.y);
        for (std::size_t k = 0; k < share.size(); ++k) {
            const double r = (static_cast<double>(k) + 0.5) * bin;
            const double cosine = std::clamp((radius * radius - off * off - r * r) / (2.0 * off * r), -1.0,
                                             1.0); // off = 0: +-1
            share[k] = 1.0 - std::acos(cosine) / pi;
        }
        return;
    }
    std::ranges::fill(share, 1.0);
    rest_.assign(share.size() + 1, 0.0);
    for (std::size_t k = 0; k < edges_.size(); ++k) {
        const double to_x = edges_[k].from.x - x, to_y = edges_[k].from.y - y;
        seen_[k] = {to_x, to_y, std::sqrt(to_x * to_x + to_y * to_y), std::atan2(to_y, to_x)};
    }
    for (std::size_t k = 0; k < edges_.size(); ++k)
        take(edges_[k], seen_[k], seen_[k + 1 == edges_.size() ? 0 : k + 1], bin, share);
    // In a corner the border is seen in fewer directions than there are: in the others all is outside.
    double taken = 1.0 - std::accumulate(rest_.begin(), rest_.end(), 0.0);
    taken = taken > 1e-9 ? taken : 0.0;
    for (std::size_t k = 0; k < share.size(); ++k) {
        taken += rest_[k];
        share[k] -= taken;
    }
}

} // namespace rodwake::measure
