#include "support.hpp"

#include <catch2/catch.hpp>
#include <fstream>
#include <set>
#include <sstream>

using namespace scene_test;

TEST_CASE("docs/scene.md is up to date") {
    std::ifstream in(RODWAKE_SOURCE_DIR "/docs/scene.md", std::ios::binary);
    REQUIRE(in.is_open());
    std::ostringstream text;
    text << in.rdbuf();
    INFO("regenerate with: rodwake info --scene-reference > docs/scene.md");
    const bool up_to_date = text.str() == rodwake::scene::scene_reference();
    CHECK(up_to_date);
}

TEST_CASE("the reference names every key once and every table") {
    const std::string text = rodwake::scene::scene_reference();
    std::set<std::string> names;
    for (const auto& info : rodwake::scene::scene_keys()) {
        INFO(full_name(info));
        CHECK(names.insert(full_name(info)).second);
        CHECK(text.find("| `" + info.name + "` | " + info.type + " |") != std::string::npos);
        CHECK_FALSE(info.legal.empty());
    }
    CHECK(names.size() == rodwake::scene::scene_keys().size());
    for (const std::string table :
         {"[scales]", "[medium]", "[medium.table]", "[coupling]", "[noise]", "[[rods]]", "[rods_run]",
          "[field]", "[[field.cuts]]", "[granular]", "[fit]", "[[fit.profiles]]", "[granular.plates]",
          "[granular.contacts.rod_rod]", "[granular.output]", "[[granular.rods]]", "[[figures]]",
          "[[variants]]"})
        CHECK(text.find("## `" + table + "`") != std::string::npos);
}

TEST_CASE("alternatives are documented as such, defaults that follow from other keys are not") {
    const std::string text = rodwake::scene::scene_reference();
    CHECK(text.find("Exactly one of: `xi`; `alpha`.") != std::string::npos);
    CHECK(text.find("of: `atol`") == std::string::npos);
    CHECK(text.find("| `atol` | number |  | rtol / 100 |") != std::string::npos);
}

TEST_CASE("[scales] and [granular] are documented in SI") {
    const std::set<std::string> si{"m", "s", "m/s", "1/s", "rad", "kg/m^3", "m/s^2"};
    for (const auto& info : rodwake::scene::scene_keys())
        if (info.table == "scales" || (info.table.starts_with("granular") && !info.unit.empty())) {
            INFO(full_name(info));
            CHECK(si.count(info.unit) == 1);
        }
}
