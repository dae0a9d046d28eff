// Speed against accuracy: which settings a scene allows, what their errors are, and which one is recommended.

#include "rodwake/app/plan.hpp"
#include "rodwake/app/run.hpp"
#include "rodwake/app/run_folder.hpp"
#include "rodwake/core/error.hpp"
#include "run_files.hpp"
#include "scenes.hpp"
#include "tradeoff/target.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <fstream>

using namespace rodwake;
using namespace rodwake::app;
using app_test::pair;

namespace {

Encounter ended(Ending ending, double time, double x, std::vector<std::vector<double>> path = {}) {
    return {true, ending, ending == Ending::contact ? time : NAN, {x, 0.0}, std::move(path)};
}

Way trial(double seconds, double error) {
    return {.seconds = seconds,
            .runs = 3,
            .found = found_of(RodErrors{{error}, {NAN}, {0.0}, {2.0 * error}}),
            .setting = {.method = "erk", .tolerance = 1e-6},
            .rhs_evaluations = 100};
}

Tradeoff table_of(std::vector<Way> trials) {
    Tradeoff table;
    table.unit = "a run";
    table.rods.methods = {"erk", "adams"};
    table.kind = "final_state";
    table.ways = std::move(trials);
    return table;
}

long count(const std::vector<Setting>& settings, const auto& is) {
    return std::ranges::count_if(settings, is);
}

/// A list of two pairs, which a scan takes in a moment; both touch or part within 8.
scene::Scene small_scan(const std::filesystem::path& folder) {
    std::ofstream(folder / "points.csv") << "coupling.kappa,rods.1.position.0\n0.5,0\n30,-1\n";
    return scene::parse_scene(
        "schema = 1\n[medium]\neta = 1.0\nalpha = 1.0\n[coupling]\nkappa = 0.5\n"
        "[rods_run]\nt_end = 8.0\ncontact_distance = 0.1\n[[rods]]\nposition = [0.0, 1.0]\n"
        "[[rods]]\nposition = [0.0, -1.0]\n[scan]\ndesign = \"list\"\nfile = \"points.csv\"\n",
        (folder / "scan.toml").string());
}

Tradeoff measured(const scene::Scene& scene, const std::filesystem::path& folder, const RunContext& context) {
    constexpr app::Stage stage[] = {app::Stage::tradeoff};
    CHECK(app::run(plan_run(scene, stage, folder, context), folder, context) == StageEnd::finished);
    return read_tradeoff(folder);
}

} // namespace

TEST_CASE("an error is the largest difference of the states, and infinite for another outcome") {
    const std::vector reference{ended(Ending::contact, 4.0, 1.0, {{0.0, 0.0}, {0.5, 0.0}})};
    const std::vector near{ended(Ending::contact, 4.25, 1.125, {{0.0, 0.0}, {0.25, 0.0}})};
    const RodErrors close = errors_between(near, reference);
    CHECK(close.final_state == 0.125);
    CHECK(close.contact_time == 0.25);
    CHECK(close.outcome == 0.0);
    CHECK(close.path == 0.25);
    const std::vector other{ended(Ending::escape, 4.0, 1.0, {{0.0, 0.0}})};
    const RodErrors far = errors_between(other, reference);
    CHECK(std::isinf(far.final_state));
    CHECK(std::isinf(far.path));
    CHECK(far.outcome == 1.0);
    CHECK(std::isnan(errors_between(other, other).contact_time)); // nobody touches
    auto unsolved = reference;
    unsolved.front().solved = false;
    CHECK(errors_between(unsolved, reference).outcome == 1.0);
}

