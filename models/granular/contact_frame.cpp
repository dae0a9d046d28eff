#include "contact_frame.hpp"

#include <Eigen/Geometry>

#include <cmath>

namespace rodwake::granular {

Eigen::Vector3d impulse_along(const Eigen::Vector3d& normal, const Eigen::Matrix3d& inverse_mass,
                              const Eigen::Vector3d& relative_velocity, const Surface& surface) {
    // any two directions across the normal will do; away from the axis it is nearest to
    const Eigen::Vector3d beside =
        std::abs(normal.x()) < 0.7 ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY();
    Eigen::Matrix3d frame; // columns: tangents, normal
    frame.col(2) = normal;
    frame.col(1) = normal.cross(beside).normalized();
    frame.col(0) = frame.col(1).cross(normal);
    const Impact impact = stronge_impact(frame.transpose() * inverse_mass * frame,
                                         frame.transpose() * relative_velocity, surface);
    return frame * impact.impulse;
}

} // namespace rodwake::granular
