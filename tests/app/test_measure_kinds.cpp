// The list of measures, and those that are made from the runs' own tables.

#include "bed/measure_kind.hpp"
#include "bed/series_row.hpp"
#include "rodwake/app/plan.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/scene/read.hpp"
#include "rodwake/store/csv.hpp"
#include "run_files.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

using namespace rodwake;
using app::Column, app::MeasureKind;
using nlohmann::ordered_json;
using store_test::Scratch;

namespace {

const std::string bed_text = R"(schema = 1
[granular]
phi_b = 0.7
box = "30 a"
duration = "1 s"
[[granular.rods]]
position = ["5 a", "6 a"]
[[granular.rods]]
position = ["5 a", "20 a"]
[measure]
)";

scene::Scene bed(const std::string& keys) { return scene::parse_scene(bed_text + keys, "scene.toml"); }

const MeasureKind& kind_of(std::string_view name) {
    return *std::ranges::find(app::measure_kinds(), name, &MeasureKind::name);
}

std::string key_text(const std::string& keys) {
    const scene::Scene scene = bed(keys);
    return app::measure_plan(scene, app::granular_problem(scene)).value().key_text;
}

/// Runs that wrote these numbers, each the same tracks.
std::vector<app::RunTables> made_up(const std::vector<double>& numbers,
                                    const std::vector<Column>& tracks = {}) {
    std::vector<app::RunTables> runs;
    for (double number : numbers)
        runs.push_back({[number](const std::string&, const std::string&) { return number; },
                        [tracks](const std::vector<std::string>&) { return tracks; }});
    return runs;
}

app::MeasureReport report_of(std::string_view name, std::vector<app::RunTables> runs) {
    const scene::Scene scene = bed(std::string(name) + " = true");
    app::SeriesRow row;
    return kind_of(name).report({scene, {}, std::move(runs), row});
}

Estimate estimate_of(const ordered_json& value) {
    const auto number = [&](const char* part) {
        return value.at(part).is_null() ? std::nan("") : value.at(part).get<double>();
    };
    return {number("value"), number("error"), value.at("samples").get<std::size_t>()};
}

store::Table table_of(const app::CsvFile& file) {
    const Scratch scratch;
    const std::filesystem::path path = scratch.file(file.name, file.text);
    return store::read_csv(path, {}, store::csv_names(path));
}

app::SeriesRow row(std::optional<double> speed, double force, double error) {
    app::SeriesRow row;
    row.imposed_speed = speed;
    row.force = {force, error, 5};
    return row;
}

} // namespace

TEST_CASE("A measure has a file of its name, a place of its own, and all that is asked of it") {
    std::set<std::string> files, names;
    for (const auto& file : std::filesystem::directory_iterator(RODWAKE_SOURCE_DIR "/app/bed/measures"))
        files.insert(file.path().stem().string());
    std::set<int> places;
    for (const MeasureKind& kind : app::measure_kinds()) {
        INFO(kind.name);
        names.emplace(kind.name);
        CHECK(places.insert(kind.order).second);
        CHECK((kind.wanted && kind.describe && kind.report));
        std::set<std::string_view> keys;
        for (const ColumnInfo& value : kind.values())
            CHECK(keys.insert(value.name).second);
        CHECK_FALSE(keys.empty());
    }
    CHECK(names == files);
    CHECK(std::ranges::is_sorted(app::measure_kinds(), {}, &MeasureKind::order));
}

TEST_CASE("The measures that stored states know keep their order") {
    std::vector<std::string_view> names;
    for (const MeasureKind& kind : app::measure_kinds())
        if (kind.order <= 60)
            names.push_back(kind.name);
    CHECK(names ==
          std::vector<std::string_view>{"order", "microrheology", "flow", "displacement", "pairs", "force"});
}

