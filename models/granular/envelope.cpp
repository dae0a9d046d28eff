#include "envelope.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace rodwake::granular {

namespace {

/// Where the parabolas of two spheres meet; the one with the larger centre is above to the right of it.
double crossing(double c1, double r1, double c2, double r2) {
    return 0.5 * (c1 + c2) + 0.5 * (r1 - r2) * (r1 + r2) / (c2 - c1);
}

/// Antiderivatives at t = x - centre, all zero at the centre.
OutlineIntegrals up_to(const OutlinePiece& piece, double x) {
    const double c = piece.centre, s = piece.radius * piece.radius;
    const double t = std::clamp(x - c, -piece.radius, piece.radius), t2 = t * t;
    const double m0 = t * (s - t2 / 3.0), m1 = t2 * (s / 2.0 - t2 / 4.0), m2 = t * t2 * (s / 3.0 - t2 / 5.0);
    OutlineIntegrals sum;
    sum.r1 = 0.5 * (t * std::sqrt(s - t2) + s * std::asin(t / piece.radius));
    sum.r2 = m0;
    sum.x_r2 = m1 + c * m0;
    sum.x2_r2 = m2 + c * (2.0 * m1 + c * m0);
    sum.r4 = t * (s * s - t2 * (2.0 * s / 3.0 - t2 / 5.0));
    return sum;
}

} // namespace

std::vector<OutlinePiece> outline(const std::vector<double>& centre, const std::vector<double>& radius) {
    std::vector<OutlinePiece> pieces;
    for (std::size_t k = 0; k < centre.size(); ++k) {
        double from = centre[k] - radius[k];
        while (!pieces.empty()) { // the new sphere hides every earlier one that begins after they meet
            const auto& last = pieces.back();
            from = crossing(last.centre, last.radius, centre[k], radius[k]);
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

} // namespace rodwake::granular
