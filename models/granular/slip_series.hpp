#pragma once
// One step of several curved slip paths side by side, each as a Taylor series. With dp = r dtau a path is
// free of the singularity at r = 0 and, in v_t = r s, almost linear (contact terms of slip.hpp):
//
//   dv_t/dtau = r q - mu A v_t,   r^2 = v_t.v_t,   dp/dtau = r,   dP_t/dtau = -mu v_t,
//   dv_z/dtau = r - mu q.v_t,     dW/dtau = r v_z
//
// so one Cauchy product an order gives all of v_t, r, p, P_t and v_z, and one more gives W. Coefficients are
// in u = tau/(length of the step), 0 <= u <= 1, and in units of the speed at its start. The sums of a path
// are chains, whose order its bits fix: a processor has time for several of them at once.

#include "kernels.hpp"
#include "rodwake/core/repeatable_math.hpp"
#include "slip.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

namespace rodwake::granular::slip {

inline constexpr int order = 20,
                     work_order = 30; // of W: a product of two series of exponential kind falls off later

inline constexpr auto reciprocals = [] {
    std::array<double, work_order + 1> one_over{};
    for (int k = 1; k <= work_order; ++k)
        one_over[k] = 1.0 / k;
    return one_over;
}();

template<class Number>
struct ValueAndSlope {
    Number value, slope;
};

template<class Number, std::size_t size>
Number value(const std::array<Number, size>& c, const Number& u) {
    Number sum = c[size - 1];
    for (std::size_t k = size - 1; k-- > 0;)
        sum = sum * u + c[k];
    return sum;
}

template<class Number, std::size_t size>
ValueAndSlope<Number> value_and_slope(const std::array<Number, size>& c, const Number& u) {
    Number sum = c[size - 1], slope = Number::Zero();
    for (std::size_t k = size - 1; k-- > 0;) {
        slope = slope * u + sum;
        sum = sum * u + c[k];
    }
    return {sum, slope};
}

/// Roots of functions in brackets: Newton, bisection where Newton leaves the bracket. f(low) and f(high) have
/// opposite signs, f(high) > 0 if `rising`; accurate to the rounding of f. The bracket shrinks with every
/// evaluation, and 200 of them halve it below the last bit. Only the lanes that are `sought` mean anything.
template<class Number, class Lanes, class Function>
Number bracketed_roots(Function f, Number low, Number high, const Number& guess, const Lanes& rising,
                       Lanes sought) {
    Number x = (guess > low && guess < high).select(guess, 0.5 * (low + high));
    for (int k = 0; k < 200 && sought.any(); ++k) {
        const ValueAndSlope<Number> at = f(x);
        for (Eigen::Index lane = 0; lane < x.size(); ++lane) {
            if (!sought[lane])
                continue;
            ((at.value[lane] < 0.0) == rising[lane] ? low : high)[lane] = x[lane];
            double next = x[lane] - at.value[lane] / at.slope[lane];
            if (!(next >= low[lane] && next <= high[lane]))
                next = 0.5 * (low[lane] + high[lane]);
            sought[lane] =
                !(std::abs(next - x[lane]) <= 2.0 * std::numeric_limits<double>::epsilon() * std::abs(next));
            x[lane] = next;
        }
    }
    return x;
}

/// Less than the binary logarithm by up to 0.09: a straight line from one power of two to the next.
inline double rough_log2(double x) {
    return 0x1p-52 * static_cast<double>(std::bit_cast<std::int64_t>(x)) - 1023.0;
}

/// A path on its way.
struct SlipPath {
    const ContactTerms* contact;
    ImpactProgress* at;
};

template<int lanes>
class SlipSeries {
    using Number = Eigen::Array<double, lanes, 1>;
    using Lanes = Eigen::Array<bool, lanes, 1>;
    using Coefficients = std::array<Number, order + 1>;

public:
    explicit SlipSeries(const std::array<SlipPath, lanes>& paths) : paths_(paths) {
        expand();
        const Number length = step_length();
        Number power = length;
        for (int k = 1; k <= order; ++k, power *= length)
            x_[k] *= power, y_[k] *= power, r_[k] *= power;
        impulse_ = of_each([](const SlipPath& path) { return path.at->speed; }) * length /
                   of_each([](const SlipPath& path) { return path.contact->scale; });
        integrate_normal();
        integrate_work();
    }

    /// To the first event of each path, or the end of its step.
    void take() {
        if constexpr (lanes == 1) {
            std::array<double, 6> u{};
            const int count = cuts(u);
            for (int k = 1; k < count && !turned_[0] && !ended_[0]; ++k)
                find_stop(Number::Constant(u[k - 1]), Number::Constant(u[k]));
        } else
            find_stop(Number::Zero(), Number::Ones());
        advance();
    }

