#include "bodies.hpp"

#include "fixed_order.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rodwake::granular {

namespace {

/// fourth(i): what stands behind x, y and z.
template<class Fourth>
Rows packed(const std::vector<double>& x, const std::vector<double>& y, const std::vector<double>& z,
            const Fourth& fourth) {
    Rows rows(4 * x.size(), 0.0);
    for (std::size_t i = 0; i < x.size(); ++i) {
        row(rows, i) << x[i], y[i], z[i];
        rows[4 * i + 3] = fourth(i);
    }
    return rows;
}

void unpack(const Rows& rows, std::vector<double>& x, std::vector<double>& y, std::vector<double>& z) {
    for (std::size_t i = 0; i < x.size(); ++i) {
        x[i] = rows[4 * i];
        y[i] = rows[4 * i + 1];
        z[i] = rows[4 * i + 2];
    }
}

/// About the velocity of the centre of mass of all beads; nothing if there is one kind.
std::vector<Temperatures> temperatures_of_kinds(const Bodies& bodies, const Eigen::Array4d& mean) {
    if (bodies.kind.empty())
        return {};
    std::vector<Temperatures> kinds(bodies.kinds);
    std::vector<double> count(kinds.size(), 0.0);
    for (std::size_t i = 0; i < bodies.beads; ++i) {
        const Eigen::Vector3d v = row(bodies.velocity, i) - mean.head<3>().matrix();
        Temperatures& of_kind = kinds[bodies.kind[i]];
        of_kind.xy += (v.x() * v.x() + v.y() * v.y()) / 2.0;
        of_kind.z += v.z() * v.z();
        ++count[bodies.kind[i]];
    }
    for (std::size_t k = 0; k < kinds.size(); ++k) {
        kinds[k].xy /= std::max(count[k], 1.0);
        kinds[k].z /= std::max(count[k], 1.0);
    }
    return kinds;
}

} // namespace

void Bodies::place_rod_spheres() {
    for (std::size_t i = 0; i < rods.size(); ++i)
        place_rod_spheres(i);
}

void Bodies::place_rod_spheres(std::size_t rod) {
    for (std::size_t k = 0; k < rods[rod].clump().radius.size(); ++k)
        row(position, first_sphere[rod] + k) = rods[rod].centre(k);
}

Vector3 Bodies::arm_of(std::size_t sphere) const {
    const std::uint32_t index = rod_of[sphere - beads];
    return rods[index].clump().offset[sphere - first_sphere[index]] * rods[index].axis();
}

Vector3 Bodies::velocity_of(std::size_t sphere) const {
    return is_bead(sphere) ? Vector3(row(velocity, sphere))
                           : rods[rod_of[sphere - beads]].velocity_at(arm_of(sphere));
}

Bodies make_bodies(const GranularProblem& problem, const State& state) {
    Bodies bodies;
    bodies.beads = state.beads.size();
    const Beads& b = state.beads;
    bodies.equal_beads = std::ranges::adjacent_find(b.radius, std::ranges::not_equal_to()) == b.radius.end();
    const double a = bodies.equal_beads && !b.radius.empty() ? b.radius.front() : problem.bead_radius;
    bodies.bead_radius = a;
    bodies.bead_mass = bead_mass(problem, a);
    bodies.bead_inertia = 0.4 * bodies.bead_mass * a * a;
    bodies.radius = b.radius;
    bodies.radius.resize(bodies.beads, a);
    bodies.stores_radii = !b.radius.empty();
    bodies.kind = b.kind;
    bodies.kinds = std::max<std::size_t>(problem.bead_kinds.size(), 1);
    const auto radius = [&](std::size_t i) { return bodies.radius[i]; };
    const auto mass = [&](std::size_t i) { return bead_mass(problem, bodies.radius[i]); };
    bodies.position = packed(b.x, b.y, b.z, radius);
    bodies.velocity = packed(b.vx, b.vy, b.vz, [](std::size_t) { return 0.0; });
    bodies.spin = packed(b.wx, b.wy, b.wz, mass);
    for (std::size_t i = 0; i < state.rods.size(); ++i) {
        const auto index = static_cast<std::uint32_t>(bodies.rods.size());
        bodies.rods.emplace_back(problem.rods[i], state.rods[i]);
        bodies.first_sphere.push_back(bodies.radius.size());
        for (const double sphere : bodies.rods.back().clump().radius) {
            bodies.radius.push_back(sphere);
            bodies.rod_of.push_back(index);
        }
    }
    bodies.position.resize(4 * bodies.spheres(), 0.0);
    for (std::size_t k = bodies.beads; k < bodies.spheres(); ++k)
        bodies.position[4 * k + 3] = bodies.radius[k];
    bodies.place_rod_spheres();
    return bodies;
}

State to_state(const Bodies& bodies, std::int64_t step) {
    State state;
    state.step = step;
    state.beads.resize(bodies.beads);
    Beads& b = state.beads;
    unpack(bodies.position, b.x, b.y, b.z);
    unpack(bodies.velocity, b.vx, b.vy, b.vz);
    unpack(bodies.spin, b.wx, b.wy, b.wz);
    if (bodies.stores_radii)
        b.radius.assign(bodies.radius.begin(),
                        bodies.radius.begin() + static_cast<std::ptrdiff_t>(bodies.beads));
    b.kind = bodies.kind;
    for (const MovingRod& rod : bodies.rods)
        state.rods.push_back(rod.body());
    return state;
}

