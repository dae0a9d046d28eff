// The files of a measured run: written from plain data, and described by the kinds of measures.

#include "bed/measure_kind.hpp"
#include "bed/measure_stage.hpp"
#include "bed/run_tables.hpp"
#include "rodwake/app/run.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/scene/read.hpp"
#include "run/catalogue.hpp"
#include "run_files.hpp"

#include <catch2/catch.hpp>

using namespace rodwake;
using namespace store_test;
using app::Stage;
using app_test::json_of, app_test::undescribed;

namespace {

/// The bed behind tests/plots/data/measure.json in two cases, with every measure.
scene::Scene measured_bed() {
    std::string text = content(RODWAKE_SOURCE_DIR "/tests/plots/data/measure.toml"); // ends with [measure]
    const scene::Scene kept = scene::parse_scene(text, "bed.toml");
    for (const app::MeasureKind& kind : app::measure_kinds())
        if (!kind.wanted(*kept.measure))
            text += std::string(kind.name) + " = true\n";
    return scene::parse_scene(text + "[[variants]]\nname = \"other\"\nset = { \"granular.seed\" = 2 }\n",
                              "bed.toml");
}

/// "chi2.algebraic": names of the values in a table of measure.json, an estimate being one.
void add_names(const nlohmann::json& table, const std::string& before, std::set<std::string>& names) {
    for (const auto& [name, value] : table.items())
        if (value.is_object() && !value.contains("samples"))
            add_names(value, before + name + ".", names);
        else
            names.insert(before + name);
}

/// Values of measure.json that no kind tells of, and those that kinds tell of and are not there.
std::set<std::string> unequal(const nlohmann::json& measured) {
    std::set<std::string> found;
    for (const app::MeasureKind& kind : app::measure_kinds()) {
        std::set<std::string> names, reported;
        add_names(measured.value(std::string(kind.name), nlohmann::json::object()), "", names);
        for (const ColumnInfo& value : kind.values())
            reported.emplace(value.name);
        std::vector<std::string> different;
        std::ranges::set_symmetric_difference(names, reported, std::back_inserter(different));
        for (const std::string& name : different)
            found.insert(std::string(kind.name) + "." + name);
    }
    return found;
}

/// Columns that readers of series.csv rely on; those of later measures come behind.
const std::string series_header =
    "name,phi_b,d0,imposed_speed,psi6,psi6_error,exponent,exponent_error,class,stiffness,stiffness_error,"
    "delta_y,delta_y_error,runs,non_reciprocity,non_reciprocity_error,force,force_error,speed,speed_error,"
    "thrust,thrust_error";

app::CaseResults case_of(const std::string& name) {
    app::CaseResults one;
    one.row.name = name;
    one.row.bead_radius = 0.5;
    one.row.phi_b = 0.75;
    one.row.runs = 3;
    return one;
}

} // namespace

TEST_CASE("The kinds of measures tell of every file, column and value of a measured run",
          "[measured][threads]") {
    const Scratch scratch;
    const std::vector<Stage> both = {Stage::granular, Stage::measure};
    const auto plan = app::plan_run(measured_bed(), both, scratch / "run", {});
    REQUIRE(app::run(plan, scratch / "run", {}) == app::StageEnd::finished);
    CHECK(undescribed(scratch / "run") == std::set<std::string>{});
    nlohmann::json measured = json_of(scratch / "run/measure.json");
    CHECK(unequal(measured) == std::set<std::string>{});
    for (const app::MeasureKind& kind : app::measure_kinds())
        CHECK(measured.contains(kind.name));
    CHECK_THAT(content(scratch / "run/series.csv"), Catch::Contains(series_header));

    measured["order"]["chi2"]["stray"] = 1.0; // the comparison sees either
    measured["force"].erase("speed");
    CHECK(unequal(measured) == std::set<std::string>{"order.chi2.stray", "force.speed"});
}

TEST_CASE("series.csv has the columns of all measures where none was made", "[measured]") {
    const Scratch scratch;
    app::CaseResults forced = case_of("forced");
    forced.row.imposed_speed = 1.0;
    forced.row.force = {2.0, unknown_error, 1}; // no speed, no thrust
    app::write_series(scratch.path(), {case_of("bare"), forced});
    const std::string text = content(scratch / "series.csv");
    CHECK_THAT(text, Catch::Contains(series_header));
    CHECK_THAT(text, Catch::Contains("\nbare,0.75,,,,,,,,,,,,3,,,,,,,,"));
    CHECK_THAT(text, Catch::Contains("\nforced,0.75,,2,,,,,,,,,,3,,,2,,,,,"));
    CHECK_FALSE(fs::exists(scratch / "series.json"));
}

TEST_CASE("The catalogue has the columns of the measures with their units", "[measured]") {
    const app::FileKind* series = app::kind_of("series.csv");
    REQUIRE(series);
    CHECK(app::column_of(*series, "stiffness")->unit == "1/a^2");
    CHECK(app::column_of(*series, "stiffness_error")->unit == "1/a^2");
    CHECK(app::column_of(*series, "class_error") == nullptr);
    const app::FileKind* profile = app::kind_of("profile_Ux_x.csv");
    REQUIRE(profile);
    CHECK(profile->stage == Stage::measure);
    CHECK(app::column_of(*profile, "value")->unit == "a");
}

TEST_CASE("The tables of a run are read when they are asked for", "[measured]") {
    const Scratch scratch;
    const app::RunTables tables = app::run_tables(scratch.path());
    CHECK_THROWS_WITH(tables.summary("T_xy", "T_xy"),
                      (scratch / "summary.json").string() + ": no T_xy; make the granular run again");
    scratch.file("summary.json", R"({"rods": [{"force": 1.5}, {"force": "much"}]})");
    scratch.file("tracks.csv", "t,x0,y0\n0,1,2\n0.5,3,4\n");
    CHECK(tables.summary("rods.0.force", "force") == 1.5);
    CHECK_THROWS_AS(tables.summary("rods.1.force", "force"), InputError);
    CHECK_THROWS_AS(tables.summary("rods.2.force", "force"), InputError);
    CHECK(tables.tracks({"y0", "t"}) == std::vector<app::Column>{{2.0, 4.0}, {0.0, 0.5}});
    CHECK_THROWS_AS(tables.tracks({"theta0"}), InputError);
}
