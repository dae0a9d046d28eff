#include "rod_motion.hpp"

#include "fixed_order.hpp"

namespace rodwake::granular {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

} // namespace

MovingRod::MovingRod(const RodSpec& spec, const RodBody& body)
    : clump_(make_clump(spec.shape)), body_(body), ahead_(direction(spec.heading)),
      across_(-ahead_.y(), ahead_.x(), 0.0) {
    // The upper convex hull of (offset, radius); spheres on a straight line between two others are left out.
    for (std::size_t k = 0; k < clump_.radius.size(); ++k) {
        while (outline_.size() > 1) {
            const std::size_t first = outline_[outline_.size() - 2], middle = outline_.back();
            const double along =
                (clump_.offset[middle] - clump_.offset[first]) / (clump_.offset[k] - clump_.offset[first]);
            const double chord = clump_.radius[first] + along * (clump_.radius[k] - clump_.radius[first]);
            if (!(clump_.radius[middle] <= chord + 1e-9 * chord))
                break;
            outline_.pop_back();
        }
        outline_.push_back(k);
    }
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

void MovingRod::move(double time, double gravity) {
    body_.position += body_.velocity * time;
    body_.position.z() -= gravity * time * time / 2.0;
    body_.velocity.z() -= gravity * time;
    Vector3d& L = body_.angular_momentum;
    if (held_) {
        const double roll_rate = spin_.dot(axis_), pitch_rate = spin_.dot(across_);
        turn_by(turn(pitch_rate * time, across_), roll_rate * time);
        L = clump_.axial_inertia * roll_rate * body_.axis() +
            clump_.transverse_inertia * pitch_rate * across_;
    } else if (const double size = L.norm(); size != 0.0) {
        const double roll =
            L.dot(axis_) * (1.0 / clump_.axial_inertia - 1.0 / clump_.transverse_inertia) * time;
        turn_by(turn(size * time / clump_.transverse_inertia, L / size), roll);
    }
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
