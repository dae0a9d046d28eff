// The orthotropic field in a box: the closed isotropic field, the equation itself, symmetries, derivatives.

#include "rodwake/core/error.hpp"
#include "rodwake/elastic/anisotropic.hpp"
#include "rodwake/elastic/periodic.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>
#include <vector>

using namespace rodwake;
using namespace rodwake::elastic;

namespace {

constexpr double side = 78.0;
const std::vector<double> places = {-31.0, -17.0, -8.0, 0.0, 5.0, 11.0, 24.0, 37.0};

OrthotropicMedium isotropic(double eta, double zeta) {
    return {.c11 = 1.0 + eta, .c22 = 1.0 + eta, .c12 = eta - 1.0, .c66 = 1.0, .zeta = zeta};
}

/// Stiffer across than along, as a strained crystal is, with all terms of motion.
const OrthotropicMedium crystal{
    .c11 = 3.1, .c22 = 4.4, .c12 = 1.3, .c66 = 1.0, .zeta = 0.02, .rho = 0.03, .eta_s = 0.15};
const RodFrame moving{.lx = side, .ly = 72.0, .speed = 1.7, .length = 11.25, .width = 1.5};

/// Largest difference from the closed field with the smoothing's first term, w^2/2 lap U, added to it,
/// outside 8 of the rod; U in f/mu.
double difference_from_closed(double eta, double xi, double width) {
    const AnisotropicField field({side, side, 1.0, 0.0, width}, places, places);
    const DisplacementMap map = field.displacement(isotropic(eta, 1.0 / xi), {.force = 1.0});
    const PeriodicField closed({eta, xi}, side);
    double largest = 0.0;
    for (std::size_t j = 0; j < places.size(); ++j)
        for (std::size_t k = 0; k < places.size(); ++k) {
            if (std::hypot(places[k], places[j]) < 7.9)
                continue;
            const FieldValues f = closed.at(places[k], places[j], {.displacement = true, .polar = true});
            const double more = 0.5 * width * width, *ux = &map.Ux[j * places.size() + k],
                         *uy = &map.Uy[j * places.size() + k];
            largest = std::max({largest, std::abs(*ux - f.displacement.x - more * f.laplacian.x),
                                std::abs(*uy - f.displacement.y - more * f.laplacian.y)});
        }
    return largest;
}

double dipole_difference(double eta, double xi, double width) {
    const AnisotropicField field({side, side, 1.0, 0.0, width}, places, places);
    const DisplacementMap map = field.displacement(isotropic(eta, 1.0 / xi), {.p_yy = 1.0});
    const PeriodicField closed({eta, xi}, side);
    double largest = 0.0;
    for (std::size_t j = 0; j < places.size(); ++j)
        for (std::size_t k = 0; k < places.size(); ++k) {
            if (std::hypot(places[k], places[j]) < 15.0)
                continue;
            const Vector u = closed.at(places[k], places[j], {.dipole = true}).dipole;
            largest = std::max({largest, std::abs(map.Ux[j * places.size() + k] - u.x),
                                std::abs(map.Uy[j * places.size() + k] - u.y)});
        }
    return largest;
}

double largest(const std::vector<double>& values) {
    double out = 0.0;
    for (const double value : values)
        out = std::max(out, std::abs(value));
    return out;
}

void add(DisplacementMap& sum, const DisplacementMap& more, double factor) {
    for (std::size_t i = 0; i < sum.Ux.size(); ++i) {
        sum.Ux[i] += factor * more.Ux[i];
        sum.Uy[i] += factor * more.Uy[i];
    }
}

/// A source of the kind and strength at (x, y), the field at `places`.
struct PointSource {
    RodSource source;
    double x = 0.0, y = 0.0;
};

const RodFrame point{.lx = side, .ly = 72.0, .speed = 1.7, .length = 0.0, .width = 1.5};

DisplacementMap field_of(const std::vector<PointSource>& sources) {
    DisplacementMap sum{std::vector<double>(places.size() * places.size()),
                        std::vector<double>(places.size() * places.size())};
    for (const PointSource& s : sources) {
        std::vector<double> x(places), y(places);
        for (double& place : x)
            place -= s.x;
        for (double& place : y)
            place -= s.y;
        add(sum, AnisotropicField(point, x, y).displacement(crystal, s.source), 1.0);
    }
    return sum;
}

/// Largest difference between the field of a source and that of others, over the largest value of the first.
double relative_difference(const RodSource& one, const std::vector<PointSource>& others) {
    const DisplacementMap expected = field_of({{one}});
    DisplacementMap difference = field_of(others);
    add(difference, expected, -1.0);
    return std::max(largest(difference.Ux), largest(difference.Uy)) /
           std::max(largest(expected.Ux), largest(expected.Uy));
}

double* constant(OrthotropicMedium& m, OrthotropicParameter by) {
    double* all[] = {&m.c11, &m.c22, &m.c12, &m.c66, &m.zeta, &m.rho, &m.eta_s};
    return all[static_cast<int>(by) - static_cast<int>(OrthotropicParameter::c11)];
}

} // namespace

