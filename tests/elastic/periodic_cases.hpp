#pragma once
// Comparisons of fields of a periodic box.

#include "periodic_oracle.hpp"
#include "stencil.hpp"

#include "rodwake/core/rng.hpp"
#include "rodwake/elastic/periodic.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rodwake::oracle {

inline constexpr double pi = std::numbers::pi;
inline constexpr double headings[] = {0.0, 0.3, pi / 4, 1.2, pi / 2, 3.0, -2.2};
inline constexpr elastic::FieldRequest plain{true, true, true, true, false};
inline constexpr elastic::FieldRequest with_gradients{.strain = true, .polar = true, .gradients = true};

/// A random case: a square for every other k, else sides up to 4 times each other; boxes from 1e-3 to
/// `largest_ratio` screening lengths, soft and stiff media, places near the rod and up to the far end.
BoxPoint sample(RandomStream& random, int k, double largest_ratio);
inline elastic::PeriodicField field_of(const BoxPoint& p) {
    return {{.eta = p.eta, .xi = p.xi}, p.sides(), p.heading};
}

/// Norms of the five plain quantities: displacement, strain, laplacian, gradient_of_trace, dipole.
using Norms = std::array<double, 5>;
Norms norms(const elastic::FieldValues& f);
/// Of got - wanted; infinite where a number of got is not finite.
Norms distances(const elastic::FieldValues& got, const elastic::FieldValues& wanted);
/// The largest at 24 places at the distance r from the rod.
Norms largest_at(const elastic::PeriodicField& field, double r);
/// The same of anything, from its norms at a place of the circle in the rod's frame.
template<class NormsAt>
Norms largest_on_circle(double r, NormsAt norms_at) {
    Norms largest{};
    for (int k = 0; k < 24; ++k) {
        const double angle = std::numbers::pi * k / 12.0;
        const Norms n = norms_at(r * std::cos(angle), r * std::sin(angle));
        for (std::size_t q = 0; q < n.size(); ++q)
            largest[q] = std::max(largest[q], n[q]);
    }
    return largest;
}
/// The largest of distances/scale.
double worst(const Norms& distances, const Norms& scale);
/// a + times b.
Norms sum(Norms a, const Norms& b, double times = 1.0);
/// The gradients by x or by y in place of the quantities that they are gradients of; the rest is 0.
elastic::FieldValues by_place(const elastic::FieldValues& f, bool by_x);
/// The angle over which the field changes: a wave of the box over 2 pi xi/L, an image by its distance.
double angle_of_change(const BoxPoint& p);

/// d/dh at h = 0 of each plain quantity of field_at(h), by difference quotients of that step.
template<class FieldAt>
elastic::FieldValues field_difference(FieldAt field_at, double step) {
    using elastic::FieldValues;
    std::array<FieldValues, 9> f;
    for (int k = 0; k < 9; ++k)
        f[k] = field_at((k - 4) * step);
    const auto slope = [&](auto part) {
        return difference_quotient([&](double k) { return part(f[static_cast<std::size_t>(k + 4.5)]); },
                                   1.0) /
               step;
    };
    FieldValues d;
    d.displacement = {slope([](const auto& v) { return v.displacement.x; }),
                      slope([](const auto& v) { return v.displacement.y; })};
    d.strain = {slope([](const auto& v) { return v.strain.xx; }),
                slope([](const auto& v) { return v.strain.xy; }),
                slope([](const auto& v) { return v.strain.yy; })};
    d.laplacian = {slope([](const auto& v) { return v.laplacian.x; }),
                   slope([](const auto& v) { return v.laplacian.y; })};
    d.gradient_of_trace = {slope([](const auto& v) { return v.gradient_of_trace.x; }),
                           slope([](const auto& v) { return v.gradient_of_trace.y; })};
    d.dipole = {slope([](const auto& v) { return v.dipole.x; }),
                slope([](const auto& v) { return v.dipole.y; })};
    return d;
}

/// From the box's axes to the rod's.
elastic::Vector to_rod(double heading, double x, double y);

} // namespace rodwake::oracle
