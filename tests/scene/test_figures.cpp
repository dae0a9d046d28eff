// The kinds of figures: one list, from which checks, choices and schema.json are made.

#include "support.hpp"

#include "rodwake/scene/read.hpp"
#include "scene/figure_kinds.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <set>

using namespace scene_test;
using rodwake::scene::figure_kinds;

namespace {

std::string figure_of(const std::string& kind, const std::string& more = "") {
    return "[[figures]]\nname = \"f\"\nkind = \"" + kind + "\"\n" + more;
}

const std::string measured_bed = "schema = 1\n[granular]\nphi_b = 0.8\nbox = \"40 a\"\nduration = 4.0\n"
                                 "[[granular.rods]]\nposition = [0.0, 0.0]\n"
                                 "[measure]\ndisplacement = \"phase\"\n";

std::string component_of(const std::string& kind, const std::string& more = "") {
    return parse(measured_bed + figure_of(kind, more)).figures[0].component;
}

} // namespace

TEST_CASE("every kind says what it needs of a scene that has nothing of it") {
    const std::string rods = two_rods("");
    const std::string bed = "schema = 1\n[granular]\nphi_b = 0.8\nbox = \"40 a\"\nduration = 4.0\n";
    for (const auto& kind : figure_kinds()) {
        INFO(kind.name);
        REQUIRE_FALSE(kind.needs.empty());
        const bool needs_rods =
            kind.needs.front().text == "[[rods]]"; // the one thing that the other scene has
        says((needs_rods ? bed : rods) + figure_of(kind.name),
             "a figure of kind " + kind.name + " needs " + std::string(kind.needs.front().text));
    }
}

TEST_CASE("kinds and their keys are keys and choices of [[figures]]") {
    std::set<std::string> keys, names;
    for (const auto& info : rodwake::scene::scene_keys())
        if (info.table == "figures[]") {
            keys.insert(info.name);
            if (info.name == "kind")
                names = {info.choices.begin(), info.choices.end()};
        }
    CHECK(names.size() == figure_kinds().size());
    for (const auto& kind : figure_kinds()) {
        INFO(kind.name);
        CHECK(names.count(kind.name) == 1);
        CHECK_FALSE(kind.files.empty());
        for (const auto& key : kind.keys) {
            INFO(key);
            CHECK(keys.count(key) == 1);
        }
    }
}

TEST_CASE("a key of figures is refused in every kind that has no use for it") {
    for (const auto& info : rodwake::scene::scene_keys()) {
        const auto has_key = [&](const auto& kind) { return std::ranges::count(kind.keys, info.name) > 0; };
        if (info.table != "figures[]" || info.name == "x" || info.name == "y" ||
            std::ranges::none_of(figure_kinds(), has_key))
            continue; // windows are no mistake anywhere
        // Examples of whole numbers are the defaults, which are no mistake either.
        const bool whole = info.name == "cut" || info.name == "frame" || info.name == "fps";
        const std::string value = whole ? "1" : info.example;
        for (const auto& kind : figure_kinds())
            if (!has_key(kind)) {
                const std::string setting = "figures.0." + info.name + "=" + value;
                says(two_rods(figure_of(kind.name)), "-s " + setting + ": " + info.name + " belongs to kind",
                     {setting});
            }
    }
}

TEST_CASE("a map shows the size of U unless a component is asked for") {
    CHECK(component_of("displacement_map") == "U");
    CHECK(component_of("displacement_map", "component = \"Ux\"\n") == "Ux");
    CHECK(component_of("displacement_map", "component = \"Uy\"\n") == "Uy");
    CHECK(component_of("profile") == "Ux");
    for (const std::string component : {"U", "Ux", "Uy"})
        check_round_trip(
            parse(measured_bed + figure_of("displacement_map", "component = \"" + component + "\"\n")));
    check_round_trip(parse(measured_bed + figure_of("displacement_map")));
    const Scene asked = parse(measured_bed + figure_of("displacement_map", "component = \"Ux\"\n"));
    CHECK_THAT(rodwake::scene::to_toml(asked), Catch::Contains("component = \"Ux\"")); // what plots read
    says(measured_bed + figure_of("profile", "component = \"U\"\n"),
         "U belongs to kind displacement_map only");
}

TEST_CASE("what a series shows has to be measured") {
    const std::string variant = "[[variants]]\nname = \"v\"\nset = { \"granular.phi_b\" = 0.6 }\n";
    for (const auto& kind : figure_kinds())
        for (const auto& [quantity, need] : kind.quantities) {
            INFO(quantity);
            says(measured_bed + figure_of(kind.name, "quantity = \"" + quantity + "\"\n") + variant,
                 "needs " + std::string(need.text));
        }
}

TEST_CASE("schema.json lists the kinds") {
    const auto figures = nlohmann::json::parse(rodwake::scene::schema_json()).at("figures");
    REQUIRE(figures.size() == figure_kinds().size());
    for (std::size_t i = 0; i < figures.size(); ++i) {
        CHECK(figures[i].at("kind") == figure_kinds()[i].name);
        CHECK(figures[i].at("needs").size() == figure_kinds()[i].needs.size());
        CHECK(figures[i].at("keys") == figure_kinds()[i].keys);
    }
}

// --- Figures of scans: their keys, what they need, how they are written

namespace {

/// A scan of two rods with a figure of the kind.
std::string figure(const std::string& kind, const std::string& more = "") {
    return two_rods("[medium]\neta = 1.0\nxi = 1.0\n[coupling]\nkappa = 1.0\n[scan]\ndesign = \"grid\"\n"
                    "[[scan.axes]]\nkey = \"coupling.kappa\"\nfrom = 0.1\nto = 10.0\ncount = 3\n"
                    "[[figures]]\nname = \"f\"\nkind = \"" +
                    kind + "\"\n" + more);
}

} // namespace

TEST_CASE("figures of scans have their own keys") {
    const Scene plain = parse(figure("phase_diagram"));
    CHECK(plain.figures[0].colour == "outcome");
    CHECK(plain.figures[0].boundary);
    CHECK_FALSE(plain.figures[0].cells);
    check_round_trip(plain);
    const Scene asked = parse(figure("phase_diagram", "colour = \"steps\"\ncells = true\nboundary = false\n"
                                                      "slices = [1.0, -2.5]\nx = [0.1, 3.0]\n"));
    CHECK(asked.figures[0].colour == "steps");
    CHECK(asked.figures[0].slices == std::vector{1.0, -2.5});
    check_round_trip(asked);
    const Scene curve = parse(figure("scan_curve", "column = \"time\"\n"));
    CHECK(curve.figures[0].column == "time");
    check_round_trip(curve);
}

TEST_CASE("the window of a scan's figure is in the numbers of its axes, whatever the units") {
    const std::string si = "units = \"si\"\n[scales]\nf_over_mu = \"0.88 mm\"\nv0 = \"2.8 mm/s\"\n";
    const Scene scene = parse(replaced(replaced(figure("phase_diagram", "x = [0.1, 3.0]\ny = [-2.0, 2.0]\n"),
                                                "schema = 1\n", "schema = 1\n" + si),
                                       "[medium]\neta = 1.0\nxi = 1.0", "[medium]\neta = 1.0\nalpha = 1.0"));
    CHECK(scene.figures[0].x == std::vector{0.1, 3.0});
    CHECK(scene.figures[0].y == std::vector{-2.0, 2.0});
    check_round_trip(scene);
}
