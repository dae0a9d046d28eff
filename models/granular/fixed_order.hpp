#pragma once
// Products whose bits are the same on every machine. Eigen's of matrices are fused where the processor can
// (arm64, x86 with -mfma), and its order of the sums in those of quaternions depends on the instruction set.
// Its sums over vectors of two or three numbers (dot, norm) have one order on x86-64 and arm64, not fused.

#include "rodwake/core/repeatable_math.hpp"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cmath>

namespace rodwake::granular {

template<int rows, int inner, int columns>
Eigen::Matrix<double, rows, columns> product(const Eigen::Matrix<double, rows, inner>& a,
                                             const Eigen::Matrix<double, inner, columns>& b) {
    Eigen::Matrix<double, rows, columns> c;
    for (int j = 0; j < columns; ++j)
        for (int i = 0; i < rows; ++i) {
            double sum = a(i, 0) * b(0, j);
            for (int k = 1; k < inner; ++k)
                sum += a(i, k) * b(k, j);
            c(i, j) = sum;
        }
    return c;
}

/// The turn by q after that by p.
inline Eigen::Quaterniond product(const Eigen::Quaterniond& q, const Eigen::Quaterniond& p) {
    return {q.w() * p.w() - q.x() * p.x() - q.y() * p.y() - q.z() * p.z(),
            q.w() * p.x() + q.x() * p.w() + q.y() * p.z() - q.z() * p.y(),
            q.w() * p.y() + q.y() * p.w() + q.z() * p.x() - q.x() * p.z(),
            q.w() * p.z() + q.z() * p.w() + q.x() * p.y() - q.y() * p.x()};
}

inline Eigen::Quaterniond normalized(const Eigen::Quaterniond& q) {
    const double size = std::sqrt(q.w() * q.w() + q.x() * q.x() + q.y() * q.y() + q.z() * q.z());
    return {q.w() / size, q.x() / size, q.y() / size, q.z() / size};
}

/// By an angle about a unit vector, rad.
inline Eigen::Quaterniond turn(double angle, const Eigen::Vector3d& about) {
    const auto [s, c] = repeatable::sin_cos(0.5 * angle);
    return {c, s * about.x(), s * about.y(), s * about.z()};
}

/// (cos, sin) of a heading.
inline Eigen::Vector2d direction(double heading) {
    const auto [s, c] = repeatable::sin_cos(heading);
    return {c, s};
}

} // namespace rodwake::granular
