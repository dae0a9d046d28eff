#pragma once
// Residuals of a measured displacement map against the steady field of a rod in an orthotropic medium.
//
//   model(x, y) = amplitude force U_f + p_xx U_xx + p_yy U_yy + q_xxx U_xxx + q_xyy U_xyy + q_yxy U_yxy
//                 + t_xxxx U_xxxx + t_xxyy U_xxyy + h_xxxxx U_xxxxx + h_xxxyy U_xxxyy + offset
//                                                                              (elastic/anisotropic.hpp)
//
// at every bin that the mask leaves, both components, in the rod's frame (x along the heading) with the
// crystal's axes along x and y. The fields U depend on c11, c22, c12, c66 and, where they are parameters,
// on zeta, rho and eta_s together with the map's speed. Only the ratios of forces to constants matter.
//
//   name                  meaning                                                  unit, for a length l
//   amplitude             monopole over its prediction `force`; absent: 1          1
//   force                 of the rod on the medium, along +x                       force
//   p_xx, p_yy            force dipoles of the rod, positive: outward              force l
//   q_xxx, q_xyy, q_yxy   second moments of the force density; fit two at most     force l^2
//   t_xxxx, t_xxyy        third moments of the force density along the heading     force l^3
//   h_xxxxx, h_xxxyy      fourth moments                                           force l^4
//   c11, c22, c12, c66    elastic constants; c11 along the heading                 force/l
//   zeta, rho, eta_s      drag, mass, viscosity per area; absent: 0                as in anisotropic.hpp
//   offset, offset_y      constants added to U_x and U_y                           l
//
// With `eta` among the parameters the medium is isotropic and everything in units of its shear modulus mu, as
// the theory has it (wake.hpp): c11 = c22 = 1 + eta, c12 = eta - 1, c66 = 1, zeta v = 1/xi, no rho and eta_s.
//
//   f_over_mu             force over shear modulus, in place of force              l
//   eta                   (c11 - c66)/c66, bulk over shear modulus                 1
//   xi                    mu/(zeta v); absent: infinite                            l
//   alpha, drag_area      in place of xi: f_over_mu/xi; |f_over_mu| xi = f/(zeta v)   1; l^2
//   p, q, t, h            over mu                                                  l^2, l^3, l^4, l^5
//
// Bins next to each other share noise: chi2 and the curvature's errors take them as independent but for
// `independent`. Where several runs were measured the jackknife (refits.hpp) needs no such assumption.

#include "rodwake/elastic/anisotropic.hpp"
#include "rodwake/fitting/wake.hpp"

#include <numbers>

namespace rodwake::fitting {

/// Bins are left out for |y| < strip, for r < radius, and where the angle from the heading, the same on both
/// sides of the rod, is not within [from, to].
struct MapMask {
    double strip = 0.0, radius = 0.0;
    double from = 0.0, to = std::numbers::pi; ///< rad

    bool keeps(double x, double y) const;
    bool operator==(const MapMask&) const = default;
};

/// Displacements on a grid of places, [row y][column x], in any unit of length.
struct Map {
    std::string name = {};
    double lx = 0.0, ly = 0.0; ///< sides of the periodic box along x and y
    double speed = 0.0;        ///< of the rod against the medium; negative: backwards
    std::vector<double> x = {}, y = {};
    std::vector<double> Ux = {}, Uy = {};
    std::vector<double> sigma_x = {}, sigma_y = {}; ///< standard errors, > 0; empty: equal, unknown
    std::vector<bool> known = {};                   ///< whether a bin has data
    double independent = 1.0; ///< independent values a bin is worth, in (0, 1]; sigma is enlarged by
                              ///< 1/sqrt(independent)

    std::size_t bins() const { return x.size() * y.size(); }
    double place_x(std::size_t bin) const { return x[bin % x.size()]; }
    double place_y(std::size_t bin) const { return y[bin / x.size()]; }
};

/// Of the source, the same for all maps.
struct MapModel {
    double rod_length = 0.0, source_width = 1.0; ///< RodFrame::length and width
};

std::vector<std::string> map_parameter_names();

/// Bins that are fitted.
std::vector<std::size_t> used_bins(const Map& map, const MapMask& mask);

/// Throws InputError for unknown or missing parameters (the four constants and a source, or f_over_mu and
/// eta; force with an amplitude), lists of wrong length, numbers that are not finite, sigma <= 0, maps with
/// and without sigma, a mask that leaves a map no bin, fewer data than free parameters, an illegal box,
/// length or width. Constants that are all fixed are worked out once, so that the problem is linear and an
/// evaluation costs a pass over the bins; a medium that has no steady field then throws here.
Problem map_problem(const MapModel& model, const std::vector<Map>& maps, const MapMask& mask,
                    std::vector<Parameter> parameters);

/// The model at every bin of the map.
elastic::DisplacementMap predict(const MapModel& model, const Map& map,
                                 const std::vector<Parameter>& parameters, std::span<const double> values);

/// The model at places along a line of the rod's frame, in the box and at the speed of the map, with
/// derivatives by all parameters.
Prediction predict_line(const MapModel& model, const Map& map, const Profile& line,
                        std::span<const double> positions, const std::vector<Parameter>& parameters,
                        std::span<const double> values);

} // namespace rodwake::fitting