TEST_CASE("the isotropic limit is the closed periodic field") {
    // The next term of the smoothing is w^4/8 lap^2 U, about w^4 U/r^4 of a field that falls as ln r: at 8
    // and w = 0.5 below 2e-5 of U, and 16 times less for half the width.
    for (const double xi : {9.0, 60.0, 4000.0})
        for (const double eta : {0.4, 1.0, 4.4}) {
            CAPTURE(xi, eta);
            const double wide = difference_from_closed(eta, xi, 0.8),
                         narrow = difference_from_closed(eta, xi, 0.4);
            CHECK(narrow < 2e-6);
            CHECK(wide / narrow == Approx(16.0).margin(2.0)); // next term w^6: a few per cent
        }
}

TEST_CASE("the dipole across is that of the closed field, in sign too") {
    for (const double xi : {9.0, 60.0}) {
        CAPTURE(xi);
        const double wide = dipole_difference(1.3, xi, 0.8), narrow = dipole_difference(1.3, xi, 0.4);
        CHECK(narrow < 1e-4);                            // w^2/2 lap U_dip
        CHECK(wide / narrow == Approx(4.0).margin(0.2)); // second order in w
    }
}

TEST_CASE("a rod that moves backwards makes the mirror image") {
    RodFrame back = moving;
    back.speed = -moving.speed;
    std::vector<double> mirrored(places);
    for (double& x : mirrored)
        x = -x;
    const auto ahead =
        AnisotropicField(moving, places, places).displacement(crystal, {1.0, 0.3, -2.0, 6.0, -11.0, 8.0});
    const auto behind =
        AnisotropicField(back, mirrored, places).displacement(crystal, {-1.0, 0.3, -2.0, -6.0, 11.0, -8.0});
    for (std::size_t i = 0; i < ahead.Ux.size(); ++i) {
        CHECK(behind.Ux[i] == Approx(-ahead.Ux[i]).margin(1e-14));
        CHECK(behind.Uy[i] == Approx(ahead.Uy[i]).margin(1e-14));
    }
}

