#pragma once
// The closed form written straight from the paper with Boost's or the GSL's Bessel functions. It overflows
// far behind the rod and cancels near it: compare the speed, not the digits.

#include "rodwake/elastic/medium.hpp"

#include <boost/math/special_functions/bessel.hpp>
#include <cmath>
#ifdef RODWAKE_BENCH_GSL
#include <gsl/gsl_sf_bessel.h>
#endif
#include <numbers>

inline constexpr rodwake::elastic::Medium plain_medium{.eta = 1.3, .xi = 1.0};

struct Place {
    double x, y;
};

using NoPromotion = boost::math::policies::policy<boost::math::policies::promote_double<false>>;
using Promotion = boost::math::policies::policy<>;

/// K_n of a library: of Boost with a policy, or of the GSL.
template<class Policy>
inline double plain_bessel_k(int n, double z) {
    return boost::math::cyl_bessel_k(n, z, Policy());
}
#ifdef RODWAKE_BENCH_GSL
struct Gsl {};
template<>
inline double plain_bessel_k<Gsl>(int n, double z) {
    return n == 0 ? gsl_sf_bessel_K0(z) : gsl_sf_bessel_K1(z);
}
#endif

/// K0 and K1 of both potentials with their exponentials, as printed.
template<class Policy>
struct Plain {
    double nu = plain_medium.nu(), c = 0.5 / plain_medium.xi, r, t0, t1, l0, l1;
    explicit Plain(Place p) : r(std::hypot(p.x, p.y)) {
        const double shear = std::exp(-c * p.x), longitudinal = std::exp(-nu * c * p.x);
        t0 = shear * plain_bessel_k<Policy>(0, c * r);
        t1 = shear * plain_bessel_k<Policy>(1, c * r);
        l0 = longitudinal * plain_bessel_k<Policy>(0, nu * c * r);
        l1 = longitudinal * plain_bessel_k<Policy>(1, nu * c * r);
    }
};

inline constexpr double plain_unit = 0.5 * std::numbers::inv_pi;

template<class Policy>
inline double plain_displacement(Place p) {
    const Plain<Policy> k(p);
    const double spread = k.t1 - k.nu * k.l1;
    const double ux = 0.5 * (k.t0 + k.nu * k.l0 - p.x / k.r * spread), uy = -0.5 * p.y / k.r * spread;
    return plain_unit * (ux + uy);
}

template<class Policy>
inline double plain_strain(Place p) {
    const Plain<Policy> k(p);
    const double cosine = p.x / k.r, sine = p.y / k.r, cc = cosine * cosine, ss = sine * sine;
    const auto yy = [&](double c, double k0, double k1) {
        return c * c * ss * k0 + (ss - cc) * c * k1 / k.r;
    };
    const auto xy = [&](double c, double k0, double k1) {
        return c * c * sine * k1 + cosine * sine * (c * c * k0 + 2.0 * c * k1 / k.r);
    };
    const double cl = k.nu * k.c, d_yy = yy(k.c, k.t0, k.t1) - yy(cl, k.l0, k.l1);
    const double d_xy = xy(k.c, k.t0, k.t1) - xy(cl, k.l0, k.l1);
    const double eyy = plain_medium.xi * d_yy, exx = -k.nu * cl * (k.l0 + cosine * k.l1) - eyy;
    return plain_unit * (exx + eyy + 0.5 * (-k.c * sine * k.t1 + 2.0 * plain_medium.xi * d_xy));
}
