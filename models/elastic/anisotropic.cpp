// The modes of an orthotropic medium, and their sums over a grid as products of matrices.

#include "rodwake/elastic/anisotropic.hpp"

#include "rodwake/core/error.hpp"

#include <Eigen/Core>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace rodwake::elastic {

namespace {

using Complex = std::complex<double>;
using Eigen::Index, Eigen::MatrixXd;

constexpr double cutoff = 6.5;    // q w of the last mode
constexpr double finest = 1000.0; // longer side over the least width

/// The two components of a mode, or of what drives it.
struct ModeAmplitude {
    Complex x, y;
};

/// Symmetric, of one q.
struct Stiffness {
    Complex xx, xy, yy;

    ModeAmplitude times(const ModeAmplitude& u) const { return {xx * u.x + xy * u.y, xy * u.x + yy * u.y}; }
    ModeAmplitude solve(const ModeAmplitude& s) const {
        const Complex determinant = xx * yy - xy * xy;
        return {(yy * s.x - xy * s.y) / determinant, (xx * s.y - xy * s.x) / determinant};
    }
};

/// C(q) and the terms of motion; linear in the constants, so that of a unit constant is a derivative.
Stiffness stiffness(const OrthotropicMedium& m, double v, double qx, double qy) {
    const double xx = qx * qx, yy = qy * qy;
    const Complex motion(-m.rho * v * v * xx, -v * qx * (m.zeta + m.eta_s * (xx + yy)));
    return {m.c11 * xx + m.c66 * yy + motion, (m.c12 + m.c66) * qx * qy, m.c66 * xx + m.c22 * yy + motion};
}

ModeAmplitude driving(const RodSource& source, const RodFrame& frame, double qx, double qy) {
    const double half = 0.5 * qx * frame.length, sinc = half == 0.0 ? 1.0 : std::sin(half) / half;
    const double smooth = std::exp(-0.5 * (qx * qx + qy * qy) * frame.width * frame.width);
    const double fourth = qx * qx * (source.h_xxxxx * qx * qx + 6.0 * source.h_xxxyy * qy * qy),
                 along = source.force * sinc - source.q_xxx * qx * qx - source.q_xyy * qy * qy + fourth;
    const double third = source.t_xxxx * qx * qx + 3.0 * source.t_xxyy * qy * qy;
    return {smooth * Complex(along, (third - source.p_xx) * qx),
            Complex(0.0 - 2.0 * smooth * source.q_yxy * qx * qy, -smooth * source.p_yy * qy)};
}

/// cos and sin of q_m x_k, [place][mode].
struct Waves {
    Eigen::VectorXd q;
    MatrixXd cosine, sine;

    Waves(std::span<const double> positions, double side, double width) {
        const double first = 2.0 * std::numbers::pi / side;
        const auto modes = static_cast<Index>(std::ceil(cutoff / (first * width))) + 1;
        q = first * Eigen::VectorXd::LinSpaced(modes, 0.0, static_cast<double>(modes - 1));
        const Eigen::Map<const Eigen::VectorXd> at(positions.data(), static_cast<Index>(positions.size()));
        const MatrixXd phase = at * q.transpose();
        cosine = phase.array().cos();
        sine = phase.array().sin();
    }
};

double weight(Index mode) { return mode == 0 ? 1.0 : 2.0; } // modes of both signs

} // namespace

void validate(const OrthotropicMedium& m, double speed) {
    for (const double value : {m.c11, m.c22, m.c12, m.c66, m.zeta, m.rho, m.eta_s})
        if (!std::isfinite(value))
            throw InputError("c11, c22, c12, c66, zeta, rho and eta_s must be finite numbers");
    if (m.zeta < 0.0 || m.rho < 0.0 || m.eta_s < 0.0)
        throw InputError(
            fmt::format("zeta = {}, rho = {}, eta_s = {}: none may be below 0", m.zeta, m.rho, m.eta_s));
    const double load = m.rho * speed * speed, a = m.c11 - load, d = m.c66 - load, coupling = m.c12 + m.c66;
    if (!(m.c66 > 0.0 && m.c11 > 0.0 && m.c22 > 0.0))
        throw InputError(
            fmt::format("c11 = {}, c22 = {}, c66 = {}: all must be above 0", m.c11, m.c22, m.c66));
    // a d X^2 + (a c22 + c66 d - coupling^2) X Y + c66 c22 Y^2 > 0 for all X, Y >= 0
    const bool positive =
        a > 0.0 && d > 0.0 &&
        a * m.c22 + m.c66 * d - coupling * coupling > -2.0 * std::sqrt(a * d * m.c66 * m.c22);
    if (!positive)
        throw InputError(fmt::format(
            "c11 = {}, c22 = {}, c12 = {}, c66 = {}, rho v^2 = {}: the medium is unstable, or the rod faster "
            "than its waves; the steady field is for rho v^2 < c66, c11 and |c12 + c66| < sqrt(c11 c22) + "
            "c66",
            m.c11, m.c22, m.c12, m.c66, load));
}

