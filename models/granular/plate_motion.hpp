#pragma once
// Where the plates are: floor z = A cos(2 pi f t), lid the same + gap.

#include "rodwake/granular/problem.hpp"

#include <array>

namespace rodwake::granular {

/// Height of the floor near one instant as a Taylor polynomial in the time before it. Eight terms: at 100
/// steps a period the rest over one step is below 1e-14 A, and that of the velocity below 1e-12 A omega.
class PlatePath {
public:
    explicit PlatePath(const std::array<double, 8>& coefficients) : c_(coefficients) {}

    /// z(t - before) and its time derivatives.
    double position(double before) const {
        double value = 0.0;
        for (std::size_t n = c_.size(); n-- > 0;)
            value = value * before + c_[n];
        return value;
    }
    double velocity(double before) const {
        double value = 0.0;
        for (std::size_t n = c_.size(); n-- > 1;)
            value = value * before + static_cast<double>(n) * c_[n];
        return -value; // the polynomial runs backwards in time
    }
    /// At t itself.
    double position() const { return c_[0]; }
    double velocity() const { return -c_[1]; }
    double acceleration() const { return 2.0 * c_[2]; }

private:
    std::array<double, 8> c_; ///< of before^n
};

class PlateMotion {
public:
    PlateMotion(const Plates& plates, double gravity);

    /// About time t, s.
    PlatePath floor(double time) const;
    double gap() const { return gap_; }

private:
    double amplitude_, omega_, gap_;
};

} // namespace rodwake::granular
