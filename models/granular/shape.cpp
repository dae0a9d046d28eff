#include "rodwake/granular/shape.hpp"

#include "checks.hpp"
#include "rodwake/core/repeatable_math.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace rodwake::granular {

namespace {

// Outline of a row of overlapping spheres turned about its axis: R(x)^2 = max_k (r_k^2 - (x - c_k)^2). Two of
// these parabolas differ by a straight line, so they meet once and the outline is a chain of pieces, one
// sphere each.

/// R(x)^2 = radius^2 - (x - centre)^2 for from <= x <= to.
struct OutlinePiece {
    double centre, radius, from, to;
};

/// Integrals along the whole axis, about x = 0.
struct OutlineIntegrals {
    double r1 = 0.0;    ///< of R
    double r2 = 0.0;    ///< of R^2
    double x_r2 = 0.0;  ///< of x R^2
    double x2_r2 = 0.0; ///< of x^2 R^2
    double r4 = 0.0;    ///< of R^4
};

/// Antiderivatives at t = x - centre, all zero at the centre.
OutlineIntegrals up_to(const OutlinePiece& piece, double x) {
    const double c = piece.centre, s = piece.radius * piece.radius;
    const double t = std::clamp(x - c, -piece.radius, piece.radius), t2 = t * t;
    const double m0 = t * (s - t2 / 3.0), m1 = t2 * (s / 2.0 - t2 / 4.0), m2 = t * t2 * (s / 3.0 - t2 / 5.0);
    OutlineIntegrals sum;
    sum.r1 = 0.5 * (t * std::sqrt(s - t2) + s * repeatable::asin(t / piece.radius));
    sum.r2 = m0;
    sum.x_r2 = m1 + c * m0;
    sum.x2_r2 = m2 + c * (2.0 * m1 + c * m0);
    sum.r4 = t * (s * s - t2 * (2.0 * s / 3.0 - t2 / 5.0));
    return sum;
}

/// Pieces from left to right. Centres increase; neighbours overlap.
std::vector<OutlinePiece> outline(const std::vector<double>& centre, const std::vector<double>& radius) {
    std::vector<OutlinePiece> pieces;
    for (std::size_t k = 0; k < centre.size(); ++k) {
        double from = centre[k] - radius[k];
        while (!pieces.empty()) { // the new sphere hides every earlier one that begins after they meet
            const auto& last = pieces.back();
            from = 0.5 * (last.centre + centre[k]) +
                   0.5 * (last.radius - radius[k]) * (last.radius + radius[k]) / (centre[k] - last.centre);
            if (from > last.from)
                break;
            pieces.pop_back();
            from = centre[k] - radius[k];
        }
        if (!pieces.empty()) {
            auto& last = pieces.back();
            if (from >= last.centre + last.radius) // the new sphere is inside the last one
                continue;
            last.to = from;
        }
        pieces.push_back({centre[k], radius[k], from, centre[k] + radius[k]});
    }
    return pieces;
}

OutlineIntegrals integrate(const std::vector<OutlinePiece>& pieces) {
    OutlineIntegrals sum;
    for (const auto& piece : pieces) {
        const auto low = up_to(piece, piece.from), high = up_to(piece, piece.to);
        sum.r1 += high.r1 - low.r1;
        sum.r2 += high.r2 - low.r2;
        sum.x_r2 += high.x_r2 - low.x_r2;
        sum.x2_r2 += high.x2_r2 - low.x2_r2;
        sum.r4 += high.r4 - low.r4;
    }
    return sum;
}

constexpr std::size_t most_spheres = 10000;
constexpr double length_rounding = 1e-9; // of the length: two ways to write the same number

void check_shape(const RodShape& shape) {
    Checks checks;
    checks.positive("length", shape.length);
    checks.positive("thick_diameter", shape.thick_diameter);
    checks.positive("thin_diameter", shape.thin_diameter);
    checks.positive("density", shape.density);
    checks.require(shape.spheres >= 1 && shape.spheres <= most_spheres,
                   fmt::format("spheres = {}: must be 1 to {}", shape.spheres, most_spheres));
    checks.finish();
    const bool apolar = shape.kind == RodKind::apolar;
    checks.require(shape.thin_diameter <= shape.thick_diameter,
                   fmt::format("thin_diameter = {} m: must be at most thick_diameter = {} m",
                               shape.thin_diameter, shape.thick_diameter));
    checks.require(shape.length >= shape.thick_diameter * (1.0 - length_rounding),
                   fmt::format("length = {} m: must be at least thick_diameter = {} m", shape.length,
                               shape.thick_diameter));
    checks.require(!apolar || shape.spheres % 2 == 1,
                   fmt::format("spheres = {}: an apolar rod needs an odd number (an even row has no middle "
                               "sphere and starts to move by itself); use {}",
                               shape.spheres, shape.spheres + 1));
    const double longest = std::max(shape.length, shape.thick_diameter);
    checks.require(
        shape.spheres > 1 || longest - shape.thin_diameter <= length_rounding * longest,
        fmt::format("spheres = 1: one sphere needs length = thick_diameter = thin_diameter, but they "
                    "are {}, {} and {} m; make them equal or spheres >= 2",
                    shape.length, shape.thick_diameter, shape.thin_diameter));
    const bool stepwise = shape.taper == Taper::stepwise;
    const std::size_t most_segments = apolar ? (shape.spheres + 1) / 2 : shape.spheres;
    checks.require(!stepwise || (shape.segments >= 1 && shape.segments <= most_segments),
                   fmt::format("segments = {}: must be 1 to {}, the number of spheres{}", shape.segments,
                               most_segments, apolar ? " from the middle to one end" : ""));
    checks.require(!stepwise || shape.segments != 1 || shape.thick_diameter == shape.thin_diameter,
                   fmt::format("segments = 1: one piece has one diameter, but thick_diameter = {} m and "
                               "thin_diameter = {} m; make them equal or segments >= 2",
                               shape.thick_diameter, shape.thin_diameter));
    checks.finish();
}

void check_row(const RodShape& shape, const Clump& row) {
    Checks checks;
    for (std::size_t k = 0; k < row.offset.size(); ++k) {
        const double out =
            std::max(row.offset[k] + row.radius[k] - shape.length, row.radius[k] - row.offset[k]);
        checks.require(
            out <= length_rounding * shape.length,
            fmt::format("sphere {} of radius {} m sticks out of the end of the rod by {} m: make the rod "
                        "longer, the taper weaker or the segments more",
                        k, row.radius[k], out));
        if (k == 0)
            continue;
        const double apart = row.offset[k] - row.offset[k - 1], touch = row.radius[k] + row.radius[k - 1];
        checks.require(
            shape.spheres == 1 || (apart > 0.0 && apart < touch),
            fmt::format(
                "spheres {} and {} of the rod are {} m apart: must be > 0 and less than {} m, the sum "
                "of their radii; {}",
                k - 1, k, apart, touch, apart > 0.0 ? "use more spheres" : "use fewer spheres"));
        if (!checks.passed())
            break; // the others are the same mistake
    }
    checks.finish();
}

} // namespace

