#pragma once
// One rod between impacts and in an impact.
//
// Free motion is exact: the centre of mass on its parabola; an axisymmetric body turns about its fixed
// angular momentum L by |L| t/I_t while it spins about its axis by L_a (1/I_a - 1/I_t) t. Held rods (imposed
// speed) have infinite mass in the plane and cannot yaw: they pitch about the horizontal b across their
// heading and roll about their axis.

#include "rodwake/granular/problem.hpp"
#include "rodwake/granular/state.hpp"

namespace rodwake::granular {

class MovingRod {
public:
    MovingRod(const RodSpec& spec, const RodBody& body);

    const Clump& clump() const { return clump_; }
    const RodBody& body() const { return body_; }
    const Eigen::Vector3d& axis() const { return axis_; }
    bool held() const { return held_.has_value(); }
    const Eigen::Vector2d& ahead() const { return ahead_; }

    Eigen::Vector3d centre(std::size_t sphere) const {
        return body_.position + clump_.offset[sphere] * axis_;
    }
    /// Spheres that can be the first to touch a plane: the corners of the hull of the row, thick end first.
    const std::vector<std::size_t>& outline() const { return outline_; }
    /// Angular velocity with which the axis turns until the next impulse, rad/s; rolling left out.
    Eigen::Vector3d axis_turning() const;
    /// Of the material point at `arm` from the centre of mass.
    Eigen::Vector3d velocity_at(const Eigen::Vector3d& arm) const {
        return body_.velocity + spin_.cross(arm);
    }
    /// Symmetric inverse mass of that point: dv = K dP.
    Eigen::Matrix3d inverse_mass_at(const Eigen::Vector3d& arm) const;

    /// Holds the rod at this speed along the heading of its specification, or lets it go. Holding again
    /// changes no bit.
    void hold(std::optional<double> speed);
    void move(double time, double gravity);
    void shift(const Eigen::Vector3d& way) { body_.position += way; }
    void push(const Eigen::Vector3d& impulse, const Eigen::Vector3d& arm);
    /// The rod loses all motion but the imposed speed of a held one.
    void stop();

    /// Kinetic and potential (above z = 0), J.
    double energy(double gravity) const;

private:
    /// By `turned` in the world, and about its own axis.
    void turn_by(const Eigen::Quaterniond& turned, double roll);
    void update(); ///< axis, inverse inertia and spin from the body

    Clump clump_;
    std::vector<std::size_t> outline_;
    RodBody body_;
    std::optional<double> held_;
    Eigen::Vector2d ahead_;       ///< held heading
    Eigen::Vector3d across_;      ///< horizontal, across it
    Eigen::Vector3d axis_, spin_; ///< world
    Eigen::Matrix3d inverse_inertia_, inverse_mass_;
};

} // namespace rodwake::granular
