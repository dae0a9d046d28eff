// What the explorer's page computes, beside rods::simulate and elastic::superpose.

#include "explore/encounter.hpp"
#include "rods/random_pairs.hpp"
#include "rodwake/app/explore.hpp"
#include "rodwake/app/rods.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/scene/document.hpp"
#include "rodwake/scene/read.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

using namespace rodwake;

namespace {

constexpr double rtol = 1e-8;

rods::RodResult by_solver(const rods::RodProblem& problem) {
    rods::RodOptions options;
    options.ode.method = integrate::Method::erk;
    options.ode.rtol = rtol;
    options.ode.atol = 0.01 * rtol;
    return rods::simulate(problem, options);
}

/// Of the last row of the path.
double difference(const app::EncounterPath& encounter, const rods::RodResult& result) {
    const auto& state = result.solution.final_state;
    const std::size_t width = 1 + 4 * encounter.rods;
    const double* row = encounter.rows.data() + encounter.rows.size() - width;
    double most = std::abs(row[0] - result.solution.final_time);
    for (std::size_t i = 0; i < state.size(); ++i)
        most = std::max(most, std::abs(row[1 + i] - state[i]));
    return most;
}

rods::RodProblem three_rods() {
    return {elastic::Medium{1.0, 1.0},
            {5.0, 1.0, -2.0},
            {{0, 2, 0.1}, {0.3, -2, 0.3}, {4, 1, 3.0}},
            20.0,
            {},
            0.1};
}

} // namespace

TEST_CASE("encounters of the page end as those of the solver") {
    for (const bool polar : {false, true}) {
        const auto pairs = rods::random_pairs(40, 3, polar);
        std::vector<rods::RodProblem> problems;
        std::ranges::transform(pairs, std::back_inserter(problems), rods::to_rod_problem);
        std::vector<app::EncounterSummary> ends(problems.size());
        app::encounters(problems, rtol, ends);
        std::vector<double> errors;
        for (std::size_t i = 0; i < problems.size(); ++i) {
            const app::EncounterPath encounter = app::encounter(problems[i], rtol);
            const rods::RodResult result = by_solver(problems[i]);
            CHECK(encounter.outcome.ending == result.outcome.ending);
            CHECK(ends[i].ending == result.outcome.ending);
            CHECK(ends[i].time == encounter.outcome.time); // the same kernels
            CHECK(encounter.outcome.min_separation == Approx(result.outcome.min_separation).margin(1e-5));
            errors.push_back(difference(encounter, result));
        }
        std::ranges::sort(errors);
        CHECK(errors[errors.size() / 2] < 1e-7);      // of the batch's own table, rtol 1e-8
        CHECK(errors[errors.size() * 9 / 10] < 1e-6); // rods that nearly meet multiply it
    }
}

TEST_CASE("the path is that of the solver at each of its steps") {
    rods::RodProblem problem = rods::to_rod_problem(rods::random_pairs(1, 7, true)[0]);
    const app::EncounterPath encounter = app::encounter(problem, 1e-10);
    std::vector<double> row(encounter.rows.begin(), encounter.rows.begin() + 9);
    CHECK(row[0] == 0.0);
    CHECK(std::vector(row.begin() + 1, row.begin() + 7) == rods::to_state(problem.rods));
    std::vector<double> rates(6);
    rods::model_of(problem).rhs(rods::to_state(problem.rods), rates);
    CHECK(row[7] == Approx(rates[2]).epsilon(1e-12));
    const std::size_t middle = encounter.rows.size() / 9 / 2 * 9;
    problem.t_end = encounter.rows[middle];
    const rods::RodResult result = by_solver(problem);
    for (std::size_t i = 0; i < 6; ++i)
        CHECK(encounter.rows[middle + 1 + i] == Approx(result.solution.final_state[i]).margin(1e-6));
}

