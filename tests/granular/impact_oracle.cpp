#include "impact_oracle.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace rodwake::granular::oracle {

namespace {

using Real = long double;
static_assert(std::numeric_limits<Real>::digits >= 64, "the oracle needs more digits than double has");

/// phi, ln r, p, P_x, P_y, v_z, W.
using Y = std::array<Real, 7>;
enum { phi, log_r, p, px, py, vz, work };

class Path {
public:
    explicit Path(const ImpactCase& c)
        : k_(c.inverse_mass.cast<Real>()), mu_(c.surface.friction), e_(c.surface.restitution) {
        const Eigen::Matrix<Real, 3, 1> v = c.velocity.cast<Real>();
        y_ = {std::atan2(v.y(), v.x()), std::log(std::hypot(v.x(), v.y())), 0, 0, 0, v.z(), 0};
        speed_ = -v.z();
        scale_ = k_.cwiseAbs().sum() * (1 + mu_);
    }

    Eigen::Vector3d run() {
        if (std::isfinite(y_[log_r]))
            slide();
        if (!ended_)
            rest();
        return {double(y_[px]), double(y_[py]), double(y_[p])};
    }

private:
    using Vector = Eigen::Matrix<Real, 3, 1>;

    /// dP/dp while slipping along phi.
    Vector pull(Real angle) const { return {-mu_ * std::cos(angle), -mu_ * std::sin(angle), 1}; }

    Y slope(const Y& y) const {
        const Real c = std::cos(y[phi]), s = std::sin(y[phi]), r = std::exp(y[log_r]);
        const Vector along = pull(y[phi]), a = k_ * along;
        return {c * a.y() - s * a.x(),
                c * a.x() + s * a.y(),
                r,
                r * along.x(),
                r * along.y(),
                r * a.z(),
                r * y[vz]};
    }

    Y midpoint(const Y& y0, Real h, int n) const {
        const Real step = h / n;
        Y before = y0, at = y0, f = slope(y0);
        for (int i = 0; i < 7; ++i)
            at[i] += step * f[i];
        for (int m = 1; m < n; ++m) {
            f = slope(at);
            for (int i = 0; i < 7; ++i)
                before[i] += 2 * step * f[i];
            std::swap(before, at);
        }
        f = slope(at);
        for (int i = 0; i < 7; ++i)
            at[i] = (at[i] + before[i] + step * f[i]) / 2;
        return at;
    }

    /// Extrapolated modified midpoint, order 16; `error` is of angle and ln r, and of p in its scale.
    Y gbs(const Y& y0, Real h, Real& error) const {
        constexpr int rows = 8;
        std::array<Y, rows> t;
        for (int j = 0; j < rows; ++j) {
            Y carried = midpoint(y0, h, 2 * (j + 1));
            for (int k = 1; k <= j; ++k) {
                const Real ratio = Real(j + 1) / Real(j + 1 - k), factor = 1 / (ratio * ratio - 1);
                Y next;
                for (int i = 0; i < 7; ++i)
                    next[i] = carried[i] + (carried[i] - t[k - 1][i]) * factor;
                t[k - 1] = carried;
                carried = next;
            }
            if (j + 1 == rows)
                error = std::abs(carried[phi] - t[j - 1][phi]) + std::abs(carried[log_r] - t[j - 1][log_r]) +
                        scale_ * std::abs(carried[p] - t[j - 1][p]) /
                            std::max({speed_, std::exp(y0[log_r]), scale_ * carried[p]});
            t[j] = carried;
        }
        return t[rows - 1];
    }

    Y jump(Real h) const {
        Real unused;
        return gbs(y_, h, unused);
    }

    /// The fraction of the step h at which `before` ceases to hold.
    template<class Predicate>
    Real bisected(Real h, Predicate before) const {
        Real low = 0, high = h;
        for (int k = 0; k < 130; ++k) {
            const Real middle = (low + high) / 2;
            (before(jump(middle)) ? low : high) = middle;
        }
        return high;
    }

    /// Of the work counted from its minimum.
    Real target() const { return -e_ * e_ * deepest_; }

