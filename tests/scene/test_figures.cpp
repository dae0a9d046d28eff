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

void check_round_trip(const Scene& scene) {
    CHECK(rodwake::scene::parse_scene(rodwake::scene::to_toml(scene), scene.path) == scene);
}

void says(const std::string& text, const std::string& part) {
    const std::string error = error_text(text);
    CAPTURE(error);
    CHECK(error.find(part) != std::string::npos);
}

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
    CHECK(rodwake::scene::to_toml(asked).find("component = \"Ux\"") != std::string::npos); // what plots read
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
