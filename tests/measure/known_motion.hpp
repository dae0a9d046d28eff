#pragma once
// Beads whose memory kernel is known, moved by exact steps of their linear equations.

#include "rodwake/measure/microrheology.hpp"
#include "synthetic.hpp"

#include <Eigen/Dense>

#include <cmath>

namespace rodwake::measure::synthetic {

/// A bead of mass m with drag m `drag` that is held by a spring k. The other end of the spring is fixed, or
/// it is a ghost bead without mass whose drag k `relaxation` lets go of the force within that time: a Maxwell
/// element. Each coordinate has the state (x, v, x - x of the spring's other end).
struct KnownMotion {
    static constexpr double mass = 7.2e-7, temperature = 9e-6; ///< kg; T_xy, m^2/s^2
    double drag = 0.0, spring = 0.0;                           ///< 1/s, N/m
    double relaxation = 0.0;                                   ///< s; 0: the other end is fixed

    double kernel(double s) const { return relaxation > 0.0 ? spring * s / (s + 1.0 / relaxation) : spring; }
    double total(double s) const { return mass * s * s + mass * drag * s + kernel(s); }
};

/// Transition matrix and covariance of the noise over some time.
struct ExactStep {
    Eigen::Matrix3d move, noise;

    /// By the series of both over a time so short that it converges at once, then doubled.
    ExactStep(const KnownMotion& m, double time) {
        constexpr int doublings = 24, terms = 12;
        const double h = std::ldexp(time, -doublings), T = KnownMotion::mass * KnownMotion::temperature;
        const bool ghost = m.relaxation > 0.0;
        Eigen::Matrix3d rates, kicks = Eigen::Matrix3d::Zero();
        rates << 0.0, 1.0, 0.0, 0.0, -m.drag, -m.spring / KnownMotion::mass, 0.0, 1.0,
            ghost ? -1.0 / m.relaxation : 0.0;
        kicks(1, 1) = 2.0 * m.drag * KnownMotion::temperature;
        kicks(2, 2) = ghost ? 2.0 * T / (m.spring * m.relaxation) : 0.0;
        Eigen::Matrix3d power = Eigen::Matrix3d::Identity(), spread = kicks * h;
        move = power;
        noise = spread;
        for (int n = 1; n <= terms; ++n) {
            power = (rates * power * (h / n)).eval();
            spread = ((rates * spread + spread * rates.transpose()) * (h / (n + 1))).eval();
            move += power;
            noise += spread;
        }
        for (int n = 0; n < doublings; ++n)
            append(*this);
    }
    void append(const ExactStep& next) {
        noise = (next.noise + next.move * noise * next.move.transpose()).eval();
        move = (next.move * move).eval();
    }
    /// A factor of the noise's covariance, which may be singular.
    Eigen::Matrix3d factor() const {
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> parts(noise);
        return parts.eigenvectors() * parts.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
    }
};

/// Standard deviations of velocity and of the spring's length in equilibrium; x starts at the spring's.
inline Eigen::Vector3d equilibrium(const KnownMotion& m, Normal& normal) {
    const double v = std::sqrt(KnownMotion::temperature) * normal();
    const double length = std::sqrt(KnownMotion::mass * KnownMotion::temperature / m.spring) * normal();
    return {length, v, length};
}

/// Mean-square displacement in the plane after 1..count steps, exact.
inline std::vector<double> exact_msd(const KnownMotion& m, double interval, std::size_t count) {
    const ExactStep one(m, interval);
    const double length = KnownMotion::mass * KnownMotion::temperature / m.spring;
    Eigen::Matrix3d start;
    start << length, 0.0, length, 0.0, KnownMotion::temperature, 0.0, length, 0.0, length;
    ExactStep all = one;
    std::vector<double> msd;
    for (std::size_t k = 0; k < count; ++k) {
        const Eigen::Matrix3d moved = all.move - Eigen::Matrix3d::Identity();
        msd.push_back(2.0 * (moved * start * moved.transpose() + all.noise)(0, 0));
        all.append(one);
    }
    return msd;
}

/// One run of such beads about random places.
inline MicrorheologyAccumulator run_of(const KnownMotion& m, std::size_t beads, std::size_t frames,
                                       double interval, std::uint64_t seed) {
    const Layout box = layout(beads);
    const ExactStep step(m, interval);
    const Eigen::Matrix3d factor = step.factor();
    Normal normal(seed);
    std::vector<double> home;
    std::vector<Eigen::Vector3d> state;
    for (std::size_t i = 0; i < 2 * beads; ++i) {
        home.push_back(normal.random.uniform(0.0, i < beads ? box.box.x : box.box.y));
        state.push_back(equilibrium(m, normal));
    }
    MicrorheologyAccumulator accumulator(box, {});
    for (std::size_t k = 0; k < frames; ++k) {
        std::vector<double> place[2], speed[2];
        for (std::size_t i = 0; i < 2 * beads; ++i) {
            place[i / beads].push_back(home[i] + state[i][0]);
            speed[i / beads].push_back(state[i][1]);
        }
        Frame frame = frame_of(box, interval * static_cast<double>(k), place[0], place[1]);
        frame.vx = speed[0];
        frame.vy = speed[1];
        accumulator.add(frame);
        for (Eigen::Vector3d& one : state)
            one = (step.move * one + factor * Eigen::Vector3d(normal(), normal(), normal())).eval();
    }
    return accumulator;
}

} // namespace rodwake::measure::synthetic
