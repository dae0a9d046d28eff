#pragma once
// Initial-value problems with additive noise,
//
//   dY = f(Y) dt + dV,   V_i = s_i W_i with independent Brownian motions W_i and constant s_i,
//
// one step at a time: who calls chooses the steps, and may halve them on one path.
//
// A step of length h takes of each component of V its increment w and the integral z of V(t + s) - V(t) over
// s in [0, h], and goes from y to
//
//   k1 = f(y)                                   k3 = f(y + h k2/2 + 3 z/(2 h) - w/2)
//   k2 = f(y + h k1/2 + 3 z/(2 h))              k4 = f(y + h k3 + w)
//   y + h (k1 + 2 k2 + 2 k3 + k4)/6 + w
//
// Without noise this is the classical Runge-Kutta method of order 4. With b the weights of the stages and
// beta_i z/h + delta_i w what stage i takes of the noise, sum b beta = 1 and sum b delta = 0 give f' z to the
// letter, and sum b (beta^2/3 + beta delta + delta^2) = 1/2 the mean of f'' s^2/2 over a step (conditions of
// Roessler, SIAM J. Numer. Anal. 48, 922 (2010), for additive noise): strong order 1.5, weak order 2,
// measured in tests/integrate/test_additive_noise.cpp. Where s is small the error is that of order 4, and s
// times order 2 (Milstein and Tretyakov, SIAM J. Sci. Comput. 18, 1067 (1997)).

#include "rodwake/integrate/ode.hpp"

#include <array>
#include <cstdint>
#include <utility>

namespace rodwake::integrate {

/// Two independent standard normals from 128 random bits (Box and Muller).
using Normals = std::array<double, 2>;
Normals normals_of(const std::array<std::uint32_t, 4>& bits);
/// Uniform in (0, 1) from 64 random bits, 52 of which count.
double uniform_of(std::uint32_t low, std::uint32_t high);

/// What a path does in a step of length h from t: w = V(t + h) - V(t), z = integral of V(s) - V(t). With
/// strength s Gaussian of mean 0, variances s^2 h and s^2 h^3/3, covariance s^2 h^2/2.
struct PathIncrement {
    double w = 0.0, z = 0.0;
};
PathIncrement draw_increment(double length, double strength, const Normals& normals);

/// The two halves of an increment that is known, drawn from their law given the whole. They add up to it but
/// for rounding: w = w1 + w2, z = z1 + z2 + (h/2) w1. So steps of any length follow one path.
std::pair<PathIncrement, PathIncrement> halves(const PathIncrement& whole, double length, double strength,
                                               const Normals& normals);

/// The step above; keeps its memory from one to the next.
class AdditiveNoiseStep {
public:
    using Rates = std::function<void(State y, std::span<double> ydot)>;

    AdditiveNoiseStep(Rates rates, std::size_t size);

    /// From y, where k1 = f(y), by a step of length h with an increment for each component; y holds the new
    /// state after.
    void take(std::span<double> y, State k1, double h, std::span<const PathIncrement> noise);

private:
    Rates rates_;
    std::vector<double> stage_, k2_, k3_, k4_;
};

} // namespace rodwake::integrate
