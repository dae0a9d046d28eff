#include "support.hpp"

#include <catch2/catch.hpp>
#include <fstream>
#include <nlohmann/json.hpp>
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

TEST_CASE("the schema holds every key with what the reference says of it") {
    const auto schema = nlohmann::json::parse(rodwake::scene::schema_json());
    const auto infos = rodwake::scene::scene_keys();
    REQUIRE(schema.at("keys").size() == infos.size());
    for (std::size_t i = 0; i < infos.size(); ++i) {
        const auto& key = schema.at("keys")[i];
        INFO(full_name(infos[i]));
        CHECK(key.at("table") == infos[i].table);
        CHECK(key.at("key") == infos[i].name);
        CHECK(key.at("meaning") == infos[i].meaning);
        CHECK(key.at("legal") == infos[i].legal);
        CHECK(key.contains("default") != key.at("required").get<bool>());
        CHECK(key.contains("unit") == !infos[i].unit.empty());
    }
}

TEST_CASE("the schema tells unit, symbol and range of a key") {
    const auto schema = nlohmann::json::parse(rodwake::scene::schema_json());
    const auto find = [&](const std::string& table, const std::string& name) {
        for (const auto& key : schema.at("keys"))
            if (key.at("table") == table && key.at("key") == name)
                return key;
        return nlohmann::json();
    };
    const auto kappa = find("coupling", "kappa");
    CHECK(kappa.at("symbol") == "\\kappa");
    for (const auto& key : schema.at("keys")) // a backslash too few makes one
        CHECK(std::ranges::none_of(key.value("symbol", std::string()), [](char c) { return c < ' '; }));
    CHECK(kappa.at("unit") == nlohmann::json{{"reduced", "mu v0/f"}, {"si", "1/s"}});
    CHECK(kappa.at("default") == "0.0");
    CHECK(find("medium", "eta").at("range") == nlohmann::json{{"above", -1.0}, {"to", 1e12}});
    CHECK(find("granular", "box").at("unit").at("reduced") == "m"); // SI whatever `units` says
    CHECK(find("granular", "start").at("choices").size() == 4);
    CHECK(find("figures[]", "fps").at("meaning") ==
          "kinds movie, rods_movie, medium_film: stored frames shown a second");
}

TEST_CASE("the reference names every key once and every table") {
    const std::string text = rodwake::scene::scene_reference();
    std::set<std::string> names;
    for (const auto& info : rodwake::scene::scene_keys()) {
        INFO(full_name(info));
        CHECK(names.insert(full_name(info)).second);
        CHECK_THAT(text, Catch::Contains("| `" + info.name + "` | " + info.type + " |"));
        CHECK_FALSE(info.legal.empty());
    }
    CHECK(names.size() == rodwake::scene::scene_keys().size());
    for (const auto& info : rodwake::scene::scene_keys()) {
        const std::string table = rodwake::scene::table_header(info.table);
        INFO(table);
        CHECK((info.table.empty() || text.find("## `" + table + "`") != std::string::npos));
    }
}

TEST_CASE("a key is found by the name that a scan or a setting has for it") {
    using rodwake::scene::key_info;
    const auto position = key_info("rods.1.position.0");
    REQUIRE(position);
    CHECK((position->table == "rods[]" && position->name == "position"));
    CHECK(key_info("granular.rods.0.kind").value().table == "granular.rods[]");
    CHECK(key_info("schema").value().table.empty());
    for (const char* none : {"", "coupling", "coupling.kapa", "rods.kappa", "0", "position"})
        CHECK_FALSE(key_info(none));
}

TEST_CASE("alternatives are documented as such, defaults that follow from other keys are not") {
    const std::string text = rodwake::scene::scene_reference();
    CHECK_THAT(text, Catch::Contains("Exactly one of: `xi`; `alpha`."));
    CHECK_THAT(text, !Catch::Contains("of: `atol`"));
    CHECK_THAT(text, Catch::Contains("| `atol` | number |  | rtol / 100 |"));
}

TEST_CASE("[scales] and [granular] are documented in SI") {
    const std::set<std::string> si{"m", "s", "m/s", "1/s", "rad", "kg/m^3", "m/s^2"};
    for (const auto& info : rodwake::scene::scene_keys())
        if (info.table == "scales" || (info.table.starts_with("granular") && !info.unit.empty())) {
            INFO(full_name(info));
            CHECK(si.count(info.unit) == 1);
        }
}