    /// Whether v_z can fall: only where friction can pull the bodies together.
    static bool can_fall(const ContactTerms& contact) {
        return !((contact.friction * contact.coupling).squaredNorm() < 1.0);
    }

private:
    template<class F>
    Number of_each(const F& f) const {
        Number all;
        for (int lane = 0; lane < lanes; ++lane)
            all[lane] = f(paths_[lane]);
        return all;
    }

    /// In tau' = scale tau, so that no power over- or underflows.
    void expand() {
        const auto drag = [&](int i, int j) {
            return of_each([=](const SlipPath& path) {
                return 1.0 / path.contact->scale * path.contact->friction * path.contact->tangential(i, j);
            });
        };
        const auto pull = [&](int i) {
            return of_each(
                [=](const SlipPath& path) { return 1.0 / path.contact->scale * path.contact->coupling[i]; });
        };
        const Number qx = pull(0), qy = pull(1), dxx = drag(0, 0), dxy = drag(0, 1), dyy = drag(1, 1);
        x_[0] = of_each([](const SlipPath& path) { return path.at->direction.x(); });
        y_[0] = of_each([](const SlipPath& path) { return path.at->direction.y(); });
        r_[0] = Number::Ones();
        for (int k = 1; k <= order; ++k) {
            const Number x = x_[k - 1], y = y_[k - 1], r = r_[k - 1];
            x_[k] = (qx * r - (dxx * x + dxy * y)) * reciprocals[k];
            y_[k] = (qy * r - (dxy * x + dyy * y)) * reciprocals[k];
            // products of two inner coefficients, each pair once
            Number xx = Number::Zero(), yy = xx, rr = xx;
            for (int i = 1, j = k - 1; i < j; ++i, --j)
                xx += x_[i] * x_[j], yy += y_[i] * y_[j], rr += r_[i] * r_[j];
            if (const int m = k / 2; k % 2 == 0)
                xx += 0.5 * x_[m] * x_[m], yy += 0.5 * y_[m] * y_[m], rr += 0.5 * r_[m] * r_[m];
            r_[k] = x_[0] * x_[k] + y_[0] * y_[k] + (xx + yy - rr);
        }
    }

    /// So long, or up to 0.5 % less, that the last terms are below rounding or, of slow slip, below the
    /// contact's tolerance.
    Number step_length() const {
        Number length;
        for (int lane = 0; lane < lanes; ++lane) {
            const double remainder =
                std::clamp(0.01 * paths_[lane].contact->tolerance / paths_[lane].at->speed, 1e-17, 1e-3);
            const auto limit = [&](int k) {
                const double size =
                    std::max({std::abs(x_[k][lane]), std::abs(y_[k][lane]), std::abs(r_[k][lane]), 1e-280});
                return rough_log2(remainder / size) / k;
            };
            length[lane] = repeatable::exp(std::numbers::ln2 * std::min(limit(order), limit(order - 1)));
        }
        return length;
    }

    void integrate_normal() {
        const auto pull = [&](int i) {
            return of_each(
                [=](const SlipPath& path) { return path.contact->friction * path.contact->coupling[i]; });
        };
        const Number qx = pull(0), qy = pull(1);
        v_[0] = of_each([](const SlipPath& path) { return path.at->normal.velocity; });
        for (int k = 1; k <= order; ++k)
            v_[k] = impulse_ * (r_[k - 1] - (qx * x_[k - 1] + qy * y_[k - 1])) * reciprocals[k];
    }

    /// Without restitution an impact ends where v_z rises through 0, and nobody asks for its work.
    void integrate_work() {
        w_.fill(Number::Zero());
        for (int lane = 0; lane < lanes; ++lane) {
            if (paths_[lane].contact->restitution == 0.0)
                continue;
            // This multiplies the series r and v_z; zeros on both sides of v_z stand for terms that it does
            // not have.
            std::array<double, order + 1> r{};
            std::array<double, order + product_lanes> v{};
            std::array<double, product_lanes> product;
            for (int k = 0; k <= order; ++k)
                r[k] = r_[k][lane];
            for (int k = 0; k <= order; ++k)
                v[order + k] = v_[k][lane];
            series_product(r.data(), order, v.data() + order, product.data());
            for (int k = 1; k <= work_order; ++k)
                w_[k][lane] = impulse_[lane] * product[k - 1] * reciprocals[k];
        }
    }

    /// 0, 1, and what lies between of the extrema of v_z. dv_z/dp = 1 - mu q.s is monotone between the
    /// directions with q.t = 0.
    int cuts(std::array<double, 6>& u) const {
        u[0] = 0.0, u[1] = 1.0;
        const ContactTerms& contact = *paths_[0].contact;
        if (!can_fall(contact))
            return 2;
        const Eigen::Vector2d q = contact.friction * contact.coupling;
        const auto across = [&](const Number& at) {
            const auto x = value_and_slope(x_, at), y = value_and_slope(y_, at);
            return ValueAndSlope<Number>{q.y() * x.value - q.x() * y.value,
                                         q.y() * x.slope - q.x() * y.slope};
        };
        const auto rate = [&](const Number& at) {
            const auto x = value_and_slope(x_, at), y = value_and_slope(y_, at), r = value_and_slope(r_, at);
            return ValueAndSlope<Number>{r.value - q.x() * x.value - q.y() * y.value,
                                         r.slope - q.x() * x.slope - q.y() * y.slope};
        };
        return cut_at_roots(rate, u, cut_at_roots(across, u, 2));
    }