TEST_CASE("Keys that matter only when runs are put together leave the sums as they are") {
    for (const char* keys :
         {"", "pairs = true\ncontact_distance = \"9 a\"\n", "force = true\n",
          "profile_offset = \"5 a\"\nreference = \"far\"\nmirror = true\n", "s_low = 0.1\ns_high = 0.4\n",
          "trajectory = \"other.h5md\"\n", "shear_speed = \"120 a/s\"\n", "inertia_factor = 1.3\n",
          "heading_diffusion = true\nheading_lag_low = 0.02\nheading_lag_high = 0.2\n",
          "phonon_interval = \"5 ms\"\n"})
        CHECK(key_text(std::string("order = true\n") + keys) == key_text("order = true\n"));
    CHECK(key_text("order = true\norder_cutoff = \"2.9 a\"\n") != key_text("order = true\n"));
    CHECK(key_text("order = true\nflow = true\n") != key_text("order = true\n"));
    CHECK(key_text("order = true\nfrom_travel = \"2 a\"\n") != key_text("order = true\n"));
}

TEST_CASE("Currents have frames of their own, the other measures go by measure.interval") {
    const std::string base = "phonons = true\norder = true\norder_interval = 0.1\nmicrorheology = true\n"
                             "interval = 0.02\nblock = 0.25\n";
    const auto plan_of = [](const std::string& keys) {
        const scene::Scene scene = bed(keys);
        return app::measure_plan(scene, app::granular_problem(scene)).value();
    };
    const app::MeasurePlan plan = plan_of(base);
    CHECK(plan.interval == Approx(0.005));
    CHECK(plan.stride == 4);
    CHECK(plan.sums.stride("phonons") == 1);
    CHECK(plan.sums.stride("microrheology") == 4);
    CHECK(plan.sums.stride("order") == 20);
    CHECK(plan_of(base + "phonon_interval = 0.004\n").stride == 5);
    CHECK(key_text(base + "phonon_interval = 0.005\n") == key_text(base));
    CHECK(key_text(base + "phonon_interval = 0.004\n") != key_text(base));
    CHECK_THROWS_WITH(plan_of(base + "phonon_interval = 0.0028571428571\n"), // a seventh, 28.57 steps
                      Catch::Matchers::Contains("no whole multiple of its 29 steps"));
}

TEST_CASE("A measure without frames does not ask for new ones") {
    for (const MeasureKind& kind : app::measure_kinds())
        if (!kind.include) {
            INFO(kind.name);
            const scene::Scene scene = bed(std::string(kind.name) + " = true\n");
            CHECK(kind.wanted(*scene.measure));
            CHECK_FALSE(app::measure_plan(scene, app::granular_problem(scene)));
            CHECK(key_text(std::string(kind.name) + " = true\norder = true\n") == key_text("order = true\n"));
        }
}

TEST_CASE("Force and speed are means over the runs") {
    const auto report = report_of("force", made_up({1e-6, 3e-6}));
    const auto force = estimate_of(report.values["force"]);
    CHECK(force.value == Approx(2e-6));
    CHECK(force.error == Approx(1e-6)); // s/sqrt(2), s = 1.414e-6
    CHECK(force.count == 2);
    const double a = bed("force = true").granular->bead_radius;
    CHECK(estimate_of(report.values["thrust"]).value == Approx(2e-6));
    CHECK(estimate_of(report.values["speed"]).value == Approx(2e-6 / a)); // a/s
    CHECK_FALSE(estimate_of(report_of("force", made_up({1e-6})).values["force"]).known());
}

TEST_CASE("A run without its tables is an error of that measure") {
    auto runs = made_up({1e-6});
    runs[0].summary = [](const std::string& name, const std::string&) -> double { throw InputError(name); };
    CHECK_THROWS_WITH(report_of("force", runs), "rods.0.force");
}

TEST_CASE("Force against imposed speed: lines through three speeds or more") {
    const auto compare = kind_of("force").compare;
    std::vector<app::SeriesRow> rows = {row(1e-3, 3e-6, 1e-8), row(2e-3, 5e-6, 1e-8)};
    CHECK(compare(rows).empty());
    rows.push_back(row({}, 9e-6, 1e-8));            // a free rod
    rows.push_back(row(5e-3, 9e-6, unknown_error)); // a single run
    CHECK(compare(rows).empty());
    rows.push_back(row(3e-3, 7e-6, 1e-8));
    const auto line = compare(rows)["force_against_imposed_speed"]["line"];
    CHECK(line["intercept_N"]["value"].get<double>() == Approx(1e-6));
    CHECK(line["slope_N_s_per_m"]["value"].get<double>() == Approx(2e-3));
    CHECK(line["dof"] == 1);
}

