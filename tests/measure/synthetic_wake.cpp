#include "synthetic_wake.hpp"

#include "rodwake/core/rng.hpp"

#include "granular/packing.hpp"

#include <cmath>
#include <stdexcept>

namespace measure_test {

namespace {

using rodwake::RandomStream;
using rodwake::elastic::Vector;
using rodwake::measure::Frame;
using rodwake::measure::RodPosition;

Vector gaussian(RandomStream& random, double deviation) {
    const double size = deviation * std::sqrt(-2.0 * std::log(random.uniform()));
    const double angle = 2.0 * M_PI * random.uniform();
    return {size * std::cos(angle), size * std::sin(angle)};
}

double inside(double place, double box) {
    const double wrapped = place - box * std::floor(place / box);
    return wrapped < box ? wrapped : 0.0;
}

std::vector<Eigen::Vector2d> places_of_two_sizes(const WakeSetup& setup) {
    namespace granular = rodwake::granular;
    granular::GranularProblem problem;
    problem.beads = static_cast<std::size_t>(setup.beads);
    problem.bead_radius = 1.0;
    problem.bead_kinds = {{1.0, 0.5}, {1.4, 0.5}};
    problem.box = setup.box;
    problem.plates.gap = 3.9;
    problem.seed = setup.seed;
    const granular::Room room{problem.box, 1.0, problem.plates.gap, {}};
    granular::BeadPositions places = granular::at_random(problem, room, 0);
    if (granular::push_apart(places, room, RandomStream(setup.seed)) > 0.0)
        throw std::runtime_error("the beads do not fit");
    std::vector<Eigen::Vector2d> sites;
    for (std::size_t i = 0; i < places.size(); ++i)
        sites.emplace_back(places.x[i], places.y[i]);
    return sites;
}

constexpr std::size_t waves = 8; // of the noise of a coordinate

} // namespace

SyntheticWake::SyntheticWake(const WakeSetup& setup) : setup_(setup), field_(setup.medium, setup.box) {
    if (setup.two_sizes) {
        sites_ = places_of_two_sizes(setup);
    } else {
        const auto fit = rodwake::granular::fit_lattice(setup.box, setup.beads, setup.lattice_angle);
        sites_ = rodwake::granular::lattice_sites(fit, setup.box);
        spacing_ = fit.spacing;
        row_angle_ = fit.orientation;
    }
    layout_ = {setup.box, 1.0, 1.0, sites_.size(), 1};
    RandomStream random(setup.seed, 0xFFFF);
    for (std::size_t k = 0; setup.noise_time > 0.0 && k < 2 * waves * sites_.size(); ++k) {
        rates_.push_back(std::tan(M_PI * (random.uniform() - 0.5)) / setup.noise_time); // of that correlation
        phases_.push_back(2.0 * M_PI * random.uniform());
    }
}

Vector SyntheticWake::noise(std::size_t bead, double time) const {
    double sum[2] = {0.0, 0.0};
    for (std::size_t k = 0; k < 2 * waves; ++k)
        sum[k / waves] += std::cos(rates_[2 * waves * bead + k] * time + phases_[2 * waves * bead + k]);
    const double size = setup_.noise * std::sqrt(2.0 / static_cast<double>(waves));
    return {size * sum[0], size * sum[1]};
}

Vector SyntheticWake::truth(double x, double y) const {
    x = std::remainder(x, setup_.box);
    y = std::remainder(y, setup_.box);
    const double r = std::hypot(x, y);
    if (r == 0.0)
        x = setup_.core;
    else if (r < setup_.core) {
        x *= setup_.core / r;
        y *= setup_.core / r;
    }
    const Vector u = field_.at(x, y, {.displacement = true}).displacement;
    return {setup_.strength * u.x, setup_.strength * u.y};
}

/// How far along the heading a site has slipped: a spacing for each time the rod has passed.
double SyntheticWake::slipped(const Eigen::Vector2d& site, const RodPosition& rod) const {
    const double c = std::cos(setup_.heading), s = std::sin(setup_.heading);
    const double across = std::remainder(-s * (site.x() - rod.x) + c * (site.y() - rod.y), setup_.box);
    if (std::abs(across) > setup_.slip_within)
        return 0.0;
    const double along = c * (rod.x - site.x()) + s * (rod.y - site.y());
    return spacing_ * std::max(0.0, std::floor(along / setup_.box) + 1.0);
}

Frame SyntheticWake::frame(std::size_t number) const {
    Frame frame;
    frame.time = static_cast<double>(number) * setup_.interval;
    RandomStream random(setup_.seed, static_cast<std::uint32_t>(number));
    const double c = std::cos(setup_.heading), s = std::sin(setup_.heading);
    const double way = setup_.speed * frame.time;
    const RodPosition rod{10.3 + c * way, 30.7 + s * way, setup_.heading};
    frame.rods = {rod};
    for (std::size_t i = 0; i < sites_.size(); ++i) {
        const Eigen::Vector2d& site = sites_[i];
        const double slip = slipped(site, rod);
        const double x = site.x() + setup_.drift_x * frame.time + c * slip;
        const double y = site.y() + setup_.drift_y * frame.time + s * slip;
        const Vector u = truth(c * (x - rod.x) + s * (y - rod.y), -s * (x - rod.x) + c * (y - rod.y));
        const Vector n = rates_.empty() ? gaussian(random, setup_.noise) : noise(i, frame.time);
        frame.unwrapped_x.push_back(x + c * u.x - s * u.y + n.x);
        frame.unwrapped_y.push_back(y + s * u.x + c * u.y + n.y);
        frame.x.push_back(inside(frame.unwrapped_x.back(), setup_.box));
        frame.y.push_back(inside(frame.unwrapped_y.back(), setup_.box));
    }
    frame.vx.assign(sites_.size(), 0.0);
    frame.vy.assign(sites_.size(), 0.0);
    return frame;
}

} // namespace measure_test
