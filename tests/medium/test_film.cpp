// Films: values on the grid against sums over the modes, frames against the fields of the runs, and what
// makes no film.

#include "rodwake/core/error.hpp"
#include "rodwake/medium/simulate.hpp"

#include <catch2/catch.hpp>

#include <cmath>

using namespace rodwake;
using namespace rodwake::medium;

namespace {

struct Stored {
    double time;
    std::vector<double> poses, ux, uy;

    bool operator==(const Stored&) const = default;
};
using Film = std::vector<Stored>;

FilmSink into(Film& film) {
    return [&film](const FilmFrame& f) {
        film.push_back({f.time,
                        {f.poses.begin(), f.poses.end()},
                        {f.ux.begin(), f.ux.end()},
                        {f.uy.begin(), f.uy.end()}});
    };
}

MediumProblem pair(DynamicMedium medium = {}) {
    MediumProblem p;
    p.rods.medium = elastic::Medium{0.7, 1.3};
    p.rods.couplings = {5.0, 1.0, -0.5};
    p.rods.rods = {{0.0, 1.5, -0.1}, {0.3, -1.5, 0.2}};
    p.rods.t_end = 2.0;
    p.rods.output_times = {0.6, 1.2};
    p.medium = medium;
    p.medium.box = 8.0;
    p.medium.force_width = 0.6;
    p.medium.modes = 16;
    p.medium.film_interval = 0.3;
    p.medium.film_grid = 18;
    return p;
}

rods::RodOptions tolerance(double rtol) {
    rods::RodOptions options;
    options.ode.rtol = rtol;
    options.ode.atol = 0.01 * rtol;
    return options;
}

double size_of(const std::vector<double>& values) {
    double largest = 0.0;
    for (const double value : values)
        largest = std::max(largest, std::abs(value));
    return largest;
}

double distance(const std::vector<double>& a, const std::vector<double>& b) {
    double largest = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i)
        largest = std::max(largest, std::abs(a[i] - b[i]));
    return largest;
}

Film film_of(const MediumProblem& problem, double rtol) {
    Film film;
    simulate(problem, tolerance(rtol), into(film));
    return film;
}

} // namespace

TEST_CASE("values on the grid are the sums over the modes at its points") {
    const elastic::Medium elastic{0.7, 1.3};
    // modes 15: odd, half of them as of 16; grids coarser than the modes, as fine, finer; sums of some 10^2
    // terms, each to rounding
    for (const std::size_t number : {15, 16, 40})
        for (const std::size_t points : {8, 10, 16, 24, 54}) {
            const DynamicMedium medium{.box = 8.0, .force_width = 0.6, .modes = number};
            const ModalField modes(elastic, medium);
            std::vector<double> field(modes.numbers());
            modes.add_steady({1.1, -3.2, 0.4}, field);
            modes.add_steady({-2.0, 0.7, 2.9}, field);
            const FieldGrid grid(points);
            std::vector<double> ux(points * points), uy(ux.size());
            grid.evaluate(modes, field, ux, uy);
            const double scale = size_of(ux);
            REQUIRE(scale > 0.01);
            CAPTURE(number, points);
            double worst = 0.0;
            for (std::size_t j = 0; j < points; ++j)
                for (std::size_t i = 0; i < points; ++i) {
                    const elastic::FieldValues u =
                        modes.at(grid.place(i, 8.0), grid.place(j, 8.0), {.displacement = true}, field);
                    worst = std::max({worst, std::abs(u.displacement.x - ux[j * points + i]),
                                      std::abs(u.displacement.y - uy[j * points + i])});
                }
            CHECK(worst < 1e-12 * scale);
        }
}

TEST_CASE("a film shows the sum of all rods' fields, and is that of the run at any tolerance") {
    const std::vector<DynamicMedium> media = {{},
                                              {.self_field = true},
                                              {.start = Start::rest, .evaluation = Evaluation::mesh},
                                              {.inertia = 0.2},
                                              {.self_field = true, .evaluation = Evaluation::mesh}};
    for (const DynamicMedium& medium : media) {
        CAPTURE(medium.self_field, medium.inertia, medium.evaluation == Evaluation::mesh);
        const Film film = film_of(pair(medium), 1e-6), fine = film_of(pair(medium), 1e-8);
        REQUIRE(film.size() == 7); // 0, 0.3, ..., 1.8
        for (std::size_t k = 0; k < film.size(); ++k) {
            CHECK(film[k].time == Approx(0.3 * static_cast<double>(k)).margin(1e-15));
            // a frame's error is some 15 tolerances, and grows with the run's
            CHECK(distance(film[k].ux, fine[k].ux) < 1e-5);
            CHECK(distance(film[k].uy, fine[k].uy) < 1e-5);
            CHECK(distance(film[k].poses, fine[k].poses) < 1e-5);
        }
        CHECK(distance(fine[6].ux, fine[5].ux) > 1e-3); // it moves
    }
    // of the two fields that each rod feels by itself the film has both
    const MediumProblem problem = pair();
    const ModalField modes(*problem.rods.medium, problem.medium);
    std::vector<double> field(modes.numbers()), ux(18 * 18), uy(ux.size());
    for (const rods::Pose& rod : problem.rods.rods)
        modes.add_steady(rod, field);
    FieldGrid(18).evaluate(modes, field, ux, uy);
    CHECK(distance(film_of(problem, 1e-6)[0].ux, ux) < 1e-14);
}

