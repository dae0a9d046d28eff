#include "periodic_local.hpp"

#include "bessel.hpp"

#include <cmath>
#include <initializer_list>
#include <numbers>

namespace rodwake::elastic {

namespace {

constexpr int samples = 2 * LocalRest::terms; // a multiple of 8: none on a diagonal
constexpr double radius = 0.5;

struct LocalPoint {
    double x, y;
};

/// The circle's places, none on an axis.
const std::array<LocalPoint, samples>& circle() {
    static const auto positions = [] {
        std::array<LocalPoint, samples> p;
        for (int j = 0; j < samples; ++j) {
            const double angle = 2.0 * std::numbers::pi * (j + 0.5) / samples;
            p[j] = {radius * std::cos(angle), radius * std::sin(angle)};
        }
        return p;
    }();
    return positions;
}

/// e^(-i m angle_j) radius^-m (2 - [m = 0])/samples
using Transform = std::array<std::array<Complex, samples>, LocalRest::terms>;
const Transform& transform() {
    static const auto table = [] {
        Transform t;
        for (int m = 0; m < LocalRest::terms; ++m)
            for (int j = 0; j < samples; ++j)
                t[m][j] = std::polar((m ? 2.0 : 1.0) / samples * std::pow(radius, -m),
                                     -2.0 * std::numbers::pi * m * (j + 0.5) / samples);
        return t;
    }();
    return table;
}

/// The potential on the circle and its derivative by c. Places j and samples-1-j are mirrored in y.
std::array<PeriodicRows::Values, samples> on_circle(const PeriodicBox& box, const PeriodicRows& columns,
                                                    const PeriodicRows& rows) {
    std::array<PeriodicRows::Values, samples> v;
    const auto positive = [](double x, double side) { return x < 0.0 ? x + side : x; };
    for (int j = 0; j < samples / 2; ++j) {
        const auto [x, y] = circle()[j];
        if (std::abs(x) < y)
            continue;
        const auto [upper, lower] = columns.values(positive(x, box.x), y);
        v[j] = upper;
        v[samples - 1 - j] = lower;
    }
    for (int j = 0; j < samples; ++j) { // mirrored in x: j and samples/2 - 1 - j
        const auto [x, y] = circle()[j];
        if (x <= 0.0 || x >= std::abs(y))
            continue;
        const auto [right, left] = rows.values(positive(y, box.y), x);
        v[j] = right;
        v[(samples + samples / 2 - 1 - j) % samples] = left;
    }
    return v;
}

} // namespace

/// psi_m, m = 0 .. terms + 2.
struct LocalRest::Basis {
    std::array<Complex, terms + 3> psi;

    Basis(double c, double x, double y) {
        const double t = 0.25 * c * c * (x * x + y * y);
        std::array<double, terms + 3> ratio;
        ratio[terms + 2] = bessel_ratio(terms + 2, t);
        ratio[terms + 1] = bessel_ratio(terms + 1, t);
        for (int m = terms + 1; m > 0; --m)
            ratio[m - 1] = ratio[m] + t / (m * (m + 1.0)) * ratio[m + 1];
        Complex power = 1.0;
        for (int m = 0; m < terms + 3; ++m) {
            psi[m] = ratio[m] * power;
            power = times(power, {x, y});
        }
    }
};

/// F = sum A_m psi_m under the operators up = d_x + i d_y and down = d_x - i d_y:
/// up psi_m = c^2/(2 (m+1)) psi_(m+1),  down psi_m = 2 m psi_(m-1),  down psi_0 = (c^2/2) conj psi_1.
struct LocalRest::Sums {
    Complex f, up, down, up2, down2;
    Complex h, up_h, up2_h; ///< up/c and its derivatives, finite for c = 0
    Complex down3, up3_h;   ///< where third derivatives are needed