TEST_CASE("rods that the pairs' kernels do not take") {
    const rods::RodProblem three = three_rods();
    const app::EncounterPath encounter = app::encounter(three, rtol);
    const rods::RodResult result = by_solver(three);
    CHECK(encounter.outcome.ending == result.outcome.ending);
    CHECK(encounter.outcome.pair.first == result.outcome.pair.first);
    CHECK(difference(encounter, result) < 1e-6);

    rods::RodProblem lone = three;
    lone.rods.resize(1);
    CHECK(difference(app::encounter(lone, rtol), by_solver(lone)) < 1e-12); // straight

    rods::RodProblem unstable = rods::to_rod_problem(rods::random_pairs(1, 5, false)[0]);
    unstable.medium->eta = -0.3; // K < 0: no free-standing material, and beyond the kernels
    CHECK(difference(app::encounter(unstable, rtol), by_solver(unstable)) < 1e-6);

    rods::RodProblem free = rods::to_rod_problem(rods::random_pairs(1, 5, false)[0]);
    free.couplings = {};
    CHECK(app::encounter(free, rtol).outcome.ending == by_solver(free).outcome.ending);

    rods::RodProblem touching = three;
    touching.rods[1] = {0.05, 2, 0};
    const app::EncounterPath met = app::encounter(touching, rtol);
    CHECK(met.outcome.ending == Ending::contact);
    CHECK(met.outcome.time == 0.0);
}

TEST_CASE("what the page refuses") {
    rods::RodProblem problem = three_rods();
    CHECK_THROWS_AS(app::encounter(problem, 1.0), InputError);
    problem.t_end = -1.0;
    CHECK_THROWS_AS(app::encounter(problem, rtol), InputError);
    // head on without a contact distance: their fields are singular where they meet
    const rods::RodProblem head_on{
        elastic::Medium{1.0, 1.0}, {1.0, 0, 0}, {{-2, 0, 0}, {2, 0, M_PI}}, 10.0, {}, {}};
    CHECK_THROWS_AS(app::encounter(head_on, rtol), RunError);
    app::EncounterSummary end;
    app::encounters({&head_on, 1}, rtol, {&end, 1}); // one bad cell of a diagram costs no others
    CHECK(end.ending == Ending::undecided);
    CHECK(std::isnan(end.time));
}

TEST_CASE("wakes on a grid are the field") {
    const elastic::Medium medium{1.5, 2.0};
    const std::vector<elastic::Source> rods = {{0, 0, 0.5}, {1, 2, -1}};
    const std::vector<double> x = {0.3, -2, 5, 0}, y = {0.4, 1, -3, 0};
    std::vector<std::vector<double>> c(9, std::vector<double>(4));
    app::wakes(medium, rods, {x, y}, {{c[0], c[1], c[2]}, {c[3], c[4], c[5], c[6]}, c[7], c[8]});
    for (std::size_t i = 0; i < 3; ++i) {
        const auto f = elastic::superpose(elastic::Field(medium), rods, x[i], y[i],
                                          {.displacement = true, .strain = true, .polar = true});
        const double exact[] = {f.strain.xx,           f.strain.xy,      f.strain.yy,
                                f.laplacian.x,         f.laplacian.y,    f.gradient_of_trace.x,
                                f.gradient_of_trace.y, f.displacement.x, f.displacement.y};
        for (std::size_t k = 0; k < 9; ++k)
            CHECK(c[k][i] == Approx(exact[k]).epsilon(1e-11)); // of the kernels, with parts that cancel
    }
    for (const auto& column : c)
        CHECK(std::isnan(column[3])); // a rod itself
}

