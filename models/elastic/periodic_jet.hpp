#pragma once
// What is asked of a potential of the periodic box, in the box's own axes and with its shorter side as the
// unit of length.

#include "rodwake/core/periodic.hpp"

namespace rodwake::elastic {

/// A function of the plane with its derivatives up to the third.
struct Jet {
    double v = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;
    double xxx = 0.0, xxy = 0.0, xyy = 0.0, yyy = 0.0;
};

/// c (ux, uy), and the direction (wx, wy) of derivatives by it at a fixed place: (ux, uy) is d/dc, c (-uy,
/// ux) is by the heading.
struct WaveVector {
    double c, ux, uy, wx, wy;

    static WaveVector by_c(double c, double ux, double uy) { return {c, ux, uy, ux, uy}; }
    static WaveVector heading_derivative(double c, double ux, double uy) {
        return {c, ux, uy, -c * uy, c * ux};
    }

    double along() const { return ux * wx + uy * wy; } ///< of the direction: dc
    double across() const { return ux * wy - uy * wx; }
    WaveVector exchanged() const { return {c, uy, ux, wy, wx}; }
};

/// A potential and its derivative by its wave vector.
struct WaveVectorJets {
    Jet g, by_c;
};

struct Needed {
    bool second = false; ///< second derivatives by place
    bool third = false;  ///< third ones, with `second` alone
    bool by_c = false;
    bool without_log =
        false; ///< near the rod: less ln(c) exp(-c.r) I0(c r), which leaves a power series in c
};

inline Jet& operator+=(Jet& a, const Jet& b) {
    a.v += b.v;
    a.x += b.x;
    a.y += b.y;
    a.xx += b.xx;
    a.xy += b.xy;
    a.yy += b.yy;
    a.xxx += b.xxx;
    a.xxy += b.xxy;
    a.xyy += b.xyy;
    a.yyy += b.yyy;
    return a;
}

inline Jet operator+(Jet a, const Jet& b) { return a += b; }

inline Jet operator*(double s, const Jet& a) {
    return {s * a.v,  s * a.x,   s * a.y,   s * a.xx,  s * a.xy,
            s * a.yy, s * a.xxx, s * a.xxy, s * a.xyy, s * a.yyy};
}

/// Derivatives of a jet, up to the second.
inline Jet by_x(const Jet& f) { return {f.x, f.xx, f.xy, f.xxx, f.xxy, f.xyy}; }
inline Jet by_y(const Jet& f) { return {f.y, f.xy, f.yy, f.xxy, f.xyy, f.yyy}; }

/// (a + bx x + by y) f, where `line` is the linear function's value at the place.
inline Jet times_line(double line, double bx, double by, const Jet& f) {
    return {line * f.v,
            line * f.x + bx * f.v,
            line * f.y + by * f.v,
            line * f.xx + 2.0 * bx * f.x,
            line * f.xy + bx * f.y + by * f.x,
            line * f.yy + 2.0 * by * f.y,
            line * f.xxx + 3.0 * bx * f.xx,
            line * f.xxy + 2.0 * bx * f.xy + by * f.xx,
            line * f.xyy + bx * f.yy + 2.0 * by * f.xy,
            line * f.yyy + 3.0 * by * f.yy};
}

/// (x d_y - y d_x) f at the place (x, y), up to second derivatives: by the angle of the place.
inline Jet by_angle(double x, double y, const Jet& f) {
    return times_line(x, 1.0, 0.0, by_y(f)) + times_line(-y, 0.0, -1.0, by_x(f));
}

/// scale exp(-cx x - cy y) f, where `scale` is the exponential at the place; third derivatives if needed.
inline Jet times_decay(double scale, double cx, double cy, const Jet& f, bool third) {
    const double x = f.x - cx * f.v, y = f.y - cy * f.v; // one factor (d - c) after the other
    const double x_x = f.xx - cx * f.x, x_y = f.xy - cx * f.y, y_y = f.yy - cy * f.y;
    const double xx = x_x - cx * x, xy = x_y - cy * x, yy = y_y - cy * y;
    Jet g{scale * f.v, scale * x, scale * y, scale * xx, scale * xy, scale * yy};
    if (!third)
        return g;
    const double xx_x = f.xxx - cx * f.xx - cx * x_x, xx_y = f.xxy - cx * f.xy - cx * x_y,
                 yy_x = f.xyy - cy * f.xy - cy * (f.xy - cy * f.x), yy_y = f.yyy - cy * f.yy - cy * y_y;
    g.xxx = scale * (xx_x - cx * xx);
    g.xxy = scale * (xx_y - cy * xx);
    g.xyy = scale * (yy_x - cx * yy);
    g.yyy = scale * (yy_y - cy * yy);
    return g;
}

inline PeriodicBox exchanged(const PeriodicBox& box) { return {box.y, box.x}; }

/// The same function with the axes exchanged.
inline Jet exchanged(const Jet& f) { return {f.v, f.y, f.x, f.yy, f.xy, f.xx, f.yyy, f.xyy, f.xxy, f.xxx}; }

/// From axes in which x runs along (ux, uy) to those in which (ux, uy) is given; third derivatives if needed.
inline Jet from_axes(double ux, double uy, const Jet& f, bool third) {
    const double cc = ux * ux, cs = ux * uy, ss = uy * uy;
    Jet g{f.v,
          ux * f.x - uy * f.y,
          uy * f.x + ux * f.y,
          cc * f.xx - 2.0 * cs * f.xy + ss * f.yy,
          cs * (f.xx - f.yy) + (cc - ss) * f.xy,
          ss * f.xx + 2.0 * cs * f.xy + cc * f.yy};
    if (!third)
        return g;
    g.xxx = ux * (cc * f.xxx + 3.0 * ss * f.xyy) - uy * (3.0 * cc * f.xxy + ss * f.yyy);
    g.xxy = uy * (cc * f.xxx + (ss - 2.0 * cc) * f.xyy) + ux * ((cc - 2.0 * ss) * f.xxy + ss * f.yyy);
    g.xyy = ux * (ss * f.xxx + (cc - 2.0 * ss) * f.xyy) + uy * ((2.0 * cc - ss) * f.xxy - cc * f.yyy);
    g.yyy = uy * (ss * f.xxx + 3.0 * cc * f.xyy) + ux * (3.0 * ss * f.xxy + cc * f.yyy);
    return g;
}

} // namespace rodwake::elastic