    Jet real(double c) const {
        const double cc = c * c, both = 2.0 * cc * f.real();
        const Complex up3 = c * up2_h, sum3 = up3 + down3, less3 = up3 - down3;
        return {f.real(),
                0.5 * (up + down).real(),
                0.5 * (up - down).imag(),
                0.25 * ((up2 + down2).real() + both),
                0.25 * (up2 - down2).imag(),
                0.25 * (both - (up2 + down2).real()),
                0.125 * (sum3 + 3.0 * cc * (up + down)).real(),
                0.125 * (less3 + cc * (up - down)).imag(),
                0.125 * (cc * (up + down) - sum3).real(),
                0.125 * (3.0 * cc * (up - down) - less3).imag()};
    }
    /// Re(conj(w) h): the derivative of the psi_m by c.
    Jet by_c_of_basis(double c, double x, double y) const {
        const Complex i(0.0, 1.0), down_h = c * f, down2_h = c * down, both = 2.0 * c * c * h;
        const Complex hx = 0.5 * (up_h + down_h), hy = -0.5 * i * (up_h - down_h),
                      hxx = 0.25 * (up2_h + both + down2_h), hxy = -0.25 * i * (up2_h - down2_h),
                      hyy = 0.25 * (both - up2_h - down2_h);
        const Complex down3_h = c * down2, sum3 = 0.125 * (up3_h + down3_h),
                      less3 = -0.125 * i * (up3_h - down3_h);
        const Complex hxxx = sum3 + 0.75 * c * c * hx, hxxy = less3 + 0.25 * c * c * hy,
                      hxyy = 0.25 * c * c * hx - sum3, hyyy = 0.75 * c * c * hy - less3;
        return times_line(x, 1.0, 0.0,
                          {h.real(), hx.real(), hy.real(), hxx.real(), hxy.real(), hyy.real(), hxxx.real(),
                           hxxy.real(), hxyy.real(), hyyy.real()}) +
               times_line(y, 0.0, 1.0,
                          {h.imag(), hx.imag(), hy.imag(), hxx.imag(), hxy.imag(), hyy.imag(), hxxx.imag(),
                           hxxy.imag(), hxyy.imag(), hyyy.imag()});
    }
};

LocalRest::Sums LocalRest::sums(const Coefficients& a, const Basis& basis, double c, Needed needed) {
    Sums s{};
    const double cc = c * c;
    const auto& psi = basis.psi;
    for (int m = 0; m < terms; ++m) {
        const double n = m;
        s.f += times(a[m], psi[m]);
        s.h += times(a[m], psi[m + 1]) * (0.5 * c / (n + 1.0));
        s.up_h += times(a[m], psi[m + 2]) * (0.25 * c * cc / ((n + 1.0) * (n + 2.0)));
        if (m > 0)
            s.down += 2.0 * n * times(a[m], psi[m - 1]);
        if (m > 1)
            s.down2 += 4.0 * n * (n - 1.0) * times(a[m], psi[m - 2]);
        if (m + 3 < terms + 3)
            s.up2_h += times(a[m], psi[m + 3]) * (0.125 * cc * cc * c / ((n + 1.0) * (n + 2.0) * (n + 3.0)));
    }
    s.down += 0.5 * cc * a[0] * std::conj(psi[1]);
    s.down2 += cc * a[1] * std::conj(psi[1]) + 0.125 * cc * cc * a[0] * std::conj(psi[2]);
    s.up = c * s.h;
    s.up2 = c * s.up_h;
    if (!needed.third)
        return s;

    // Third derivatives: down^3 of the first three psi_m goes on to the conjugate ones.
    for (int m = 0; m < terms; ++m) {
        const double n = m;
        if (m > 2)
            s.down3 += 8.0 * n * (n - 1.0) * (n - 2.0) * times(a[m], psi[m - 3]);
        if (m + 4 < terms + 3)
            s.up3_h += times(a[m], psi[m + 4]) *
                       (cc * cc * cc * c / (16.0 * (n + 1.0) * (n + 2.0) * (n + 3.0) * (n + 4.0)));
    }
    s.down3 += 4.0 * cc * a[2] * std::conj(psi[1]) + 0.25 * cc * cc * a[1] * std::conj(psi[2]) +
               cc * cc * cc / 48.0 * a[0] * std::conj(psi[3]);
    return s;
}

LocalRest::LocalRest(const WaveVector& wave, const PeriodicBox& box, const PeriodicRows& columns,
                     const PeriodicRows& rows)
    : c_(wave), density_(1.0 / box.area()) {
    const double c = wave.c, along = wave.along(), across = wave.across() / c;
    const auto potential = on_circle(box, columns, rows);

    // K0(c r) + ln(c) I0(c r) on the circle, and its derivative by c: what the infinite plane's potential is
    // without exp(-c.r) and ln(c).
    const double z = c * radius, t = 0.25 * z * z, i0 = bessel_ratio(0, t), i1 = 0.5 * z * bessel_ratio(1, t);
    double centre = 0.0, centre_by_c = 0.0;
    if (z <= series_end) {
        const CoreBessel k = core_bessel(Pair{z, z}, Pair{} + std::log(0.5 * z));
        centre = k.k0[0] + std::log(c) * i0;
        centre_by_c = radius * (std::log(c) * i1 - k.kappa1[0] + 0.25 * z * bessel_rest(t));
    } else {
        const Bessel k = scaled_bessel(1.0 / z, std::sqrt(0.5 * std::numbers::pi / z));
        const double decay = std::exp(-z);
        centre = decay * k.k0 + std::log(c) * i0;
        centre_by_c = radius * (std::log(c) * i1 - decay * k.k1) + i0 / c;
    }

    // The smooth rest there.
    std::array<double, samples> v, v_by_c;
    for (int j = 0; j < samples; ++j) {
        const auto [at_x, at_y] = circle()[j];
        const double x = wave.ux * at_x + wave.uy * at_y, y = wave.ux * at_y - wave.uy * at_x,
                     growth = std::exp(c * x);
        const UniformValue p = uniform_value(c, x, y);
        const double whole = growth * (potential[j].g - density_ * p.g);
        v[j] = whole - centre;
        v_by_c[j] =
            growth * (potential[j].by_c - density_ * along * p.by_c + density_ * across * p.by_angle) +
            (wave.wx * at_x + wave.wy * at_y) * whole - along * centre_by_c;
    }
    for (int m = 0; m < terms; ++m) {
        Complex sum = 0.0, sum_by_c = 0.0;
        for (int j = 0; j < samples; ++j) {
            sum += v[j] * transform()[m][j];
            sum_by_c += v_by_c[j] * transform()[m][j];
        }
        const double ratio = bessel_ratio(m, t),
                     ratio_c = along * bessel_ratio(m + 1, t) * 0.5 * z * radius / (m + 1.0);
        a_[m] = sum / ratio;
        a_by_c_[m] = (sum_by_c - a_[m] * ratio_c) / ratio;
    }
}

void LocalRest::add(WaveVectorJets& sum, double x, double y, Needed needed) const {
    const auto [c, ux, uy, wx, wy] = c_;
    const double along = ux * x + uy * y, across = ux * y - uy * x, decay = std::exp(-c * along);
    const WaveVectorJets uniform = uniform_part(c, along, across, needed.third);
    const Basis basis(c, x, y);
    Coefficients a = a_, a_by_c = a_by_c_;
    if (!needed.without_log) {
        a[0] += std::log(c);
        a_by_c[0] += c_.along() / c;
    }
    const Sums s = sums(a, basis, c, needed);
    const Jet f = s.real(c);
    sum.g += times_decay(decay, c * ux, c * uy, f, needed.third) +
             density_ * from_axes(ux, uy, uniform.g, needed.third);
    if (!needed.by_c)
        return;
    const Jet slope = sums(a_by_c, basis, c, needed).real(c) + c_.along() * s.by_c_of_basis(c, x, y) +
                      times_line(-(wx * x + wy * y), -wx, -wy, f);
    sum.by_c += times_decay(decay, c * ux, c * uy, slope, needed.third) +
                density_ * from_axes(ux, uy,
                                     c_.along() * uniform.by_c +
                                         -c_.across() / c * by_angle(along, across, uniform.g),
                                     needed.third);
}

namespace {

constexpr double cutoff = 40.0;

/// Of a function of u = r^2/2 with three derivatives.
Jet radial(double f, double f1, double f2, double f3, double x, double y) {
    return {f,
            x * f1,
            y * f1,
            f1 + x * x * f2,
            x * y * f2,
            f1 + y * y * f2,
            x * (3.0 * f2 + x * x * f3),
            y * (f2 + x * x * f3),
            x * (f2 + y * y * f3),
            y * (3.0 * f2 + y * y * f3)};
}

/// Near the rod, for wave numbers c of 6 over the box and more: the infinite plane's potentials of the images
/// in the rod's own column, exp(-c.r) K0(c r) each. They are at (0, j Y), j != 0, as far as they exceed
/// e^-40; |ux| >= |uy|, so that none lies in the wake of all.
void add_column_images(WaveVectorJets& sum, const WaveVector& c, double period, double x, double y,
                       Needed needed) {
    for (const double side : {-1.0, 1.0})
        for (double j = side;; j += side) {
            const double dy = y - j * period, r = std::hypot(x, dy),
                         exponent = c.c * (r + c.ux * x + c.uy * dy);
            if (exponent > cutoff)
                break;
            const double k = c.c, z = k * r, cx = k * c.ux, cy = k * c.uy, decay = std::exp(-exponent);
            const Bessel b = scaled_bessel(1.0 / z, std::sqrt(std::numbers::pi / (2.0 * z))); // z > 0.5
            const double per_r = 1.0 / r, s = k * per_r, k2 = b.k0 + 2.0 * b.k1 / z, k3 = b.k1 + 4.0 * k2 / z;
            const Jet k0 = radial(b.k0, -s * b.k1, s * s * k2, -s * s * s * k3, x, dy);
            sum.g += times_decay(decay, cx, cy, k0, needed.third);
            if (!needed.by_c)
                continue;
            const Jet rk1 = radial(r * b.k1, -k * b.k0, k * s * b.k1, -k * s * s * k2, x, dy);
            sum.by_c +=
                times_decay(-decay, cx, cy,
                            times_line(c.wx * x + c.wy * dy, c.wx, c.wy, k0) + c.along() * rk1, needed.third);
        }
}

} // namespace

PeriodicPotential::PeriodicPotential(const WaveVector& c, const PeriodicBox& box)
    : c_(c), box_(box), columns_(c, box, near_rod), rows_(c.exchanged(), exchanged(box), near_rod) {
    if (c.c <= LocalRest::largest_c)
        local_.emplace(c, box, columns_, rows_);
}

WaveVectorJets PeriodicPotential::at(double x, double y, Needed needed) const {
    WaveVectorJets sum;
    if (!is_near(x, y)) {
        if (std::abs(x) >= std::abs(y)) {
            columns_.add_all(sum, x < 0.0 ? x + box_.x : x, y, needed);
            return sum;
        }
        rows_.add_all(sum, y < 0.0 ? y + box_.y : y, x, needed);
        return {exchanged(sum.g), needed.by_c ? exchanged(sum.by_c) : Jet{}};
    }
    if (local_) {
        local_->add(sum, x, y, needed);
        return sum;
    }

    // Images are taken along the direction that the rod heads across: wakes do not run along it.
    if (std::abs(c_.ux) >= std::abs(c_.uy)) {
        columns_.add_others(sum, x, y, needed);
        add_column_images(sum, c_, box_.y, x, y, needed);
        return sum;
    }
    rows_.add_others(sum, y, x, needed);
    add_column_images(sum, c_.exchanged(), box_.x, y, x, needed);
    return {exchanged(sum.g), exchanged(sum.by_c)};
}

} // namespace rodwake::elastic
