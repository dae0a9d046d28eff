#pragma once
// What is asked of a potential of the periodic box, in the box's own axes and with its side as the unit of
// length.

namespace rodwake::elastic {

/// A function of the plane with its first and second derivatives.
struct Jet {
    double v = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;
};

/// A potential and its derivative by its wave number c at a fixed place.
struct Jets {
    Jet g, by_c;
};

struct Needed {
    bool second = false; ///< second derivatives by place
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
    return a;
}

inline Jet operator+(Jet a, const Jet& b) { return a += b; }

inline Jet operator*(double s, const Jet& a) {
    return {s * a.v, s * a.x, s * a.y, s * a.xx, s * a.xy, s * a.yy};
}

/// (a + bx x + by y) f, where `line` is the linear function's value at the place.
inline Jet times_line(double line, double bx, double by, const Jet& f) {
    return {line * f.v,
            line * f.x + bx * f.v,
            line * f.y + by * f.v,
            line * f.xx + 2.0 * bx * f.x,
            line * f.xy + bx * f.y + by * f.x,
            line * f.yy + 2.0 * by * f.y};
}

/// scale exp(-cx x - cy y) f, where `scale` is the exponential at the place.
inline Jet times_decay(double scale, double cx, double cy, const Jet& f) {
    return {scale * f.v,
            scale * (f.x - cx * f.v),
            scale * (f.y - cy * f.v),
            scale * (f.xx - 2.0 * cx * f.x + cx * cx * f.v),
            scale * (f.xy - cx * f.y - cy * f.x + cx * cy * f.v),
            scale * (f.yy - 2.0 * cy * f.y + cy * cy * f.v)};
}

/// The same function with the axes exchanged.
inline Jet exchanged(const Jet& f) { return {f.v, f.y, f.x, f.yy, f.xy, f.xx}; }

/// From axes in which x runs along (ux, uy) to those in which (ux, uy) is given.
inline Jet from_axes(double ux, double uy, const Jet& f) {
    return {f.v,
            ux * f.x - uy * f.y,
            uy * f.x + ux * f.y,
            ux * ux * f.xx - 2.0 * ux * uy * f.xy + uy * uy * f.yy,
            ux * uy * (f.xx - f.yy) + (ux * ux - uy * uy) * f.xy,
            uy * uy * f.xx + 2.0 * ux * uy * f.xy + ux * ux * f.yy};
}

} // namespace rodwake::elastic
