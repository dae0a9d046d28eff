// Work for bench/term_costs.py to count the instructions of: one thing of a scene, so many times over.
//
//   build/release/bench/bench_terms WHAT COUNT SCENE [table.key=value ...]
//
// WHAT: rhs, jacobian, run (of rods); bed (steps of it); or plain_rhs, plain_bed: the same result by code
// that knows nothing but the terms the scene has, on the plane and for beads alone. Those say so if their
// bits differ. The script counts what happens inside the functions it names: do not inline them.

#include "granular/bodies.hpp"
#include "granular/bounces.hpp"
#include "granular/pair_contacts.hpp"
#include "granular/pair_finder.hpp"
#include "rodwake/app/granular.hpp"
#include "rodwake/app/rods.hpp"
#include "rodwake/granular/start.hpp"
#include "rodwake/scene/read.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using namespace rodwake;

// --- rods -------------------------------------------------------------------------------------------------

double torque(const elastic::SymmetricTensor& e, double cosine, double sine) {
    return e.xy * (cosine * cosine - sine * sine) + 0.5 * (e.yy - e.xx) * (2.0 * cosine * sine);
}

/// A right-hand side as one would write it for these terms: strain, and polar vectors if `polar`.
class PlainRods {
public:
    explicit PlainRods(const rods::RodProblem& problem)
        : field_(*problem.medium), sums_(*problem.medium, rods::sum_options(problem.couplings, problem.sums)),
          couplings_(problem.couplings), rods_(problem.rods.size()), numbers_(7 * rods_), sources_(rods_) {}

    [[gnu::noinline]] void plain_rhs(integrate::State y, std::span<double> ydot) {
        for (std::size_t a = 0; a < rods_; ++a) {
            ydot[3 * a] = std::cos(y[3 * a + 2]);
            ydot[3 * a + 1] = std::sin(y[3 * a + 2]);
            ydot[3 * a + 2] = 0.0;
        }
        if (rods_ == 2)
            couplings_.polar() ? pair<true>(y, ydot) : pair<false>(y, ydot);
        else
            many(y, ydot);
    }

private:
    template<bool polar>
    void pair(integrate::State y, std::span<double> ydot) const {
        for (std::size_t b = 0; b < 2; ++b) {
            const std::size_t a = 1 - b;
            const double c = ydot[3 * b], s = ydot[3 * b + 1];
            const elastic::Vector at =
                turned(elastic::Vector{y[3 * a] - y[3 * b], y[3 * a + 1] - y[3 * b + 1]}, c, -s);
            if constexpr (polar) {
                const elastic::FieldValues f = field_.at(at.x, at.y, {.strain = true, .polar = true});
                add(a, turned(f.strain, c, s), ydot);
                add(a, turned(f.laplacian, c, s), turned(f.gradient_of_trace, c, s), ydot);
            } else {
                add(a, turned(field_.strain(at.x, at.y), c, s), ydot);
            }
        }
    }

    void many(integrate::State y, std::span<double> ydot) {
        const auto column = [&](std::size_t k) { return std::span(numbers_).subspan(k * rods_, rods_); };
        for (std::size_t a = 0; a < rods_; ++a)
            sources_[a] = {y[3 * a], y[3 * a + 1], y[3 * a + 2]};
        const elastic::StrainSums strain{column(0), column(1), column(2)};
        if (couplings_.polar())
            sums_.strain_and_polar(sources_, strain, {column(3), column(4), column(5), column(6)});
        else
            sums_.strain(sources_, strain);
        for (std::size_t a = 0; a < rods_; ++a) {
            add(a, {strain.xx[a], strain.xy[a], strain.yy[a]}, ydot);
            if (couplings_.polar())
                add(a, {column(3)[a], column(4)[a]}, {column(5)[a], column(6)[a]}, ydot);
        }
    }

    void add(std::size_t a, const elastic::SymmetricTensor& e, std::span<double> ydot) const {
        ydot[3 * a + 2] += couplings_.kappa * torque(e, ydot[3 * a], ydot[3 * a + 1]);
    }
    void add(std::size_t a, elastic::Vector laplacian, elastic::Vector gradient,
             std::span<double> ydot) const {
        const rods::Couplings& c = couplings_;
        const elastic::Vector v{c.gamma1 * laplacian.x + c.gamma2 * gradient.x,
                                c.gamma1 * laplacian.y + c.gamma2 * gradient.y};
        ydot[3 * a + 2] += ydot[3 * a] * v.y - ydot[3 * a + 1] * v.x;
    }

    elastic::Field field_;
    elastic::MutualWakes sums_;
    rods::Couplings couplings_;
    std::size_t rods_;
    std::vector<double> numbers_;
    std::vector<elastic::Source> sources_;
};

