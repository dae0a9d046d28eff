#include "reference_run.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace rodwake::medium::tests {

namespace {

using Number = std::complex<double>;
constexpr Number i{0.0, 1.0};

struct Mode {
    double x, y;
};

/// Poses, then two Cartesian amplitudes of each mode of each rod's field.
using Vector = std::vector<Number>;

class Reference {
public:
    explicit Reference(const MediumProblem& problem)
        : p_(problem), rods_(problem.rods.rods.size()), alpha_(1.0 / problem.rods.medium->xi),
          eta_(problem.rods.medium->eta) {
        const double unit = 2.0 * std::numbers::pi / p_.medium.box;
        const int half = (static_cast<int>(p_.medium.modes) + 1) / 2 - 1;
        for (int m = -half; m <= half; ++m)
            for (int n = -half; n <= half; ++n)
                if (m != 0 || n != 0)
                    modes_.push_back({unit * m, unit * n});
    }

    Vector start() const {
        Vector y;
        for (const rods::Pose& rod : p_.rods.rods)
            y.insert(y.end(), {rod.x, rod.y, rod.heading});
        for (const rods::Pose& rod : p_.rods.rods)
            for (const Mode& q : modes_)
                add_start(q, rod, y);
        if (p_.medium.inertia > 0.0) // rates, -i q.n u
            for (std::size_t rod = 0, at = 3 * rods_; rod < rods_; ++rod)
                for (const Mode& q : modes_)
                    for (int component = 0; component < 2; ++component)
                        y.push_back(-drift(q, p_.rods.rods[rod].heading) * y[at++]);
        return y;
    }

    /// All rates, with inertia.
    Vector waves(const Vector& y) const {
        Vector rate(y.size());
        const std::size_t count = 2 * modes_.size() * rods_;
        for (std::size_t a = 0; a < rods_; ++a) {
            const double heading = y[3 * a + 2].real();
            rate[3 * a] = std::cos(heading);
            rate[3 * a + 1] = std::sin(heading);
            rate[3 * a + 2] = turning(y, a);
            std::size_t at = 3 * rods_ + 2 * modes_.size() * a;
            for (const Mode& q : modes_) {
                const Number f = alpha_ * force(q, y[3 * a].real(), y[3 * a + 1].real());
                const Number along = eta_ * (q.x * y[at] + q.y * y[at + 1]);
                const double q2 = q.x * q.x + q.y * q.y;
                const Number push[] = {f * std::cos(heading) - q2 * y[at] - q.x * along,
                                       f * std::sin(heading) - q2 * y[at + 1] - q.y * along};
                for (const Number& p : push) {
                    rate[at] = y[at + count];
                    rate[at + count] = (p - alpha_ * y[at + count]) / p_.medium.inertia;
                    ++at;
                }
            }
        }
        return rate;
    }

    /// e^(-lambda h) of the amplitudes, in place.
    void decay(Vector& y, double h) const {
        std::size_t at = 3 * rods_;
        for (std::size_t rod = 0; rod < rods_; ++rod)
            for (const Mode& q : modes_) {
                const double q2 = q.x * q.x + q.y * q.y;
                const Number along = (q.x * y[at] + q.y * y[at + 1]) / q2;
                const double slow = std::exp(-q2 / alpha_ * h),
                             fast = std::exp(-(1.0 + eta_) * q2 / alpha_ * h);
                y[at] = slow * (y[at] - q.x * along) + fast * q.x * along;
                y[at + 1] = slow * (y[at + 1] - q.y * along) + fast * q.y * along;
                at += 2;
            }
    }

    /// Rates but for the decay.
    Vector slope(const Vector& y) const {
        Vector rate(y.size());
        for (std::size_t a = 0; a < rods_; ++a) {
            const double heading = y[3 * a + 2].real();
            rate[3 * a] = std::cos(heading);
            rate[3 * a + 1] = std::sin(heading);
            rate[3 * a + 2] = turning(y, a);
            std::size_t at = 3 * rods_ + 2 * modes_.size() * a;
            for (const Mode& q : modes_) {
                const Number f = force(q, y[3 * a].real(), y[3 * a + 1].real());
                rate[at++] = f * std::cos(heading);
                rate[at++] = f * std::sin(heading);
            }
        }
        return rate;
    }

private:
    Number force(const Mode& q, double x, double y) const {
        const double w = p_.medium.force_width, q2 = q.x * q.x + q.y * q.y;
        return std::exp(-0.5 * w * w * q2 - i * (q.x * x + q.y * y)) /
               (alpha_ * p_.medium.box * p_.medium.box);
    }

    static Number drift(const Mode& q, double heading) {
        return i * (q.x * std::cos(heading) + q.y * std::sin(heading));
    }