TEST_CASE("of many points an error is what 95 % keep to, and the share of outcomes that differ") {
    std::vector<Encounter> reference, one;
    for (int k = 0; k < 101; ++k) {
        reference.push_back(ended(Ending::escape, 8.0, 0.0));
        one.push_back(ended(k < 3 ? Ending::contact : Ending::escape, 8.0, 1e-3 * k));
    }
    const RodErrors errors = errors_between(one, reference);
    CHECK(errors.outcome == Approx(3.0 / 101.0).epsilon(1e-14));
    CHECK(errors.final_state == Approx(98e-3).epsilon(1e-14)); // the 96th of 98 finite and 3 infinite ones
    CHECK(std::isnan(errors.path));
}

TEST_CASE("the cheapest setting that is good enough, and the best one that is quick enough") {
    Tradeoff table = table_of({trial(4.0, 1e-8), trial(1.0, 1e-3), trial(2.0, 1e-5), trial(3.0, 1e-4),
                               trial(0.5, HUGE_VAL), trial(2.5, 1e-5), trial(0.1, 1e-9)});
    table.ways.back().status = "took too long"; // whatever its numbers are
    CHECK(cheapest(table, "final_state", 1e-4)->seconds() == 2.0);
    CHECK_FALSE(cheapest(table, "final_state", 1e-9));
    CHECK(cheapest(table, "path", 1e-3)->seconds() == 2.0); // where errors are twice as large
    CHECK_FALSE(cheapest(table, "contact_time", 1.0));
    CHECK(most_accurate(table, "final_state", 3.0)->seconds() == 2.0);
    CHECK_FALSE(most_accurate(table, "final_state", 0.7));
    const auto front = pareto_front(table, "final_state");
    std::vector<double> seconds;
    for (const Way* one : front)
        seconds.push_back(one->seconds);
    CHECK(seconds == std::vector{1.0, 2.0, 4.0});
}

TEST_CASE("settings are those that the scene allows") {
    const auto of_pair = settings_of(pair());
    CHECK(count(of_pair, [](const Setting& s) { return s.field == "table"; }) > 0);
    CHECK(count(of_pair, [](const Setting& s) { return s.method == "auto"; }) == 0);
    CHECK(count(of_pair, [](const Setting& s) { return s.form == "dae" && s.method != "bdf"; }) == 0);
    CHECK(count(of_pair, [](const Setting& s) { return s.form == "director" && s.method == "adams"; }) == 0);
    CHECK(count(of_pair, [](const Setting& s) { return s.precision != "full"; }) == 0);
    scene::Scene many = pair();
    for (int k = 0; k < 300; ++k)
        many.rods.push_back({{10.0 + k, 0.0}, 0.0});
    const auto of_many = settings_of(many);
    CHECK(count(of_many, [](const Setting& s) { return s.method == "bdf"; }) == 0);
    CHECK(count(of_many, [](const Setting& s) { return s.precision == "single"; }) > 0);
    CHECK_THROWS_AS(settings_of(app_test::bed()), InputError);
}

TEST_CASE("what the settings choose makes no other measurement, and what they do not does") {
    const auto key = [](const scene::Scene& scene) { return stage_key(scene, app::Stage::tradeoff); };
    scene::Scene chosen = pair();
    chosen.rods_run->method = integrate::Method::bdf;
    chosen.rods_run->rtol = 1e-3;
    chosen.medium->field = scene::FieldBackend::table;
    CHECK(key(chosen) == key(pair()));
    CHECK(key(pair(0.7)) != key(pair()));
    CHECK_FALSE(key(app_test::bed()).empty()); // beside a tradeoff another scene may be refused, not fatal
}