double rhs(const rods::RodProblem& problem, bool plain, long count) {
    const std::vector<double> y = rods::to_state(problem.rods);
    std::vector<double> ydot(y.size());
    const rods::RodModel model = rods::model_of(problem);
    if (!plain) {
        for (long i = 0; i < count; ++i)
            model.rhs(y, ydot);
        return ydot[2];
    }
    PlainRods rods(problem);
    for (long i = 0; i < count; ++i)
        rods.plain_rhs(y, ydot);
    std::vector<double> same(y.size());
    model.rhs(y, same);
    if (ydot != same)
        throw std::runtime_error("the plain right-hand side is another one");
    return ydot[2];
}

double jacobian(const rods::RodProblem& problem, long count) {
    const std::vector<double> y = rods::to_state(problem.rods);
    const auto size = static_cast<Eigen::Index>(y.size());
    Eigen::MatrixXd j(size, size);
    const rods::RodModel model = rods::model_of(problem);
    for (long i = 0; i < count; ++i)
        model.jacobian(y, j);
    return j(2, 2);
}

double runs(const scene::Scene& scene, long count) {
    const rods::RodProblem problem = app::rod_problem(scene);
    const rods::RodOptions options = app::rod_options(*scene.rods_run, problem);
    double evaluations = 0.0;
    for (long i = 0; i < count; ++i)
        evaluations =
            static_cast<double>(rods::simulate(problem, options).solution.statistics.rhs_evaluations);
    return evaluations;
}

// --- a bed ------------------------------------------------------------------------------------------------

/// Steps as one would write them for beads alone, less than the guards against steps that are too long.
class PlainBed {
public:
    explicit PlainBed(const granular::GranularProblem& p, const granular::State& state)
        : problem_(p), bodies_(granular::make_bodies(p, state)), finder_(bodies_, p.box),
          contacts_({p.contacts, p.box, p.time_step, p.gravity}) {}

    [[gnu::noinline]] void plain_step() {
        const double dt = problem_.time_step;
        const granular::PlateStep plate{
            floor_path(problem_.plates, problem_.gravity,
                       static_cast<double>(step_ + 1 - problem_.equilibration_steps) * dt),
            problem_.plates.gap, dt, problem_.gravity};
        const double floor = plate.floor.position(), a = problem_.bead_radius;
        granular::BodyRange all = granular::BodyRange::empty();
        for (std::size_t begin = 0; begin < bodies_.beads; begin += granular::beads_per_block) {
            granular::BodyRange velocities = granular::BodyRange::empty();
            hits_.clear();
            granular::drift(bodies_.position.data(), bodies_.velocity.data(), begin,
                            std::min(bodies_.beads, begin + granular::beads_per_block),
                            {dt, problem_.gravity, floor + a, floor + plate.gap - a}, velocities, hits_);
            granular::bounce_beads(bodies_, hits_, plate, problem_.contacts.bead_plate, velocities, tally_);
            all.include(velocities);
        }
        ++step_;
        contacts_.resolve(bodies_, finder_.find(bodies_, std::array{all.fastest_in_plane()}, dt, team_),
                          tallies_, team_);
    }

    granular::State state() const { return to_state(bodies_, step_); }

private:
    granular::GranularProblem problem_;
    granular::Bodies bodies_;

    granular::PairFinder finder_;
    granular::PairContacts contacts_;
    ThreadPool team_{1};
    granular::Counters tallies_;
    granular::PlateTally tally_;
    std::vector<std::uint32_t> hits_;
    std::int64_t step_ = 0;
};

double bed(const granular::GranularProblem& problem, bool plain, long count) {
    const granular::State start = make_start(problem, 0);
    granular::Simulation simulation(problem, start);
    if (!plain) {
        simulation.advance(count);
        return static_cast<double>(simulation.step());
    }
    PlainBed beads(problem, start);
    for (long i = 0; i < count; ++i)
        beads.plain_step();
    simulation.advance(count);
    if (granular::state_hash(beads.state()) != granular::state_hash(simulation.state()))
        throw std::runtime_error("the plain bed is another one");
    return static_cast<double>(simulation.step());
}

double work(const std::string& what, long count, const scene::Scene& scene) {
    const bool plain = what.starts_with("plain_");
    if (what == "bed" || what == "plain_bed")
        return bed(app::granular_problem(scene), plain, count);
    if (what == "run")
        return runs(scene, count);
    const rods::RodProblem problem = app::rod_problem(scene);
    if (what == "jacobian")
        return jacobian(problem, count);
    if (what == "rhs" || what == "plain_rhs")
        return rhs(problem, plain, count);
    throw std::runtime_error("WHAT is one of rhs, plain_rhs, jacobian, run, bed, plain_bed");
}

} // namespace

int main(int argc, char** argv) {
    if (argc < 4) {
        std::fprintf(stderr, "usage: bench_terms WHAT COUNT SCENE [table.key=value ...]\n");
        return 2;
    }
    try {
        const std::vector<std::string> overrides(argv + 4, argv + argc);
        std::printf("%.17g\n", work(argv[1], std::atol(argv[2]), scene::read_scene(argv[3], overrides)));
    } catch (const std::exception& error) {
        std::fprintf(stderr, "bench_terms: %s\n", error.what());
        return 1;
    }
    return 0;
}