struct AnisotropicField::Impl {
    RodFrame frame;
    Waves along, across;
    MatrixXd cosine_sine; ///< [place][cos, then sin]: of the waves along x

    Impl(const RodFrame& f, std::span<const double> x, std::span<const double> y)
        : frame(f), along(x, f.lx, f.width), across(y, f.ly, f.width),
          cosine_sine(along.cosine.rows(), 2 * along.cosine.cols()) {
        cosine_sine << along.cosine, along.sine;
    }

    template<class Solve>
    DisplacementMap sum(Solve solve) const;
};

/// `solve(qx, qy)`: the mode. Re and Im are stacked so that Re[e^{i q_x x} U_x] and -Im[e^{i q_x x} U_y] are
/// single products with cos and sin.
template<class Solve>
DisplacementMap AnisotropicField::Impl::sum(Solve solve) const {
    const Index modes = along.q.size();
    MatrixXd x(2 * modes, across.q.size()), y(2 * modes, across.q.size());
    for (Index n = 0; n < across.q.size(); ++n)
        for (Index m = 0; m < modes; ++m) {
            const ModeAmplitude u = m + n == 0 ? ModeAmplitude{} : solve(along.q[m], across.q[n]);
            const double w = weight(m) * weight(n) / (frame.lx * frame.ly);
            x(m, n) = w * u.x.real();
            x(modes + m, n) = -w * u.x.imag();
            y(m, n) = -w * u.y.imag();
            y(modes + m, n) = -w * u.y.real();
        }
    const MatrixXd ux = (cosine_sine * x) * across.cosine.transpose(),
                   uy = (cosine_sine * y) * across.sine.transpose();
    return {{ux.data(), ux.data() + ux.size()}, {uy.data(), uy.data() + uy.size()}};
}

AnisotropicField::AnisotropicField(const RodFrame& frame, std::span<const double> x,
                                   std::span<const double> y) {
    const auto side = [](double l) { return l > 0.0 && std::isfinite(l); };
    if (!side(frame.lx) || !side(frame.ly))
        throw InputError(
            fmt::format("the sides of the box must be above 0; they are {} and {}", frame.lx, frame.ly));
    if (!std::isfinite(frame.speed))
        throw InputError("the speed of the rod must be a finite number");
    if (!(frame.length >= 0.0 && frame.length < frame.lx))
        throw InputError(
            fmt::format("rod length {}: must be from 0 to the box's side {}", frame.length, frame.lx));
    const double longer = std::max(frame.lx, frame.ly), shorter = std::min(frame.lx, frame.ly);
    if (!(frame.width >= longer / finest && frame.width <= shorter / 4.0))
        throw InputError(fmt::format("width {} of the smoothing: must be from {:g} to {:g} in this box",
                                     frame.width, longer / finest, shorter / 4.0));
    const auto finite = [](double position) { return std::isfinite(position); };
    if (!std::ranges::all_of(x, finite) || !std::ranges::all_of(y, finite))
        throw InputError("positions of a map must be finite numbers");
    impl_ = std::make_shared<const Impl>(frame, x, y);
}

DisplacementMap AnisotropicField::displacement(const OrthotropicMedium& medium,
                                               const RodSource& source) const {
    const RodFrame& frame = impl_->frame;
    validate(medium, frame.speed);
    return impl_->sum([&](double qx, double qy) {
        return stiffness(medium, frame.speed, qx, qy).solve(driving(source, frame, qx, qy));
    });
}

DisplacementMap AnisotropicField::derivative(const OrthotropicMedium& medium, const RodSource& source,
                                             OrthotropicParameter by) const {
    using enum OrthotropicParameter;
    const auto unit = [by](OrthotropicParameter name) { return by == name ? 1.0 : 0.0; };
    if (by <= h_xxxyy) // the field is linear in the source
        return displacement(medium, {unit(force), unit(p_xx), unit(p_yy), unit(q_xxx), unit(q_xyy),
                                     unit(q_yxy), unit(t_xxxx), unit(t_xxyy), unit(h_xxxxx), unit(h_xxxyy)});
    OrthotropicMedium constant{0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
    constant.c11 = unit(c11);
    constant.c22 = unit(c22);
    constant.c12 = unit(c12);
    constant.c66 = unit(c66);
    constant.zeta = unit(zeta);
    constant.rho = unit(rho);
    constant.eta_s = unit(eta_s);
    return derivative(medium, source, constant);
}

DisplacementMap AnisotropicField::derivative(const OrthotropicMedium& medium, const RodSource& source,
                                             const OrthotropicMedium& change) const {
    const RodFrame& frame = impl_->frame;
    validate(medium, frame.speed);
    return impl_->sum([&](double qx, double qy) {
        const Stiffness whole = stiffness(medium, frame.speed, qx, qy);
        const ModeAmplitude u = whole.solve(driving(source, frame, qx, qy)),
                            less = whole.solve(stiffness(change, frame.speed, qx, qy).times(u));
        return ModeAmplitude{-less.x, -less.y};
    });
}

const RodFrame& AnisotropicField::frame() const { return impl_->frame; }

} // namespace rodwake::elastic