double Clump::reach() const {
    double furthest = 0.0;
    for (std::size_t k = 0; k < offset.size(); ++k)
        furthest = std::max(furthest, std::abs(offset[k]) + radius[k]);
    return furthest;
}

double Clump::projected_area() const { return 2.0 * integrate(outline(offset, radius)).r1; }

Clump make_clump(const RodShape& shape) {
    check_shape(shape);
    const bool apolar = shape.kind == RodKind::apolar;
    const std::size_t middle = (shape.spheres - 1) / 2, steps = apolar ? middle + 1 : shape.spheres;
    // Share i of n in equal steps from 0 to 1.
    const auto share = [](std::size_t i, std::size_t n, double alone) {
        return n > 1 ? static_cast<double>(i) / static_cast<double>(n - 1) : alone;
    };
    // Centres from the thick end at 0 on (apolar: from either end).
    Clump clump;
    const double first = 0.5 * (apolar ? shape.thin_diameter : shape.thick_diameter);
    const double last = shape.length - 0.5 * shape.thin_diameter;
    for (std::size_t k = 0; k < shape.spheres; ++k) {
        const double u = share(k, shape.spheres, 0.5);
        clump.offset.push_back(first * (1.0 - u) + last * u);
        // The taper is 0 where the rod is thick, 1 where it is thin.
        const std::size_t step = !apolar ? k : k > middle ? k - middle : middle - k;
        const double taper = shape.taper == Taper::linear
                                 ? share(step, steps, 0.0)
                                 : share(step * shape.segments / steps, shape.segments, 0.0);
        clump.radius.push_back(0.5 * (shape.thick_diameter * (1.0 - taper) + shape.thin_diameter * taper));
    }
    check_row(shape, clump);
    // About the middle: the centre of mass is near it, so nothing cancels. An apolar row becomes symmetric to
    // the bit, so that no rounding gives it a direction.
    for (double& offset : clump.offset)
        offset -= 0.5 * shape.length;
    for (std::size_t k = 0, end = clump.offset.size() - 1; apolar && k < end - k; ++k)
        clump.offset[end - k] = -clump.offset[k];
    if (apolar)
        clump.offset[clump.offset.size() / 2] = 0.0;
    const auto solid = integrate(outline(clump.offset, clump.radius));
    const double centre = apolar ? 0.0 : solid.x_r2 / solid.r2;
    for (double& offset : clump.offset)
        offset -= centre;
    const double line_density = M_PI * shape.density;
    clump.mass = line_density * solid.r2;
    clump.axial_inertia = line_density * 0.5 * solid.r4;
    clump.transverse_inertia = line_density * (0.25 * solid.r4 + solid.x2_r2 - centre * centre * solid.r2);
    return clump;
}

} // namespace rodwake::granular
