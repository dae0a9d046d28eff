// What the program knows of scenes and results, and the copy of it that the plots read.

#include "rodwake/app/describe.hpp"
#include "rodwake/app/measure_kind.hpp"
#include "rodwake/scene/document.hpp"

#include <catch2/catch.hpp>

#include <fstream>
#include <iterator>

using namespace rodwake;

TEST_CASE("the plots' schema.json is up to date") {
    std::ifstream in(RODWAKE_SOURCE_DIR "/plots/rodwake_plots/schema.json", std::ios::binary);
    REQUIRE(in.is_open());
    const std::string kept{std::istreambuf_iterator<char>(in), {}};
    INFO("regenerate with: ninja reference");
    const bool up_to_date = kept == app::schema_json();
    CHECK(up_to_date);
}

TEST_CASE("The schema is that of scenes and a line for each value that is measured") {
    const std::string of_scenes = scene::schema_json(), all = app::schema_json();
    const std::string end = "\n}\n";
    CHECK(all.starts_with(of_scenes.substr(0, of_scenes.size() - end.size()) + ",\n \"measures\": [\n"));
    for (const app::MeasureKind& kind : app::measure_kinds())
        for (const app::ValueInfo& value : kind.values) {
            const std::string entry = "\n  {\"measure\":\"" + std::string(kind.name) + "\",\"key\":\"" +
                                      std::string(value.key) + "\",";
            INFO(entry);
            const auto at = all.find(entry);
            REQUIRE(at != std::string::npos);
            const std::string line = all.substr(at, all.find('\n', at + 1) - at);
            CHECK((line.find("\"title\":") == std::string::npos) == value.title.empty());
            CHECK((line.find("\"factor\":") == std::string::npos) == value.is_text);
        }
}
