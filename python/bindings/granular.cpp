// A granular run in the hands of Python: advanced as far as wanted, its state as arrays.

#include "arrays.hpp"
#include "bind.hpp"
#include "callbacks.hpp"
#include "rodwake/app/plan.hpp"
#include "rodwake/granular/simulation.hpp"
#include "rodwake/granular/start.hpp"
#include "signals.hpp"

#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>

namespace rodwake::python {

namespace {

struct Bed {
    const app::BedPlan plan;
    granular::Simulation simulation;
    Bed(const scene::Scene& scene, std::uint32_t run, std::size_t threads)
        : plan(plan_of(scene)), simulation(plan.problem, granular::make_start(plan.problem, run), {},
                                           granular::worthwhile_threads(plan.problem, threads)) {}

    /// Up to so many steps; fewer if the run is over. Looks for Ctrl-C now and then, which changes no bit.
    void advance(std::int64_t steps) {
        Interrupt interrupt(1);
        {
            const py::gil_scoped_release release;
            while (steps > 0 && !simulation.finished() && !simulation.failure() && !interrupt()) {
                const std::int64_t some = std::min<std::int64_t>(steps, 50);
                simulation.advance(some);
                steps -= some;
            }
        }
        interrupt.rethrow();
        if (const auto& failure = simulation.failure())
            throw RunError("step " + std::to_string(failure->step) + ": " + failure->message);
    }

    /// Steps from t = 0 on; negative during the equilibration.
    std::int64_t step() const { return simulation.step() - plan.problem.equilibration_steps; }

private:
    static app::BedPlan plan_of(const scene::Scene& scene) {
        if (!scene.granular)
            throw InputError(scene.path + ": no [granular] table, so there is no bed to simulate");
        constexpr app::Stage stage[] = {app::Stage::granular};
        app::BedPlan made = app::make_plan(scene, stage).beds.at(0);
        if (made.of.scene.granular->start == scene::GranularStart::restart)
            throw InputError(scene.path + ": start = \"restart\" needs the program; Scene.run does it");
        return made;
    }
};

/// Columns x, y, z as rows.
Array vectors(const std::vector<double>& x, const std::vector<double>& y, const std::vector<double>& z) {
    Array rows({static_cast<py::ssize_t>(x.size()), py::ssize_t{3}});
    double* out = rows.mutable_data();
    for (std::size_t i = 0; i < x.size(); ++i, out += 3) {
        out[0] = x[i];
        out[1] = y[i];
        out[2] = z[i];
    }
    return rows;
}

Array rod_poses(const Bed& bed) {
    const std::size_t count = bed.plan.problem.rods.size();
    Array rows({static_cast<py::ssize_t>(count), py::ssize_t{3}});
    double* out = rows.mutable_data();
    for (std::size_t i = 0; i < count; ++i, out += 3) {
        const granular::RodBody& rod = bed.simulation.rod(i);
        out[0] = rod.position.x();
        out[1] = rod.position.y();
        out[2] = rod.heading();
    }
    return rows;
}

py::tuple temperatures(const Bed& bed) {
    const granular::Temperatures T = bed.simulation.temperatures();
    return py::make_tuple(T.xy, T.z);
}

/// (M, 2), m/s^2, at these places (M, 2 or 3) now; none before t = 0.
Array body_acceleration(const Bed& bed, const Array& positions) {
    if (positions.ndim() != 2 || positions.shape(1) < 2)
        throw InputError("places: expected an array of shape (M, 2) or (M, 3): x and y of each, m");
    Array rows({positions.shape(0), py::ssize_t{2}});
    double* out = rows.mutable_data();
    const auto& force = bed.plan.problem.body_force;
    const bool on = force && bed.step() >= 0;
    for (py::ssize_t i = 0; i < positions.shape(0); ++i, out += 2) {
        const double b = on ? force->at(positions.at(i, 0), positions.at(i, 1), bed.simulation.time(),
                                        bed.plan.problem.box)
                            : 0.0;
        out[0] = on ? b * std::cos(force->direction) : 0.0;
        out[1] = on ? b * std::sin(force->direction) : 0.0;
    }
    return rows;
}

Array bead_positions(const Bed& bed) {
    const granular::Beads beads = bed.simulation.state().beads;
    return vectors(beads.x, beads.y, beads.z);
}

} // namespace

void bind_granular(py::module_& module) {
    py::class_<Bed>(module, "Bed")
        .def(py::init<const scene::Scene&, std::uint32_t, std::size_t>())
        .def("advance", &Bed::advance)
        .def_property_readonly("step", &Bed::step)
        .def_property_readonly("steps", [](const Bed& b) { return b.plan.problem.steps; })
        .def_property_readonly("frame_every", [](const Bed& b) { return b.plan.schedule.frame_every; })
        .def_property_readonly("time_step", [](const Bed& b) { return b.plan.problem.time_step; })
        .def_property_readonly("box",
                               [](const Bed& b) {
                                   const PeriodicBox& box = granular::bed_sides(b.plan.problem);
                                   return std::pair(box.x, box.y);
                               })
        .def_property_readonly("bead_radius", [](const Bed& b) { return b.plan.problem.bead_radius; })
        .def_property_readonly("time", [](const Bed& b) { return b.simulation.time(); })
        .def_property_readonly("finished", [](const Bed& b) { return b.simulation.finished(); })
        .def("positions", &bead_positions)
        .def("body_acceleration",
             [](const Bed& b, const std::optional<Array>& positions) {
                 return body_acceleration(b, positions ? *positions : bead_positions(b));
             })
        .def("velocities",
             [](const Bed& b) {
                 const granular::Beads beads = b.simulation.state().beads;
                 return vectors(beads.vx, beads.vy, beads.vz);
             })
        .def("rods", &rod_poses)
        .def("temperatures", &temperatures)
        .def("bond_order", [](const Bed& b) { return b.simulation.psi6(b.plan.schedule.order_cutoff); })
        .def("state_hash", [](const Bed& b) { return granular::state_hash(b.simulation.state()); });

    // The heading follows from stored orientations, so it has the bits that the measures of a bed have.
    module.def("rod_heading", py::vectorize([](double w, double x, double y, double z) {
                   granular::RodBody rod;
                   rod.orientation = {w, x, y, z};
                   return rod.heading();
               }));
}

} // namespace rodwake::python