TEST_CASE("A pair is followed from t = 0 on") {
    const double a = bed("pairs = true").granular->bead_radius;
    // Beside each other, heading along x, and parting from 10 a to 14 a; before t = 0 somewhere else.
    std::vector<Column> tracks(7);
    for (int i = -3; i <= 40; ++i) {
        const double t = 0.1 * i, y = i < 0 ? 3.0 : 5.0 + 2.0 * t / 4.0;
        const double places[] = {t, 2.0 * t * a, y * a, 0.0, 2.0 * t * a, -y * a, 0.0};
        for (std::size_t k = 0; k < 7; ++k)
            tracks[k].push_back(places[k]);
    }
    const auto report = report_of("pairs", made_up({0.0, 0.0}, tracks));
    REQUIRE(report.tables.size() == 1);
    const store::Table table = table_of(report.tables[0]);
    CHECK(*table.find("run") == Column{1.0, 2.0});
    CHECK(table.find("separation")->at(0) == Approx(10.0)); // 6 if the rows before were taken along
    CHECK(table.find("last_change")->at(0) == Approx(4.0));
    CHECK(report.values["not_there"] == 2); // 8 a of 15 a
}

TEST_CASE("Heading diffusion becomes the noise of the theory in its units, with f/mu of [scales]") {
    const double a = bed("").granular->bead_radius, speed = 5.0 * a;
    std::vector<Column> tracks(4); // headings jump by 0.1 to either side: <d^2> grows by 0.01 every 0.02 s
    double x = 0.0, y = 0.0, theta = 0.0;
    std::uint32_t bits = 0x5a17c3e5; // a pseudo-random walk
    for (int i = -3; i <= 1000; ++i) {
        const double row[] = {0.02 * i, x, y, theta};
        for (std::size_t k = 0; k < 4; ++k)
            tracks[k].push_back(row[k]);
        bits = bits * 1664525u + 1013904223u;
        const double jump = i < 0 ? 0.0 : bits >> 31 ? 0.1 : -0.1;
        x += i < 0 ? 1.0 : speed * 0.02 * std::cos(theta + 0.5 * jump); // the rows before t = 0 do not count
        y += i < 0 ? 0.0 : speed * 0.02 * std::sin(theta + 0.5 * jump);
        theta += jump;
    }
    const auto of = [&](const std::string& scales) {
        const scene::Scene scene =
            scene::parse_scene(bed_text + "heading_diffusion = true\nblock = 0.8\n" + scales, "scene.toml");
        app::SeriesRow row;
        return kind_of("heading_diffusion").report({scene, {}, made_up({0.0}, tracks), row});
    };
    const auto papers = of(""), scaled = of("[scales]\nf_over_mu = \"4.4 a\"\nv0 = \"2 mm/s\"\n");
    const auto D = estimate_of(papers.values["D_r"]);
    CHECK(D.value == Approx(0.25).epsilon(0.5)); // 20 s hold 100 times the longest lag
    const auto reduced = estimate_of(papers.values["rotational_diffusion"]);
    const auto walked = estimate_of(papers.values["speed"]);
    CHECK(walked.value == Approx(5.0));
    CHECK(reduced.value == Approx(2.2 * D.value / walked.value));
    CHECK(estimate_of(scaled.values["rotational_diffusion"]).value == Approx(2.0 * reduced.value));
    CHECK(scaled.values["f_over_mu"].get<double>() == Approx(4.4));
    CHECK_THAT(papers.line, Catch::Contains("[noise] rotational_diffusion = "));
    REQUIRE(papers.tables.size() == 1);
    const store::Table changes = table_of(papers.tables[0]);
    CHECK(changes.find("lag")->back() == Approx(0.2));
    CHECK(changes.find("square")->at(0) == Approx(0.01)); // one row: a jump of 0.1
}

