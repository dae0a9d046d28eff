// The record beside the results: who made them, with what.

#include "rodwake/store/provenance.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <regex>

using namespace rodwake;

TEST_CASE("Provenance says who, what, with what and when") {
    const std::string text = store::provenance_json(
        {"rodwake run \"a b\".toml", "a b.toml", "finished", 1ULL << 63, 1.5, {{"rods", "finished"}}});
    const auto json = nlohmann::json::parse(text);
    CHECK(json.at("program") == "rodwake");
    CHECK(json.at("status") == "finished");
    CHECK(json.at("command") == "rodwake run \"a b\".toml");
    CHECK(json.at("scene") == "a b.toml");
    CHECK(json.at("stages").at("rods") == "finished");
    CHECK(json.at("seed") == (1ULL << 63));
    CHECK(json.at("wall_seconds") == 1.5);
    CHECK(std::regex_match(json.at("date").get<std::string>(),
                           std::regex(R"(\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ)")));
    for (const char* key : {"version", "git", "compiler", "build"})
        CHECK_FALSE(json.at(key).get<std::string>().empty());
    CHECK_FALSE(json.at("cpu").at("model").get<std::string>().empty());
    CHECK(json.at("cpu").at("features").is_array());
    CHECK(json.at("libraries").contains("SUNDIALS"));
}

TEST_CASE("Provenance is JSON even if a file name is not UTF-8") {
    const auto json = nlohmann::json::parse(
        store::provenance_json({"rodwake run \xE9.toml", "\xE9.toml", "finished", 0, 0.0}));
    CHECK(json.at("scene") == "\xEF\xBF\xBD.toml"); // the replacement character
}