    /// One accepted step, up to an event in it.
    void take(Real h, const Y& y1) {
        if (y_[vz] < 0 && y1[vz] >= 0) {
            y_ = jump(bisected(h, [](const Y& y) { return y[vz] < 0; }));
            turn();
        } else if (y_[vz] >= 0 && y1[vz] >= 0 && y1[work] >= target()) {
            y_ = jump(bisected(h, [this](const Y& y) { return y[work] < target(); }));
            ended_ = true;
        } else {
            y_ = y1;
        }
    }
    void turn() {
        y_[vz] = 0;
        deepest_ += std::min(y_[work], Real(0));
        y_[work] = std::max(y_[work], Real(0));
        ended_ = y_[work] >= target();
    }

    void slide() {
        Real h = Real(0.1) / scale_, error = 0;
        for (int k = 0; k < 200000 && !ended_; ++k) {
            const Y f = slope(y_);
            if (y_[log_r] < std::log(speed_) - 64) // 1e-28
                return;
            if (std::abs(f[phi]) < 3e-17L * scale_)
                return straight(pull(y_[phi]), std::exp(y_[log_r]));
            const Y y1 = gbs(y_, h, error);
            if (!(error < 1e-16L) || std::abs(y1[phi] - y_[phi]) > 0.2L) {
                h /= 2;
                continue;
            }
            take(h, y1);
            h *= error < 2e-18L ? 1.5L : 1;
        }
        if (!ended_)
            throw std::runtime_error("impact oracle: too many steps");
    }

    /// Closed piece along `force` = dP/dp, until the slip of speed r stops.
    void straight(const Vector& force, Real r) {
        const Vector rate = k_ * force;
        const Real growth = -(rate.x() * force.x() + rate.y() * force.y()) / mu_;
        const Real end = growth < 0 ? -r / growth : std::numeric_limits<Real>::infinity();
        closed(force, rate.z(), end);
    }
    void closed(const Vector& force, Real rate, Real end) {
        Real done = 0;
        if (y_[vz] < 0 && -y_[vz] < rate * end) {
            done = -y_[vz] / rate;
            y_[work] += y_[vz] * done / 2;
            turn();
        }
        if (ended_) {
            end = done;
        } else if (y_[vz] >= 0) {
            const Real missing = target() - y_[work], root = y_[vz] * y_[vz] + 2 * rate * missing;
            const Real more =
                root < 0 ? std::numeric_limits<Real>::infinity() : 2 * missing / (y_[vz] + std::sqrt(root));
            ended_ = done + more <= end;
            end = ended_ ? done + more : end;
        }
        y_[work] += (y_[vz] + rate * (end - done) / 2) * (end - done);
        y_[vz] += rate * (end - done);
        y_[p] += end, y_[px] += force.x() * end, y_[py] += force.y() * end;
    }

    /// (shift + factor K_tt)^-1 K_tn.
    Eigen::Matrix<Real, 2, 1> solved(Real shift, Real factor) const {
        const Real a = shift + factor * k_(0, 0), b = factor * k_(0, 1), c = shift + factor * k_(1, 1);
        return Eigen::Matrix<Real, 2, 1>(c * k_(0, 2) - b * k_(1, 2), a * k_(1, 2) - b * k_(0, 2)) /
               (a * c - b * b);
    }

    void rest() {
        Eigen::Matrix<Real, 2, 1> hold = solved(0, 1);
        if (hold.norm() > mu_) {
            Real low = 0, high = std::hypot(k_(0, 2), k_(1, 2));
            for (int k = 0; k < 200; ++k) {
                const Real middle = (low + high) / 2;
                (solved(middle, mu_).norm() > 1 ? low : high) = middle;
            }
            hold = mu_ * solved(high, mu_).normalized();
        }
        const Vector force(-hold.x(), -hold.y(), 1);
        closed(force, (k_ * force).z(), std::numeric_limits<Real>::infinity());
    }

    Eigen::Matrix<Real, 3, 3> k_;
    Real mu_, e_, speed_, scale_, deepest_ = 0;
    Y y_;
    bool ended_ = false;
};

} // namespace

Eigen::Vector3d impulse(const ImpactCase& c) { return Path(c).run(); }

double relative_error(const Eigen::Vector3d& impulse, const Eigen::Vector3d& wanted) {
    return (impulse - wanted).stableNorm() / wanted.stableNorm();
}

} // namespace rodwake::granular::oracle