TEST_CASE("whatever key a scene has, the page starts from it or is not made and says why") {
    const std::string text =
        "schema = 1\n[medium]\neta = 2.0\nalpha = 0.5\n[coupling]\nkappa = 3.0\ngamma1 = 0.5\n"
        "[[rods]]\nposition = [1.0, 2.5]\n[[rods]]\nposition = [0.0, -2.5]\n"
        "[rods_run]\nt_end = 60.0\n";
    const auto started = [](const scene::Scene& scene) {
        const std::string page =
            app::explorer_page(RODWAKE_SOURCE_DIR "/explorer", app::ExplorerStart{scene, "a"});
        const std::size_t state = page.find("\"state\":{");
        return page.substr(state, page.find('}', state) - state);
    };
    const auto content = [](const scene::Scene& scene) { // what the page has to know of the run
        const rods::RodProblem p = app::rod_problem(scene);
        return std::tuple(p.medium->eta, p.medium->xi, p.couplings.kappa, p.couplings.gamma1,
                          p.couplings.gamma2, p.t_end, p.contact_distance);
    };
    const scene::Scene before = scene::parse_scene(text, "a.toml");
    int refused = 0, changed = 0;
    for (const scene::KeyInfo& key : scene::scene_keys()) {
        if (key.table != "medium" && key.table != "coupling" && key.table != "rods_run")
            continue;
        std::vector<std::string> values = {key.example, "true", "0.25", "2.5"};
        for (const std::string& choice : key.choices)
            values.push_back('"' + choice + '"');
        int legal = 0;
        for (const std::string& value : values) {
            std::string scene_text = text; // in place of what the scene has, and of alternatives to it
            const bool of_eta =
                key.table == "medium" && (key.name == "poisson_ratio" || key.name == "bulk_modulus" ||
                                          key.name == "lame_lambda" || key.name == "mu");
            const std::string other = of_eta || key.name == "fitted" ? "eta"
                                      : key.name == "xi"             ? "alpha"
                                                                     : key.name;
            if (const std::size_t line = scene_text.find("\n" + other + " = "); line != std::string::npos)
                scene_text.erase(line, scene_text.find('\n', line + 1) - line);
            if (key.name == "fitted")
                scene_text.erase(scene_text.find("alpha = 0.5\n"), 12);
            std::string line = key.name + " = " + value + "\n";
            if (key.name == "lame_lambda" || key.name == "bulk_modulus")
                line += "mu = 1.5\n";
            if (key.name == "mu")
                line += "bulk_modulus = 4.0\n";
            scene_text.insert(scene_text.find("[" + key.table + "]\n") + key.table.size() + 3, line);
            std::optional<scene::Scene> scene;
            try {
                scene = scene::parse_scene(scene_text, "a.toml");
            } catch (const InputError&) { // no value of that key, or only beside others
                continue;
            }
            ++legal;
            CAPTURE(line);
            const std::vector<std::string> left = app::left_out_by_explorer(*scene);
            if (!left.empty()) {
                ++refused;
                CHECK(left.front().starts_with(key.table + "." + key.name));
                CHECK_THROWS_WITH(started(*scene), Catch::Contains(key.name));
                continue;
            }
            CHECK((started(*scene) == started(before)) == (content(*scene) == content(before)));
            CHECK(app::rod_problem(*scene).rows.gamma == 0.0);
            CHECK_FALSE(scene->medium->box());
            changed += content(*scene) != content(before);
        }
        CAPTURE(key.table, key.name);
        CHECK((legal > 0 || key.name == "fitted")); // [fit] goes with it: tests/cli/test_explore.py
    }
    CHECK(refused > 5);
    CHECK(changed > 10);
}

TEST_CASE("the page starts with a scene") {
    const auto page = [](const std::string& text) {
        return app::explorer_page(RODWAKE_SOURCE_DIR "/explorer",
                                  app::ExplorerStart{scene::parse_scene(text, "a.toml"), "a"});
    };
    const std::string rods =
        "[[rods]]\nposition = [1.0, 2.5]\nheading = 0.5\n[[rods]]\nposition = [0.0, -2.5]\n"
        "[rods_run]\nt_end = 60.0\ncontact_distance = 0.1\n";
    const std::string text =
        page("schema = 1\n[medium]\neta = 2.0\nxi = 4.0\n[coupling]\nkappa = 3.0\n" + rods);
    CHECK_THAT(text,
               Catch::Contains(R"("eta":2.0,"alpha":0.25,"t_end":60.0,"contact_distance":0.1,"kappa":3.0)"));
    CHECK_THAT(text, Catch::Contains(R"("x0":1.0,"y0":2.5,"theta0":0.5)"));
    for (const char* place : {"{{style}}", "{{setup}}", "{{kernel}}", "{{script}}"})
        CHECK_THAT(text, !Catch::Contains(place));
    CHECK(text.size() < 2'000'000);
    CHECK_THROWS_WITH(page("schema = 1\n" + rods), Catch::Contains("no [medium]"));
    CHECK_THROWS_AS(app::explorer_page("/nowhere", {}), RunError);
}
