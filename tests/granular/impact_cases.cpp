#include "impact_cases.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

namespace rodwake::granular {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Vector3d vector(RandomStream& random) {
    const double x = random.uniform(-1.0, 1.0), y = random.uniform(-1.0, 1.0);
    return {x, y, random.uniform(-1.0, 1.0)};
}

Matrix3d rotation(RandomStream& random) {
    Eigen::Quaterniond q(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0),
                         random.uniform(-1.0, 1.0));
    return q.normalized().toRotationMatrix();
}

Matrix3d cross_matrix(const Vector3d& c) {
    Matrix3d m;
    m << 0.0, -c.z(), c.y(), c.z(), 0.0, -c.x(), -c.y(), c.x(), 0.0;
    return m;
}

/// Inverse mass at arm c of a body whose axis is the first column of `frame`.
Matrix3d body(double mass, double along, double across, const Matrix3d& frame, const Vector3d& arm) {
    const Matrix3d inertia = frame * Vector3d(along, across, across).asDiagonal() * frame.transpose();
    const Matrix3d c = cross_matrix(arm);
    const Matrix3d k = Matrix3d::Identity() / mass - c * inertia.inverse() * c;
    return 0.5 * (k + k.transpose());
}

/// A uniform cylinder touched at one of its ends or anywhere along it.
Matrix3d rod(RandomStream& random, const Matrix3d& frame) {
    const double mass = random.uniform(0.5, 2.0), half = random.uniform(1.0, 5.0),
                 radius = random.uniform(0.3, 1.0);
    const Vector3d arm = frame.col(0) * random.uniform(-half, half) - Vector3d(0.0, 0.0, radius);
    return body(mass, 0.5 * mass * radius * radius, mass * (half * half / 3.0 + radius * radius / 4.0), frame,
                arm);
}

Surface surface(RandomStream& random) { return {random.log_uniform(0.01, 2.0), random.uniform()}; }

Vector3d approach(RandomStream& random) {
    Vector3d v = vector(random);
    v.z() = -std::abs(v.z());
    return v;
}

Eigen::Vector2d hold(const Matrix3d& k) {
    return k.topLeftCorner<2, 2>().inverse() * k.topRightCorner<2, 1>();
}

ImpactCase near_stick(ImpactCase c, RandomStream& random) {
    c.surface.friction = hold(c.inverse_mass).norm() *
                         (1.0 + random.log_uniform(1e-12, 1e-1) * (random.uniform() < 0.5 ? -1.0 : 1.0));
    return c;
}

/// mu K_tn.s > K_nn for the slip at the start, or later on: friction presses the bodies together.
ImpactCase jam(ImpactCase c, RandomStream& random) {
    Eigen::Vector2d q = c.inverse_mass.topRightCorner<2, 1>();
    c.surface.friction = c.inverse_mass(2, 2) / q.norm() * random.uniform(1.01, 3.0);
    if (random.uniform() < 0.5)
        return c;
    c.velocity.head<2>() = random.log_uniform(1e-2, 1e2) * (q + 0.3 * q.norm() * vector(random).head<2>());
    return c;
}

ImpactCase opposed(ImpactCase c, RandomStream& random) {
    const Eigen::Vector2d q = hold(c.inverse_mass);
    c.velocity.head<2>() = -random.uniform(0.01, 1.0) * q;
    c.velocity.head<2>() += random.log_uniform(1e-16, 1e-3) * vector(random).head<2>() * q.norm();
    c.surface.friction = 0.3 * q.norm() * random.uniform();
    return c;
}

ImpactCase rescaled(ImpactCase c, RandomStream& random) {
    c.inverse_mass *= random.log_uniform(1e-12, 1e12);
    c.velocity *= random.log_uniform(1e-12, 1e12);
    return c;
}

} // namespace

ImpactCase sphere_case(RandomStream& random) {
    const double mass = random.log_uniform(0.1, 10.0), radius = random.uniform(0.5, 2.0);
    const double inertia = 0.4 * mass * radius * radius;
    return {body(mass, inertia, inertia, Matrix3d::Identity(), Vector3d(0.0, 0.0, -radius)), approach(random),
            surface(random)};
}

ImpactCase planar_case(RandomStream& random) {
    const double tilt = random.uniform(-1.5, 1.5);
    const Matrix3d frame = Eigen::AngleAxisd(tilt, Vector3d::UnitY()).toRotationMatrix();
    ImpactCase c{rod(random, frame), approach(random), surface(random)};
    c.inverse_mass(0, 1) = c.inverse_mass(1, 0) = c.inverse_mass(1, 2) = c.inverse_mass(2, 1) = 0.0;
    c.velocity.y() = 0.0;
    return c;
}

ImpactCase rod_case(RandomStream& random) {
    Matrix3d k = rod(random, rotation(random));
    if (random.uniform() < 0.5)
        k += rod(random, rotation(random));
    else if (random.uniform() < 0.5)
        k += sphere_case(random).inverse_mass;
    return {k, approach(random), surface(random)};
}

ImpactCase general_case(RandomStream& random, double condition) {
    const Matrix3d turn = rotation(random);
    const Vector3d axes(1.0, random.log_uniform(1.0 / condition, 1.0),
                        random.log_uniform(1.0 / condition, 1.0));
    const Matrix3d k = turn * axes.asDiagonal() * turn.transpose();
    return {0.5 * (k + k.transpose()), approach(random), surface(random)};
}

ImpactCase hard_case(RandomStream& random, int kind) {
    ImpactCase c = random.uniform() < 0.5 ? rod_case(random) : general_case(random, 30.0);
    switch (kind) {
    case 0:
        return near_stick(c, random);
    case 1:
        return jam(general_case(random, 1e3), random);
    case 2:
        c.surface.friction = random.log_uniform(1e-12, 1e-3);
        return c;
    case 3:
        c.surface.friction = random.log_uniform(2.0, 1e3);
        return c;
    case 4:
        c.surface.restitution = random.uniform() < 0.5 ? 0.0 : random.log_uniform(1e-9, 1e-2);
        return c;
    case 5:
        c.surface.restitution = 1.0;
        return c;
    case 6:
        return general_case(random, 1e6);
    case 7:
        return opposed(c, random);
    case 8:
        c.velocity.x() = c.velocity.y() = 0.0;
        return c;
    case 9:
        c.velocity.z() *= random.log_uniform(1e-12, 1e-2);
        return c;
    case 10:
        c.velocity.head<2>() *= random.log_uniform(1e-20, 1e-2);
        return c;
    default:
        return rescaled(c, random);
    }
}

} // namespace rodwake::granular