TEST_CASE("the equation of motion holds away from the sources") {
    // By central differences of step h in the smoothed field: errors of order h^2/L^2 of each term.
    const double h = 0.2, x0 = 21.0, y0 = -14.0;
    const std::vector<double> x = {x0 - 2 * h, x0 - h, x0, x0 + h, x0 + 2 * h}, y = {y0 - h, y0, y0 + h};
    const DisplacementMap u = AnisotropicField(moving, x, y).displacement(crystal, {1.0, 2.0, -3.0});
    const auto at = [&](const std::vector<double>& v, int i, int j) {
        return v[static_cast<std::size_t>((j + 1) * 5 + i + 2)];
    };
    const auto dx = [&](const std::vector<double>& v, int i) {
        return (at(v, i + 1, 0) - at(v, i - 1, 0)) / (2 * h);
    };
    const auto xx = [&](const std::vector<double>& v, int i, int j) {
        return (at(v, i + 1, j) - 2 * at(v, i, j) + at(v, i - 1, j)) / (h * h);
    };
    const auto yy = [&](const std::vector<double>& v, int i) {
        return (at(v, i, 1) - 2 * at(v, i, 0) + at(v, i, -1)) / (h * h);
    };
    const auto xy = [&](const std::vector<double>& v) {
        return (at(v, 1, 1) - at(v, 1, -1) - at(v, -1, 1) + at(v, -1, -1)) / (4 * h * h);
    };
    const double v = moving.speed;
    const auto motion = [&](const std::vector<double>& w) {
        const double lap_x = (xx(w, 1, 0) + yy(w, 1) - xx(w, -1, 0) - yy(w, -1)) / (2 * h);
        return crystal.zeta * v * dx(w, 0) - crystal.rho * v * v * xx(w, 0, 0) - crystal.eta_s * v * lap_x;
    };
    const double both = crystal.c12 + crystal.c66;
    const double along = crystal.c11 * xx(u.Ux, 0, 0) + crystal.c66 * yy(u.Ux, 0) + both * xy(u.Uy),
                 across = crystal.c66 * xx(u.Uy, 0, 0) + crystal.c22 * yy(u.Uy, 0) + both * xy(u.Ux);
    // The drift that the missing zero mode stands for: f/(Lx Ly) is spread evenly against the rod.
    CHECK(along + motion(u.Ux) == Approx(1.0 / (moving.lx * moving.ly)).epsilon(0.01));
    CHECK(across + motion(u.Uy) == Approx(0.0).margin(0.01 / (moving.lx * moving.ly)));
}

TEST_CASE("maps are linear in the sources, and derivatives those of differences") {
    const AnisotropicField field(moving, places, places);
    const RodSource source{1.4, 0.7, -2.2, 13.0, -9.0, 5.0, 31.0, -17.0, 90.0, -70.0};
    const DisplacementMap whole = field.displacement(crystal, source);
    using enum OrthotropicParameter;
    DisplacementMap sum{std::vector<double>(whole.Ux.size()), std::vector<double>(whole.Uy.size())};
    for (const auto& [by, strength] : {std::pair{force, 1.4},
                                       {p_xx, 0.7},
                                       {p_yy, -2.2},
                                       {q_xxx, 13.0},
                                       {q_xyy, -9.0},
                                       {q_yxy, 5.0},
                                       {t_xxxx, 31.0},
                                       {t_xxyy, -17.0},
                                       {h_xxxxx, 90.0},
                                       {h_xxxyy, -70.0}})
        add(sum, field.derivative(crystal, source, by), strength);
    for (std::size_t i = 0; i < whole.Ux.size(); ++i) {
        CHECK(whole.Ux[i] == Approx(sum.Ux[i]).margin(1e-13));
        CHECK(whole.Uy[i] == Approx(sum.Uy[i]).margin(1e-13));
    }
    for (const auto by : {c11, c22, c12, c66, zeta, rho, eta_s}) {
        CAPTURE(static_cast<int>(by));
        OrthotropicMedium up = crystal, down = crystal;
        const double h = 1e-4 * *constant(up, by);
        *constant(up, by) += h;
        *constant(down, by) -= h;
        const auto d = field.derivative(crystal, source, by), plus = field.displacement(up, source),
                   minus = field.displacement(down, source);
        for (std::size_t i = 0; i < d.Ux.size(); ++i) {
            // rounding 1e-16/1e-4 and the third derivative, h^2 relative
            CHECK((plus.Ux[i] - minus.Ux[i]) / (2 * h) == Approx(d.Ux[i]).margin(1e-6 * largest(d.Ux)));
            CHECK((plus.Uy[i] - minus.Uy[i]) / (2 * h) == Approx(d.Uy[i]).margin(1e-6 * largest(d.Uy)));
        }
    }
}

TEST_CASE("a crystal turned by a right angle swaps c11, c22 and the sides") {
    // p_xx of the one is p_yy of the other, fields reflected at the diagonal, when nothing moves.
    const OrthotropicMedium turned{
        .c11 = crystal.c22, .c22 = crystal.c11, .c12 = crystal.c12, .c66 = crystal.c66};
    const OrthotropicMedium straight{
        .c11 = crystal.c11, .c22 = crystal.c22, .c12 = crystal.c12, .c66 = crystal.c66};
    const auto a =
        AnisotropicField({78.0, 60.0, 0.0, 0.0, 2.0}, places, places).displacement(straight, {.p_xx = 1.0});
    const auto b =
        AnisotropicField({60.0, 78.0, 0.0, 0.0, 2.0}, places, places).displacement(turned, {.p_yy = 1.0});
    const std::size_t n = places.size();
    for (std::size_t j = 0; j < n; ++j)
        for (std::size_t k = 0; k < n; ++k) {
            CHECK(a.Ux[j * n + k] == Approx(b.Uy[k * n + j]).margin(1e-14));
            CHECK(a.Uy[j * n + k] == Approx(b.Ux[k * n + j]).margin(1e-14));
        }
}

