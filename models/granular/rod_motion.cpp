#include "rod_motion.hpp"

#include "fixed_order.hpp"

namespace rodwake::granular {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Upper convex hull of (offset, radius); spheres on a straight line between two others are left out.
std::vector<std::size_t> corners(const Clump& clump) {
    std::vector<std::size_t> hull;
    for (std::size_t k = 0; k < clump.radius.size(); ++k) {
        const auto below = [&](std::size_t first, std::size_t middle) {
            const double along =
                (clump.offset[middle] - clump.offset[first]) / (clump.offset[k] - clump.offset[first]);
            const double chord = clump.radius[first] + along * (clump.radius[k] - clump.radius[first]);
            return clump.radius[middle] <= chord + 1e-9 * chord;
        };
        while (hull.size() > 1 && below(hull[hull.size() - 2], hull.back()))
            hull.pop_back();
        hull.push_back(k);
    }
    return hull;
}

} // namespace

MovingRod::MovingRod(const RodSpec& spec, const RodBody& body)
    : clump_(make_clump(spec.shape)), outline_(corners(clump_)), body_(body), ahead_(direction(spec.heading)),
      across_(-ahead_.y(), ahead_.x(), 0.0) {
    update();
}

void MovingRod::hold(std::optional<double> speed) {
    held_ = speed;
    if (held_)
        body_.velocity.head<2>() = *held_ * ahead_;
    update();
}

void MovingRod::update() {
    axis_ = body_.axis();
    const Matrix3d along = axis_ * axis_.transpose();
    if (held_) {
        inverse_mass_ = Vector3d(0.0, 0.0, 1.0 / clump_.mass).asDiagonal();
        inverse_inertia_ =
            along / clump_.axial_inertia + across_ * across_.transpose() / clump_.transverse_inertia;
    } else {
        inverse_mass_ = Matrix3d::Identity() / clump_.mass;
        inverse_inertia_ =
            along / clump_.axial_inertia + (Matrix3d::Identity() - along) / clump_.transverse_inertia;
    }
    spin_ = product(inverse_inertia_, body_.angular_momentum);
}

Matrix3d MovingRod::inverse_mass_at(const Vector3d& arm) const {
    Matrix3d r;
    r << 0.0, -arm.z(), arm.y(), arm.z(), 0.0, -arm.x(), -arm.y(), arm.x(), 0.0;
    return inverse_mass_ - product(product(r, inverse_inertia_), r);
}

Vector3d MovingRod::axis_turning() const {
    return held_ ? Vector3d(spin_.dot(across_) * across_)
                 : Vector3d(body_.angular_momentum / clump_.transverse_inertia);
}

void MovingRod::turn_by(const Eigen::Quaterniond& turned, double roll) {
    body_.orientation =
        normalized(product(product(turned, body_.orientation), turn(roll, Vector3d::UnitX())));
}

void MovingRod::turn_freely(double time) {
    const Vector3d& L = body_.angular_momentum;
    const double size = L.norm();
    if (size == 0.0)
        return;
    const double roll = L.dot(axis_) * (1.0 / clump_.axial_inertia - 1.0 / clump_.transverse_inertia) * time;
    turn_by(turn(size * time / clump_.transverse_inertia, L / size), roll);
}

void MovingRod::turn_held(double time) {
    const double roll_rate = spin_.dot(axis_), pitch_rate = spin_.dot(across_);
    turn_by(turn(pitch_rate * time, across_), roll_rate * time);
    body_.angular_momentum =
        clump_.axial_inertia * roll_rate * body_.axis() + clump_.transverse_inertia * pitch_rate * across_;
}

void MovingRod::move(double time, double gravity) {
    body_.position += body_.velocity * time;
    body_.position.z() -= gravity * time * time / 2.0;
    body_.velocity.z() -= gravity * time;
    held_ ? turn_held(time) : turn_freely(time);
    update();
}

void MovingRod::push(const Vector3d& impulse, const Vector3d& arm) {
    body_.velocity += product(inverse_mass_, impulse);
    const Vector3d turning = arm.cross(impulse);
    // what the bearings of a held rod do not take
    body_.angular_momentum +=
        held_ ? Vector3d(axis_.dot(turning) * axis_ + across_.dot(turning) * across_) : turning;
    spin_ = product(inverse_inertia_, body_.angular_momentum);
}

void MovingRod::stop() {
    body_.velocity.setZero();
    body_.angular_momentum.setZero();
    hold(held_);
}

double MovingRod::energy(double gravity) const {
    return clump_.mass * (body_.velocity.squaredNorm() / 2.0 + gravity * body_.position.z()) +
           body_.angular_momentum.dot(spin_) / 2.0;
}

} // namespace rodwake::granular