TEST_CASE("a setting's keys make the scene that it stands for") {
    scene::Scene scene = pair();
    scene.rods_run->turning_tolerance = 1e-4;
    for (const Setting& setting : settings_of(scene)) {
        std::istringstream lines(scene_keys(scene, setting));
        std::string text =
            "schema = 1\n[medium]\neta = 1.0\nalpha = 1.0\n[coupling]\nkappa = 0.5\n"
            "[[rods]]\nposition = [0.0, 1.0]\n[[rods]]\nposition = [0.0, -1.0]\n[rods_run]\nt_end = 2.0\n";
        std::vector<std::string> overrides;
        for (std::string line; std::getline(lines, line);)
            overrides.push_back(line);
        const scene::Scene made = scene::parse_scene(text, "pair.toml", overrides),
                           wanted = with(scene, setting);
        CHECK(made.rods_run->method == wanted.rods_run->method);
        CHECK(made.rods_run->form == wanted.rods_run->form);
        CHECK(made.rods_run->rtol == Approx(wanted.rods_run->rtol).epsilon(1e-15));
        CHECK(made.rods_run->atol == Approx(wanted.rods_run->atol).epsilon(1e-15));
        CHECK(made.rods_run->turning_tolerance == 0.0);
        CHECK(made.medium->field == wanted.medium->field);
        CHECK(made.medium->table == wanted.medium->table);
    }
}

TEST_CASE("tradeoff.json is read as it was written") {
    const store_test::Scratch folder;
    Tradeoff table = table_of({trial(4.0, 1e-8), trial(1.0, HUGE_VAL)});
    table.ways[1].setting = {"auto", "director", "table", 1e-6, "fine", 1e-5};
    table.ways[1].status = "took too long";
    table.rods.least = {{1e-12}, {NAN}, {0.0}, {1e-12}};
    std::ofstream(folder.path() / "tradeoff.json") << tradeoff_json(table);
    const Tradeoff read = read_tradeoff(folder.path());
    CHECK(tradeoff_json(read) == tradeoff_json(table));
    CHECK(read.ways[1].setting == table.ways[1].setting);
    CHECK(std::isinf(read.ways[1].found.front().bias));
    table.ways[0].setting.method = "euler";
    std::ofstream(folder.path() / "tradeoff.json") << tradeoff_json(table);
    CHECK_THROWS_WITH(read_tradeoff(folder.path()), Catch::Contains("\"euler\" is unknown"));
    std::ofstream(folder.path() / "tradeoff.json") << "{\"unit\": 3}";
    CHECK_THROWS_AS(read_tradeoff(folder.path()), InputError);
}

TEST_CASE("a scan's settings are measured against a reference, and taken up where they were left",
          "[threads]") {
    const store_test::Scratch folder;
    const scene::Scene scene = small_scan(folder.path());
    const auto out = folder.path() / "out";
    RunContext context;
    int told = 0;
    context.progress = [&](const ProgressReport& report) { told = static_cast<int>(report.value); };
    context.stop = [&] { return told >= 5; };
    constexpr app::Stage stage[] = {app::Stage::tradeoff};
    CHECK(app::run(plan_run(scene, stage, out, context), out, context) == StageEnd::interrupted);
    const Tradeoff begun = read_tradeoff(out);
    CHECK(begun.ways.size() == 5);
    CHECK_FALSE(holds_finished(out, scene, app::Stage::tradeoff));
    context.stop = nullptr;
    const Tradeoff table = measured(scene, out, context);
    CHECK(holds_finished(out, scene, app::Stage::tradeoff));
    CHECK(app_test::untold(out).empty());
    CHECK(table.unit == "2 points of the scan");
    CHECK(table.ways.size() == settings_of(scene).size());
    CHECK(table.ways.front().seconds <= begun.ways.front().seconds); // kept, and timed once more
    for (const Way& one : table.ways) {
        INFO(one.setting.method << " " << one.setting.form << " " << one.setting.tolerance);
        const double error = one.find("final_state")->bias, least = table.rods.least.final_state;
        CHECK(one.status == "ok");
        CHECK(one.find("outcome")->bias == 0.0);
        CHECK(error >= least);
        CHECK(error < std::max(least, 100.0 * one.setting.tolerance)); // ode.hpp
        CHECK(one.rhs_evaluations > 0);
    }
    CHECK(table.rods.agreement.final_state < 1e-9);
}