    /// Inserts the sign changes of f between neighbouring cuts, which must be at most one each.
    template<class Function>
    static int cut_at_roots(Function f, std::array<double, 6>& u, int count) {
        std::array<double, 6> cut{u[0]};
        int found = 1;
        for (int k = 1; k < count; ++k) {
            const Number from = Number::Constant(u[k - 1]), to = Number::Constant(u[k]);
            const double low = f(from).value[0], high = f(to).value[0];
            if (low * high < 0.0 && found + (count - k) < 6)
                cut[found++] =
                    bracketed_roots(f, from, to, Number::Constant(-1.0).eval(),
                                    Lanes::Constant(high > 0.0).eval(), Lanes::Constant(true).eval())[0];
            cut[found++] = u[k];
        }
        u = cut;
        return found;
    }

    /// v_z is monotone between low and high, so v_z and W - wanted have at most one root each there.
    void find_stop(const Number& low, const Number& high) {
        const Number before = (low == 0.0).all() ? v_[0] : value(v_, low), after = value(v_, high);
        const Lanes falls = before < 0.0, rises = !falls && after < 0.0; // compression, and anew
        const Lanes turns = falls && !(after < 0.0), crosses = turns || rises;
        Number last = high;
        if (crosses.any()) {
            const Number guess = turns.select(-v_[0] / v_[1], Number::Constant(-1.0));
            const auto velocity = [this](const Number& u) { return value_and_slope(v_, u); };
            last = crosses.select(bracketed_roots(velocity, low, high, guess, turns, crosses), high);
        }
        u_ = turns.select(last, u_);
        turned_ = turned_ || turns;
        if (falls.all())
            return;
        const Number wanted =
            of_each([](const SlipPath& path) { return path.at->normal.wanted(path.contact->restitution); });
        const Lanes ends = !falls && !(value(w_, last) < wanted);
        if (!ends.any())
            return;
        // Taking dv_z/dp as constant is good where the step is long against what is left.
        const Number square = v_[0] * v_[0] + 2.0 * v_[1] / impulse_ * wanted,
                     guess = 2.0 * wanted / (impulse_ * (v_[0] + square.max(0.0).sqrt()));
        const auto work = [&](const Number& u) {
            const auto w = value_and_slope(w_, u);
            return ValueAndSlope<Number>{w.value - wanted, w.slope};
        };
        u_ = ends.select(bracketed_roots(work, low, last, guess, Lanes::Constant(true).eval(), ends), u_);
        ended_ = ended_ || ends;
    }

    /// The states at u.
    void advance() {
        Number x = x_[order], y = y_[order]; // v_t, and integrals of v_t and r
        Number px = Number::Zero(), py = px, p = px;
        for (int k = order; k-- > 0;) {
            px = (px + x_[k] * reciprocals[k + 1]) * u_, py = (py + y_[k] * reciprocals[k + 1]) * u_;
            p = (p + r_[k] * reciprocals[k + 1]) * u_;
            x = x * u_ + x_[k], y = y * u_ + y_[k];
        }
        const Number w = value(w_, u_), v = value(v_, u_);
        for (int lane = 0; lane < lanes; ++lane) {
            const ContactTerms& contact = *paths_[lane].contact;
            ImpactProgress& at = *paths_[lane].at;
            const double r = std::sqrt(x[lane] * x[lane] + y[lane] * y[lane]);
            at.tangential_impulse -= contact.friction * impulse_[lane] * Eigen::Vector2d(px[lane], py[lane]);
            at.normal_impulse += impulse_[lane] * p[lane];
            at.normal.regained += w[lane];
            at.normal.velocity = v[lane];
            if (turned_[lane])
                at.normal.turn();
            at.direction = Eigen::Vector2d(x[lane], y[lane]) / r;
            at.speed *= r;
            at.ended = ended_[lane] || (turned_[lane] && at.normal.wanted(contact.restitution) <= 0.0);
        }
    }

    std::array<SlipPath, lanes> paths_;
    Coefficients x_, y_, r_;                ///< v_t and r
    Coefficients v_;                        ///< v_z
    std::array<Number, work_order + 1> w_;  ///< W - W(0)
    Number impulse_;                        ///< p of the step, were r constant
    Number u_ = Number::Ones();             ///< of the first event, or 1
    Lanes turned_ = Lanes::Constant(false); ///< v_z rises through 0 there
    Lanes ended_ = Lanes::Constant(false);  ///< the impact is over there
};

} // namespace rodwake::granular::slip
