#pragma once
// Steady field of a rod and all its images in an Lx x Ly periodic box, the zero Fourier mode removed: what a
// displacement measured in a periodic box is compared with (docs/numerics.md).
//
//   U = (1/2 pi) [ G_T xhat + xi grad (G_T - G_L) ],   lap G_i + 2 c_i d_x G_i = -2 pi (delta_per - 1/Lx Ly)
//
// with c_T = 1/(2 xi), c_L = nu c_T, x along the rod. The box's sides may lie at any angle to the rod. U is
// relative to its mean over the box, whatever the drift f/(zeta Lx Ly) of the medium as a whole.
//
// Error: below 1e-10 of the largest value of each quantity at the same distance from the rod, for L/xi in
// [1e-3, 1e3] of both sides, Ly/Lx in [1/4, 4], every eta and every heading (studies/reports/elastic.md);
// near the rod the field is the infinite plane's, exact to its last digits, and a smooth rest. Derivatives by
// eta and xi agree with differences to 1e-6, which is as far as those reach. Gradients and derivatives by
// heading: below 1e-9 of their own largest value at the same distance, the latter plus 1e-13 of the field, as
// they vanish for L/xi -> 0. Smaller and larger boxes are still right (derivatives by xi lose (xi/L)^2 of 16
// digits).
//
//   against Ewald sums               U        strain   lap u    grad div u  dipole   test_elastic
//   squares                          6e-13    1.3e-12           6e-12       3e-13    ("periodic")
//   rectangles                       1.2e-12  1.5e-12  1.2e-11  8e-12       7e-13    ("periodic rectangle")
//   squares, by heading              6e-12    2e-12    4e-11    8e-11       2e-12    ("by heading")
//   squares, gradients                        8e-13    6e-12    1.4e-11              ("gradients of ...")
//   rectangles, gradients                     6e-13    4e-11    1.1e-10              ("periodic rectangle")
//
// Degenerate input (tests/elastic/test_periodic_properties.cpp), InputError unless said:
//   a side <= 0, NaN or infinite; above 1000 times the other; above 2e6 xi or 2e6 xi/nu (eta -> -1, xi -> 0);
//   below 1e-100 xi (xi -> infinity; boxes above that are right); a heading or place that is not finite;
//   the rod or an image; gradients of derivatives by heading or by the medium. eta = 1e12: finite values.
//
// Cost of a square: 6 to 50 microseconds to construct for L/xi from 0.1 up, 90 at 1e-3; about 1 microsecond a
// point, 2 at 1e-3. With gradients a point costs 1.2 times as much. The first derivative by heading costs a
// second construction, each of them 1.5 points (bench/periodic_bench.cpp).

#include "rodwake/core/periodic.hpp"
#include "rodwake/elastic/field.hpp"
#include "rodwake/elastic/wake_field.hpp"

#include <memory>

namespace rodwake::elastic {

class PeriodicField final : public Wake {
public:
    /// Sides of `box` > 0, in the unit of medium.xi; `heading` of the rod against the box's x side, rad.
    /// Throws InputError.
    PeriodicField(const Medium& medium, const PeriodicBox& box, double heading = 0.0);

    /// The field at (x, y) in the rod's frame (rod at the origin, heading along +x), components in that
    /// frame. All of it as asked for, gradients too.
    FieldValues at(double x, double y, FieldRequest request) const override;

    /// What the images alone make at the rod's own place: a rod in a box is in its own images' wakes.
    FieldValues self_image_field(FieldRequest request) const override;

    /// d/d heading of at(x, y) and self_image_field, per rad: place and components fixed in the rod's frame,
    /// so that it is the box that turns about the rod, clockwise. 0 in the infinite plane. Of displacement,
    /// strain, polar and dipole as asked for; gradients are not available: InputError.
    FieldValues heading_derivative(double x, double y, FieldRequest request) const override;
    FieldValues own_place_by_heading(FieldRequest request) const override;

    /// d/d eta and d/d xi at fixed place and box, of what is asked for (not gradients).
    MediumDerivatives medium_derivatives(double x, double y, FieldRequest request) const override;
    /// The same of what the images alone make at the rod's own place.
    MediumDerivatives own_place_by_medium(FieldRequest request) const override;

    const Medium& medium() const;
    const PeriodicBox& box() const;
    double heading() const;

private:
    friend struct PeriodicInternals; ///< models/elastic/periodic_impl.hpp
    struct Impl;
    std::shared_ptr<const Impl> impl_; ///< shared: copies are cheap, calls independent and thread-safe
};

} // namespace rodwake::elastic
