#include "rodwake/granular/record.hpp"

#include "rodwake/core/encounter.hpp"
#include "rodwake/core/periodic.hpp"
#include "rodwake/granular/observe.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rodwake::granular {

namespace {

Eigen::Vector2d along(double heading) { return {std::cos(heading), std::sin(heading)}; }

void add(PlaneTensor& sum, const PlaneTensor& term) {
    for (std::size_t k = 0; k < sum.size(); ++k)
        sum[k] += term[k];
}

/// Over the steps since the virial was `virial_then`, during which the flux was summed over `samples`.
PlaneTensor pressure_since(const Simulation& simulation, std::int64_t steps, const PlaneTensor& virial_then,
                           const PlaneTensor& flux, std::int64_t samples) {
    const GranularProblem& p = simulation.problem();
    PlaneTensor mean_flux, virial = simulation.tallies().virial;
    for (std::size_t k = 0; k < virial.size(); ++k) {
        virial[k] -= virial_then[k];
        mean_flux[k] = flux[k] / static_cast<double>(std::max<std::int64_t>(samples, 1));
    }
    return pressure(mean_flux, virial, static_cast<double>(steps) * p.time_step, bed_area(p));
}

} // namespace

PlaneTensor pressure(const PlaneTensor& momentum_flux, const PlaneTensor& virial, double time, double area) {
    PlaneTensor p;
    for (std::size_t k = 0; k < p.size(); ++k)
        p[k] = (momentum_flux[k] + (time > 0.0 ? virial[k] / time : 0.0)) / area;
    return p;
}

double neighbour_cutoff(double bead_radius, double phi_b) {
    return 1.4 * 2.0 * bead_radius * std::sqrt(0.9069 / phi_b);
}

bool in_absorbing_state(const Temperatures& T, const GranularProblem& problem) {
    constexpr double still = 3e-5;
    const Plates& plates = problem.plates;
    const double speed = 2.0 * std::numbers::pi * plates.frequency * plates.amplitude(problem.gravity);
    return problem.beads > 1 && T.xy < still * speed * speed;
}

void Record::follow_rods(const Simulation& simulation) {
    for (std::size_t i = 0; i < rods_.size(); ++i) {
        RodProgress& p = rods_[i];
        const RodBody& rod = simulation.rod(i);
        const Eigen::Vector2d ahead = along(p.heading),
                              impulse_on_beads = simulation.tallies().impulse_on_beads[i].head<2>(),
                              from_plates = simulation.tallies().impulse_from_plates[i].head<2>();
        p.travelled += (rod.position.head<2>() - Eigen::Vector2d(p.x, p.y)).dot(ahead);
        p.impulse_on_beads +=
            (impulse_on_beads - Eigen::Map<const Eigen::Vector2d>(p.impulse_on_beads_at.data())).dot(ahead);
        p.impulse_on_beads_at[0] = impulse_on_beads.x();
        p.impulse_on_beads_at[1] = impulse_on_beads.y();
        RodThrust& t = thrust_[i];
        t.impulse += (from_plates - Eigen::Map<const Eigen::Vector2d>(t.impulse_at.data())).dot(ahead);
        Eigen::Map<Eigen::Vector2d>(t.impulse_at.data()) = from_plates;
        p.x = rod.position.x();
        p.y = rod.position.y();
        p.heading = p.heading + std::remainder(rod.heading() - p.heading, 2.0 * std::numbers::pi);
    }
}

void Record::follow_pair(const Simulation& simulation) {
    if (rods_.size() != 2)
        return;
    const RodProgress &a = rods_[0], &b = rods_[1];
    const PeriodicBox& box = simulation.problem().box; // rods may stand beside each other across its edge
    const PairFrame course(a.heading0, b.heading0, nearest_image_rounded(a.x0 - b.x0, box.x),
                           nearest_image_rounded(a.y0 - b.y0, box.y));
    if (!course.common())
        return;
    sums_.pair.change = course.change(a.x - b.x - a.x0 + b.x0, a.y - b.y - a.y0 + b.y0);
    const double advanced = course.ahead(a.x + b.x - a.x0 - b.x0, a.y + b.y - a.y0 - b.y0) / 2.0;
    if (sums_.pair.half_box_time < 0.0 &&
        advanced >= course.side_along(bed_sides(simulation.problem())) / 2.0) {
        sums_.pair.half_box_time = simulation.time();
        sums_.pair.half_box_change = sums_.pair.change;
    }
}

