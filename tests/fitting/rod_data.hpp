#pragma once
// The reference trajectories as data of a fit.

#include "rods/reference.hpp"

#include "rodwake/fitting/trajectory.hpp"

#include <stdexcept>

namespace rodwake::test {

/// The first whose name begins so.
inline ReferenceCase reference(const std::string& name) {
    for (const ReferenceCase& one : reference_cases())
        if (one.name.starts_with(name))
            return one;
    throw std::runtime_error("no reference trajectory " + name);
}

/// Start and output rows; the contact as a datum, not as a row.
inline fitting::Trajectory trajectory_of(const ReferenceCase& one) {
    fitting::Trajectory data;
    data.name = one.name;
    data.times = {0.0};
    data.states = {rods::to_state(one.problem.rods)};
    data.sigma_position = data.sigma_heading = data.sigma_contact = 1e-3;
    data.contact_distance = one.problem.contact_distance;
    for (const ReferencePoint& point : one.points) {
        if (point.contact) {
            data.contact_time = point.time;
            continue;
        }
        data.times.push_back(point.time);
        data.states.push_back(point.state);
    }
    return data;
}

/// rtol 1e-11.
inline fitting::TrajectoryModel tight(integrate::Method method = integrate::Method::adams) {
    fitting::TrajectoryModel model;
    model.ode.method = method;
    model.ode.rtol = 1e-11;
    model.ode.atol = 1e-12;
    return model;
}

} // namespace rodwake::test