TEST_CASE("second moments are those of point sources close together") {
    // Forces 1/h^2 at +-h and -2/h^2 between them have q = 1/2 * 2 * h^2/h^2 = 1; dipoles p_yy = +-1/h at
    // x = +-h have int f_y x y = 2, so q_yxy = 1. The next terms are of order (h/w)^2: 2 % at h = 0.2.
    const auto beside = [](double h, double dx, double dy) {
        const double f = 1.0 / (h * h);
        return std::vector<PointSource>{
            {{.force = f}, dx * h, dy * h}, {{.force = -2.0 * f}}, {{.force = f}, -dx * h, -dy * h}};
    };
    const auto along = [&](double h) { return relative_difference({.q_xxx = 1.0}, beside(h, 1.0, 0.0)); };
    const auto across = [&](double h) { return relative_difference({.q_xyy = 1.0}, beside(h, 0.0, 1.0)); };
    const auto couple = [](double h) {
        return relative_difference({.q_yxy = 1.0},
                                   {{{.p_yy = 1.0 / h}, h, 0.0}, {{.p_yy = -1.0 / h}, -h, 0.0}});
    };
    for (const std::function<double(double)>& difference :
         {std::function<double(double)>(along), std::function<double(double)>(across),
          std::function<double(double)>(couple)}) {
        const double wide = difference(0.2), narrow = difference(0.1);
        CHECK(wide < 0.02); // a wrong sign makes it 2, a wrong factor of 2 makes it 0.5 or 1
        CHECK(wide / narrow == Approx(4.0).margin(0.1)); // second order in h; the next term is (h/w)^2 of it
    }
}

TEST_CASE("third and fourth moments are those of point sources close together") {
    // -1/2, 1, -1, 1/2 at -2h, -h, h, 2h have sum f x = sum f x^2 = 0 and sum f x^3 = 6 h^3, so t_xxxx = 1
    // over h^3; forces +-3/(2 h^3) at x = +-h times 1, -2, 1 at y = -h, 0, h have sum f x y^2 = 6, so t_xxyy
    // = 1.
    const auto along = [](double h) {
        const double f = 1.0 / (h * h * h);
        return relative_difference({.t_xxxx = 1.0}, {{{.force = -0.5 * f}, -2 * h, 0.0},
                                                     {{.force = f}, -h, 0.0},
                                                     {{.force = -f}, h, 0.0},
                                                     {{.force = 0.5 * f}, 2 * h, 0.0}});
    };
    const auto across = [](double h) {
        std::vector<PointSource> all;
        for (const double x : {-h, h})
            for (const auto& [y, weight] : {std::pair{-h, 1.0}, {0.0, -2.0}, {h, 1.0}})
                all.push_back({{.force = 1.5 * weight * x / std::pow(h, 4)}, x, y});
        return relative_difference({.t_xxyy = 1.0}, all);
    };
    // 1, -4, 6, -4, 1 at -2h to 2h have sum f x^4 = 24 h^4; 1, -2, 1 in x times the same in y have sum f x^2
    // y^2 = 4 h^4, so h_xxxyy = 1/6.
    const auto squares = [](double h) {
        std::vector<PointSource> all;
        for (const auto& [x, along_x] : {std::pair{-h, 1.0}, {0.0, -2.0}, {h, 1.0}})
            for (const auto& [y, along_y] : {std::pair{-h, 1.0}, {0.0, -2.0}, {h, 1.0}})
                all.push_back({{.force = 6.0 * along_x * along_y / std::pow(h, 4)}, x, y});
        return relative_difference({.h_xxxyy = 1.0}, all);
    };
    const auto fourth = [](double h) {
        const double f = 1.0 / std::pow(h, 4);
        return relative_difference({.h_xxxxx = 1.0}, {{{.force = f}, -2 * h, 0.0},
                                                      {{.force = -4.0 * f}, -h, 0.0},
                                                      {{.force = 6.0 * f}},
                                                      {{.force = -4.0 * f}, h, 0.0},
                                                      {{.force = f}, 2 * h, 0.0}});
    };
    for (const std::function<double(double)>& difference :
         {std::function<double(double)>(along), std::function<double(double)>(across),
          std::function<double(double)>(squares), std::function<double(double)>(fourth)}) {
        const double wide = difference(0.2), narrow = difference(0.1);
        CHECK(wide < 0.05);
        CHECK(wide / narrow == Approx(4.0).margin(0.2)); // second order in h
    }
}