Agitation agitation_of(const Bodies& bodies) {
    // Whole rows, four numbers at a time: they are looked at every few steps.
    const Eigen::Map<const Eigen::Array4Xd> v(bodies.velocity.data(), 4,
                                              static_cast<Eigen::Index>(bodies.beads));
    // The mean velocity is that of the beads' centre of mass; 0 if there are none.
    Eigen::Array4d mean = Eigen::Array4d::Zero();
    double masses = 0.0;
    for (Eigen::Index i = 0; i < v.cols(); ++i) {
        if (bodies.equal_beads) {
            mean += v.col(i);
            continue;
        }
        const double mass = bodies.mass_of_bead(static_cast<std::size_t>(i));
        mean += mass * v.col(i);
        masses += mass;
    }
    mean /= bodies.equal_beads ? std::max(static_cast<double>(bodies.beads), 1.0) : masses;
    Eigen::Array4d products = Eigen::Array4d::Zero(); // xx, yy, zz, xy
    for (Eigen::Index i = 0; i < v.cols(); ++i) { // two passes: a difference of squares can come out negative
        const Eigen::Array4d apart = v.col(i) - mean;
        products += Eigen::Array4d(apart[0], apart[1], apart[2], apart[0]) *
                    Eigen::Array4d(apart[0], apart[1], apart[2], apart[1]);
    }
    const double count = std::max(static_cast<double>(bodies.beads), 1.0), m = bodies.bead_mass;
    PlaneTensor flux{m * products[0], m * products[3], m * products[1]};
    if (!bodies.equal_beads)
        flux = {};
    for (std::size_t i = 0; i < bodies.beads && !bodies.equal_beads; ++i) {
        const double mass = bodies.mass_of_bead(i), x = bodies.velocity[4 * i] - mean[0],
                     y = bodies.velocity[4 * i + 1] - mean[1];
        flux[0] += mass * x * x;
        flux[1] += mass * x * y;
        flux[2] += mass * y * y;
    }
    for (const MovingRod& rod : bodies.rods) {
        const double x = rod.body().velocity.x() - mean[0], y = rod.body().velocity.y() - mean[1];
        flux[0] += rod.clump().mass * x * x;
        flux[1] += rod.clump().mass * x * y;
        flux[2] += rod.clump().mass * y * y;
    }
    return {{(products[0] + products[1]) / (2.0 * count), products[2] / count},
            flux,
            temperatures_of_kinds(bodies, mean)};
}

Energy total_energy(const Bodies& bodies, double gravity) {
    Energy energy;
    for (std::size_t i = 0; i < bodies.beads; ++i) {
        energy.kinetic += (bodies.mass_of_bead(i) * row(bodies.velocity, i).squaredNorm() +
                           bodies.inertia_of_bead(i) * row(bodies.spin, i).squaredNorm()) /
                          2.0;
        energy.potential += bodies.mass_of_bead(i) * gravity * bodies.position[4 * i + 2];
    }
    for (const MovingRod& rod : bodies.rods) {
        const double potential = rod.clump().mass * gravity * rod.body().position.z();
        energy.kinetic += rod.energy(gravity) - potential;
        energy.potential += potential;
    }
    return energy;
}

Eigen::Matrix3d contact_frame(const Eigen::Vector3d& normal) {
    // any two directions across the normal will do; away from the axis it is nearest to
    const Eigen::Vector3d beside =
        std::abs(normal.x()) < 0.7 ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY();
    Eigen::Matrix3d frame;
    frame.col(2) = normal;
    frame.col(1) = normal.cross(beside).normalized();
    frame.col(0) = frame.col(1).cross(normal);
    return frame;
}

ImpactCase seen_in(const Eigen::Matrix3d& frame, const Eigen::Matrix3d& inverse_mass,
                   const Eigen::Vector3d& relative_velocity, const Surface& surface) {
    const Eigen::Matrix3d inwards = frame.transpose();
    return {product(product(inwards, inverse_mass), frame), product(inwards, relative_velocity), surface};
}

Eigen::Vector3d impulse_along(const Eigen::Vector3d& normal, const Eigen::Matrix3d& inverse_mass,
                              const Eigen::Vector3d& relative_velocity, const Surface& surface) {
    const Eigen::Matrix3d frame = contact_frame(normal);
    const auto& [mass, velocity, acting] = seen_in(frame, inverse_mass, relative_velocity, surface);
    return product(frame, stronge_impact(mass, velocity, acting).impulse);
}

std::optional<Vector3> hold_or_slide(const Eigen::Matrix3d& inverse_mass, const Vector3& relative,
                                     double side, double friction) {
    // K P = -v by Cramer's rule; K is symmetric
    const Vector3 x = inverse_mass.col(0), y = inverse_mass.col(1), z = inverse_mass.col(2);
    const Vector3 stop =
        Vector3(relative.dot(y.cross(z)), relative.dot(z.cross(x)), relative.dot(x.cross(y))) /
        -x.dot(y.cross(z));
    if (stop.head<2>().norm() <= friction * side * stop.z())
        return stop;
    const Eigen::Vector2d slip = relative.head<2>().normalized();
    const Vector3 along(-friction * slip.x(), -friction * slip.y(), side);
    const double gain = side * z.dot(along); // of speed away from the plate, for each unit of the impulse
    const Vector3 impulse = (-side * relative.z() / gain) * along;
    const Vector3 after = relative + product(inverse_mass, impulse);
    if (!(gain > 0.0 && impulse.dot(relative + after) <= 0.0))
        return {};
    return impulse;
}

} // namespace rodwake::granular