void Record::sample(const Simulation& simulation) {
    if (simulation.step() == simulation.problem().equilibration_steps) { // the means start at t = 0
        sums_.run = {};
        kinds_.clear();
        sums_.psi6 = 0.0;
        sums_.rows = 0;
        pressure_.run_flux = {};
        pressure_.run_virial = simulation.tallies().virial;
        for (std::size_t i = 0; i < rods_.size(); ++i) {
            const RodBody& rod = simulation.rod(i);
            const Eigen::Vector3d &on_beads = simulation.tallies().impulse_on_beads[i],
                                  &from_plates = simulation.tallies().impulse_from_plates[i];
            const double x = rod.position.x(), y = rod.position.y(), heading = rod.heading();
            rods_[i] = {x, y, heading, x, y, heading, 0.0, {on_beads.x(), on_beads.y()}, 0.0, 0.0};
            thrust_[i] = {{from_plates.x(), from_plates.y()}, 0.0};
        }
    }
    const auto [T, flux, of_kinds] = simulation.agitation();
    for (SampleSums* sums : {&sums_.run, &sums_.row}) {
        sums->T_xy += T.xy;
        sums->T_z += T.z;
        ++sums->count;
    }
    kinds_.resize(of_kinds.size());
    for (std::size_t k = 0; k < kinds_.size(); ++k) {
        kinds_[k].T_xy += of_kinds[k].xy;
        kinds_[k].T_z += of_kinds[k].z;
        ++kinds_[k].count;
    }
    add(pressure_.run_flux, flux);
    add(pressure_.row_flux, flux);
    if (simulation.time() > 0.0) {
        follow_rods(simulation);
        follow_pair(simulation);
    }
}

TableRow Record::row(const Simulation& simulation) {
    const Counters& tallies = simulation.tallies();
    const Energy energy = simulation.energy();
    const double samples = static_cast<double>(std::max<std::int64_t>(sums_.row.count, 1));
    const double steps = static_cast<double>(std::max<std::int64_t>(simulation.step() - sums_.row_step, 1));
    TableRow row{};
    row.t = simulation.time();
    row.kinetic = energy.kinetic;
    row.energy = energy.kinetic + energy.potential;
    row.T_xy = sums_.row.T_xy / samples;
    row.T_z = sums_.row.T_z / samples;
    row.psi6 = simulation.psi6(cutoff_);
    row.contacts = static_cast<double>(tallies.overlaps - sums_.overlaps) / steps;
    row.floor_impulse = tallies.floor_impulse;
    row.lid_impulse = tallies.lid_impulse;
    row.max_overlap = tallies.max_overlap;
    const PlaneTensor pressure = pressure_since(simulation, simulation.step() - sums_.row_step,
                                                pressure_.row_virial, pressure_.row_flux, sums_.row.count);
    row.p_xx = pressure[0];
    row.p_xy = pressure[1];
    row.p_yy = pressure[2];
    pressure_.row_flux = {};
    pressure_.row_virial = tallies.virial;
    sums_.row = {};
    sums_.overlaps = tallies.overlaps;
    sums_.row_step = simulation.step();
    if (simulation.time() >= 0.0) {
        sums_.psi6 += row.psi6;
        ++sums_.rows;
    }
    return row;
}

std::vector<TrackPoint> Record::track(const Simulation& simulation) {
    const double interval =
        static_cast<double>(simulation.step() - sums_.row_step) * simulation.problem().time_step;
    std::vector<TrackPoint> points;
    for (std::size_t i = 0; i < rods_.size(); ++i) {
        RodProgress& p = rods_[i];
        const RodBody& rod = simulation.rod(i);
        const bool begun = simulation.time() >= 0.0;
        points.push_back({rod.position.x(), rod.position.y(), rod.position.z(),
                          begun ? p.heading : rod.heading(), std::asin(std::clamp(rod.axis().z(), -1.0, 1.0)),
                          interval > 0.0 ? (p.travelled - p.row_travelled) / interval : 0.0,
                          begun ? p.impulse_on_beads : 0.0});
        p.row_travelled = p.travelled;
    }
    return points;
}

PlaneTensor Record::mean_pressure(const Simulation& simulation) const {
    const std::int64_t steps = simulation.step() - simulation.problem().equilibration_steps;
    return pressure_since(simulation, steps, pressure_.run_virial, pressure_.run_flux, sums_.run.count);
}

double Record::mean_advance() const {
    double sum = 0.0;
    for (const RodProgress& rod : rods_)
        sum += along(rod.heading0).dot(Eigen::Vector2d(rod.x - rod.x0, rod.y - rod.y0));
    return rods_.empty() ? 0.0 : sum / static_cast<double>(rods_.size());
}

void Record::restore(const RecordSums& sums, const PressureSums& pressure, std::vector<RodProgress> rods,
                     std::vector<RodThrust> thrust, std::vector<SampleSums> kinds) {
    sums_ = sums;
    pressure_ = pressure;
    rods_ = std::move(rods);
    thrust_ = std::move(thrust);
    kinds_ = std::move(kinds);
}

} // namespace rodwake::granular