TEST_CASE("a film changes no bit of its run, and has the poses of the outputs") {
    for (const bool mesh : {false, true}) {
        MediumProblem filmed = pair({.evaluation = mesh ? Evaluation::mesh : Evaluation::sums}),
                      plain = filmed;
        plain.medium.film_interval.reset();
        Film film;
        const rods::RodResult with = simulate(filmed, tolerance(1e-7), into(film)),
                              without = simulate(plain, tolerance(1e-7));
        CHECK(with.solution.states == without.solution.states);
        CHECK(with.solution.statistics.steps == without.solution.statistics.steps);
        CHECK(film[2].poses == with.solution.states[0]);
        CHECK(film[4].poses == with.solution.states[1]);
    }
}

TEST_CASE("the film of a resumed run, and of one on two threads, is the same to the bit", "[threads]") {
    MediumProblem problem = pair();
    const Film whole = film_of(problem, 1e-8);
    problem.rods.sums.threads = 2;
    CHECK(film_of(problem, 1e-8) == whole);
    problem.rods.sums.threads = 1;
    rods::RodOptions options = tolerance(1e-8);
    rods::RodCheckpoint saved;
    double reached = 0.0;
    options.on_checkpoint = [&](const rods::RodCheckpoint& checkpoint) { saved = checkpoint; };
    options.ode.on_step = [&](const integrate::Step& step) { reached = step.time; };
    options.ode.stop_requested = [&] { return reached > 1.0; };
    Film parts;
    simulate(problem, options, into(parts));
    REQUIRE(parts.size() > 2);
    REQUIRE(parts.size() < whole.size());
    CHECK(parts.size() == static_cast<std::size_t>(saved.time / 0.3) + 1); // as who resumes counts them
    options = tolerance(1e-8);
    options.resume_from = saved;
    simulate(problem, options, into(parts));
    CHECK(parts == whole);
}

TEST_CASE("a film ends with its run") {
    MediumProblem problem = pair();
    problem.rods.couplings = {30.0, 0.0, 0.0};
    problem.rods.rods = {{0.0, 1.5, 0.0}, {0.0, -1.5, 0.0}};
    problem.rods.t_end = 20.0;
    problem.rods.contact_distance = 0.7;
    Film film;
    const rods::RodResult result = simulate(problem, tolerance(1e-7), into(film));
    REQUIRE(result.outcome.ending == Ending::contact);
    CHECK(film.size() == static_cast<std::size_t>(result.outcome.time / 0.3) + 1);
    CHECK(film_times({.film_interval = 0.1}, 0.3).size() == 4); // 3 * 0.1 > 0.3
    CHECK(film_times({.film_interval = 0.1}, 0.3).back() == 0.3);
    CHECK(film_times({}, 0.3).empty());
}

TEST_CASE("what makes no film is refused in words") {
    const auto refused = [](void (*spoil)(DynamicMedium&), const char* said) {
        MediumProblem problem = pair();
        spoil(problem.medium);
        Film film;
        CHECK_THROWS_WITH(simulate(problem, tolerance(1e-6), into(film)), Catch::Contains(said));
        CHECK_THROWS_AS(simulate(problem, tolerance(1e-6), into(film)), InputError);
    };
    refused([](DynamicMedium& m) { m.film_interval = 0.0; }, "film_interval = 0: must be > 0 and finite");
    refused([](DynamicMedium& m) { m.film_interval = -1.0; }, "film_interval = -1: must be > 0");
    refused(
        [](DynamicMedium& m) { m.film_grid = 12; },
        "film_grid = 12: its spacing box/film_grid = 0.6667 is above force_width = 0.6, so that rods would "
        "fall between the points; take 16 or more");
    refused([](DynamicMedium& m) { m.film_grid = 22; },
            "film_grid = 22: must be 4 to 1024, even and without");
    refused([](DynamicMedium& m) { m.film_grid = 21; }, "such as 24");
    refused([](DynamicMedium& m) { m.film_grid = 2000; }, "film_grid = 2000: must be 4 to 1024");
    refused([](DynamicMedium& m) { m.film_interval = 1e-5, m.film_grid = 128; }, "52.4 GB: at most");
    refused([](DynamicMedium& m) { m.closure = Closure::steady; },
            "film_interval needs a medium that is integrated");
    CHECK_THROWS_AS(FieldGrid(14), InputError);
}