TEST_CASE("fields of moments at rest have the parity of the force's, along x and across") {
    RodFrame rest = moving;
    rest.speed = 0.0;
    const std::vector<double> at = {-24.0, -9.0, 9.0, 24.0};
    const std::size_t n = at.size();
    for (const RodSource& source : {RodSource{.q_xxx = 1.0}, {.q_xyy = 1.0}, {.q_yxy = 1.0}}) {
        const DisplacementMap u = AnisotropicField(rest, at, at).displacement(crystal, source);
        CHECK(std::min(largest(u.Ux), largest(u.Uy)) > 1e-6); // of about q/r^2 at 13
        for (std::size_t j = 0; j < n; ++j)
            for (std::size_t k = 0; k < n; ++k) {
                const std::size_t here = j * n + k, left = j * n + n - 1 - k, below = (n - 1 - j) * n + k;
                CHECK(u.Ux[left] == Approx(u.Ux[here]).margin(1e-15));
                CHECK(u.Ux[below] == Approx(u.Ux[here]).margin(1e-15));
                CHECK(u.Uy[left] == Approx(-u.Uy[here]).margin(1e-15));
                CHECK(u.Uy[below] == Approx(-u.Uy[here]).margin(1e-15));
            }
    }
}

TEST_CASE("one combination of moments shows nowhere but at the rod") {
    OrthotropicMedium medium = crystal;
    medium.eta_s = 0.0;
    const double v = moving.speed, w = moving.width, area = moving.lx * moving.ly;
    const RodSource hidden{.p_xx = medium.zeta * v,
                           .q_xxx = medium.rho * v * v - medium.c11,
                           .q_xyy = -medium.c66,
                           .q_yxy = -0.5 * (medium.c12 + medium.c66)};
    const DisplacementMap u = AnisotropicField(moving, places, places).displacement(medium, hidden);
    for (std::size_t j = 0; j < places.size(); ++j)
        for (std::size_t k = 0; k < places.size(); ++k) {
            const double square = places[k] * places[k] + places[j] * places[j],
                         gauss = std::exp(-0.5 * square / (w * w)) / (2.0 * std::numbers::pi * w * w);
            // modes beyond the cutoff of 6.5/w: exp(-6.5^2/2) of the largest value, 7e-10
            CHECK(u.Ux[j * places.size() + k] == Approx(gauss - 1.0 / area).margin(1e-9));
            CHECK(u.Uy[j * places.size() + k] == Approx(0.0).margin(1e-9));
        }
}

TEST_CASE("media without a steady field are refused") {
    const AnisotropicField field(moving, places, places);
    OrthotropicMedium fast = crystal, unstable = crystal, negative = crystal;
    fast.rho = 0.4; // rho v^2 = 1.16 > c66
    unstable.c12 = 4.9;
    negative.zeta = -0.1;
    for (const auto& medium : {fast, unstable, negative})
        CHECK_THROWS_AS(field.displacement(medium, {.force = 1.0}), InputError);
    CHECK_THROWS_AS(AnisotropicField({78.0, 78.0, 0.0, 80.0, 1.0}, places, places), InputError);
    CHECK_THROWS_AS(AnisotropicField({78.0, 78.0, 0.0, 0.0, 0.01}, places, places), InputError);
    CHECK_THROWS_AS(AnisotropicField({78.0, 0.0, 0.0, 0.0, 1.0}, places, places), InputError);
}