    void add_start(const Mode& q, const rods::Pose& rod, Vector& y) const {
        const double nx = std::cos(rod.heading), ny = std::sin(rod.heading), q2 = q.x * q.x + q.y * q.y;
        const Number f = p_.medium.start == Start::steady ? force(q, rod.x, rod.y) : 0.0;
        const double along = (q.x * nx + q.y * ny) / q2;
        const Number d = drift(q, rod.heading), wave = p_.medium.inertia / alpha_ * d * d;
        const Number slow = f / (q2 / alpha_ - d + wave), fast = f / ((1.0 + eta_) * q2 / alpha_ - d + wave);
        y.push_back(slow * (nx - q.x * along) + fast * q.x * along);
        y.push_back(slow * (ny - q.y * along) + fast * q.y * along);
    }

    double turning(const Vector& y, std::size_t a) const {
        Number exx, exy, eyy, ax, ay, bx, by;
        for (std::size_t b = 0; b < rods_; ++b) {
            if (b == a && !p_.medium.self_field)
                continue;
            std::size_t at = 3 * rods_ + 2 * modes_.size() * b;
            for (const Mode& q : modes_) {
                const Number phase = std::exp(i * (q.x * y[3 * a].real() + q.y * y[3 * a + 1].real()));
                const Number ux = phase * y[at++], uy = phase * y[at++],
                             divergence = i * (q.x * ux + q.y * uy);
                const double q2 = q.x * q.x + q.y * q.y;
                exx += i * q.x * ux;
                eyy += i * q.y * uy;
                exy += 0.5 * i * (q.x * uy + q.y * ux);
                ax -= q2 * ux;
                ay -= q2 * uy;
                bx += i * q.x * divergence;
                by += i * q.y * divergence;
            }
        }
        const rods::Couplings& c = p_.rods.couplings;
        const double nx = std::cos(y[3 * a + 2].real()), ny = std::sin(y[3 * a + 2].real());
        const double vx =
            c.kappa * (exx.real() * nx + exy.real() * ny) + c.gamma1 * ax.real() + c.gamma2 * bx.real();
        const double vy =
            c.kappa * (exy.real() * nx + eyy.real() * ny) + c.gamma1 * ay.real() + c.gamma2 * by.real();
        return nx * vy - ny * vx;
    }

    const MediumProblem& p_;
    std::size_t rods_;
    double alpha_, eta_;
    std::vector<Mode> modes_;
};

Vector sum(const Vector& y, double h, const Vector& k) {
    Vector result = y;
    for (std::size_t j = 0; j < y.size(); ++j)
        result[j] += h * k[j];
    return result;
}

std::vector<double> poses_of(const MediumProblem& problem, const Vector& y) {
    std::vector<double> poses(3 * problem.rods.rods.size());
    for (std::size_t j = 0; j < poses.size(); ++j)
        poses[j] = y[j].real();
    return poses;
}

} // namespace

std::vector<double> reference_run(const MediumProblem& problem, long steps) {
    const Reference model(problem);
    const double h = problem.rods.t_end / static_cast<double>(steps);
    Vector y = model.start();
    for (long step = 0; step < steps; ++step) {
        Vector k1 = model.slope(y);
        model.decay(y, 0.5 * h); // from here on at the middle
        model.decay(k1, 0.5 * h);
        const Vector k2 = model.slope(sum(y, 0.5 * h, k1));
        Vector k3 = model.slope(sum(y, 0.5 * h, k2));
        Vector last = sum(y, h, k3);
        model.decay(last, 0.5 * h); // and here at the end
        const Vector k4 = model.slope(last);
        y = sum(sum(sum(y, h / 6.0, k1), h / 3.0, k2), h / 3.0, k3);
        model.decay(y, 0.5 * h);
        y = sum(y, h / 6.0, k4);
    }
    return poses_of(problem, y);
}

std::vector<double> reference_waves(const MediumProblem& problem, long steps) {
    const Reference model(problem);
    const double h = problem.rods.t_end / static_cast<double>(steps);
    Vector y = model.start();
    for (long step = 0; step < steps; ++step) {
        const Vector k1 = model.waves(y), k2 = model.waves(sum(y, 0.5 * h, k1)),
                     k3 = model.waves(sum(y, 0.5 * h, k2)), k4 = model.waves(sum(y, h, k3));
        y = sum(sum(sum(sum(y, h / 6.0, k1), h / 3.0, k2), h / 3.0, k3), h / 6.0, k4);
    }
    return poses_of(problem, y);
}

double distance(const std::vector<double>& a, const std::vector<double>& b) {
    double largest = 0.0;
    for (std::size_t j = 0; j < a.size(); ++j)
        largest = std::max(largest, std::abs(a[j] - b[j]));
    return largest;
}

double largest(const std::vector<double>& values) {
    double most = 0.0;
    for (const double value : values)
        most = std::max(most, std::abs(value));
    return most;
}

std::vector<double> crowd(std::size_t rods, double box) {
    std::vector<double> poses;
    for (std::size_t a = 0; a < rods; ++a) {
        const auto k = static_cast<double>(a);
        poses.insert(poses.end(), {0.61803 * box * k, box * k / static_cast<double>(rods), 2.4 * k});
    }
    return poses;
}

} // namespace rodwake::medium::tests