TEST_CASE(
    "The drag of the bed is that of the push of both rods; the speed of sound is a key or that of phonons") {
    const scene::Scene scene = bed("mechanics = true\nrod = 1\nblock = 0.5\nshear_speed = \"100 a/s\"\n");
    const double a = scene.granular->bead_radius, drift = 0.5 * a, gamma = 8.0, advance = 10.0 * a;
    const granular::GranularProblem problem = app::granular_problem(scene);
    const measure::Layout layout = app::layout_of(problem);
    const double push = gamma * static_cast<double>(layout.beads) * layout.bead_mass * drift / 2.0;
    std::vector<Column> tracks(5); // both rods do the same, along x; held before t = 0
    for (int i = -3; i <= 100; ++i) {
        const double t = 0.01 * i, since = std::max(0.0, t);
        const double row[] = {t, advance * since, 0.0, 0.0, push * since};
        for (std::size_t k = 0; k < 5; ++k)
            tracks[k].push_back(row[k]);
    }
    std::vector<measure::Measures> sums = {app::measure_plan(scene, problem).value().sums};
    measure::Frame frame;
    for (auto* column : {&frame.x, &frame.y, &frame.unwrapped_x, &frame.unwrapped_y, &frame.vx, &frame.vy})
        column->assign(layout.beads, 5.0 * a);
    frame.rods.resize(2);
    for (int i = 0; i <= 10; ++i) {
        frame.time = 0.1 * i;
        frame.unwrapped_x.assign(layout.beads, 5.0 * a + drift * frame.time);
        sums[0].add(frame);
    }
    const auto report_on = [&](const scene::Scene& of, std::vector<app::RunTables> runs, app::SeriesRow row) {
        std::vector<measure::Measures> own = sums; // a report takes them out
        return kind_of("mechanics").report({of, own, std::move(runs), row});
    };
    const auto report = report_on(scene, made_up({0.0}, tracks), {});
    CHECK(estimate_of(report.values["drag_rate"]).value == Approx(gamma));
    CHECK(estimate_of(report.values["speed"]).value == Approx(9.5));
    CHECK(estimate_of(report.values["screening_length"]).value == Approx(1e4 / (gamma * 9.5)));
    CHECK(report.values["verdict"].get<std::string>().find("exceeds the box of 30 a") != std::string::npos);
    CHECK_FALSE(report.values["steady"].get<bool>()); // 10 a
    CHECK(estimate_of(report.values["used_inertia"]).count == 0);
    CHECK(report.values["inertia_source"].get<std::string>().find("bare mass") != std::string::npos);
    CHECK(report.values["decay_absence"].get<std::string>().find("0.1 s apart") != std::string::npos);
    CHECK_THAT(report.line, Catch::Contains("too short for a steady wake"));

    const scene::Scene heavier = bed("mechanics = true\nrod = 1\nblock = 0.5\nshear_speed = \"100 a/s\"\n"
                                     "inertia_factor = 1.25\ninertia_error = 0.05\n");
    const auto with_inertia = report_on(heavier, made_up({0.0}, tracks), {});
    CHECK(estimate_of(with_inertia.values["screening_length"]).value == Approx(1.25e4 / (gamma * 9.5)));
    CHECK(estimate_of(with_inertia.values["screening_length"]).error ==
          Approx(0.04 * 1.25e4 / (gamma * 9.5))); // nothing else has an error

    const scene::Scene without = bed("mechanics = true\nblock = 0.5\n");
    const auto drag_alone = report_on(without, made_up({0.0}, tracks), {});
    CHECK(estimate_of(drag_alone.values["screening_length"]).count == 0);
    app::SeriesRow earlier;
    earlier.c_T = {100.0, 1.0, 8};
    const auto with_phonons = report_on(without, made_up({0.0}, tracks), earlier);
    CHECK(estimate_of(with_phonons.values["screening_length"]).value == Approx(1e4 / (gamma * 9.5)));
    CHECK_THROWS_WITH(report_on(without, {}, {}), Catch::Matchers::Contains("tracks.csv"));
}
