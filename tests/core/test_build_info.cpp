// What a provenance record says about the program is filled in.

#include "rodwake/core/build_info.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <regex>

TEST_CASE("Version, commit, compiler and libraries are known") {
    const rodwake::BuildInfo build = rodwake::build_info();
    CHECK(std::regex_match(build.version, std::regex(R"(\d+\.\d+\.\d+)")));
    CHECK(std::regex_match(build.git, std::regex("[0-9a-f]{7,40}(-dirty)?|unknown")));
    CHECK(std::regex_search(build.compiler, std::regex(R"(^\S+ \d+\.)")));
    CHECK_FALSE(build.flags.empty());
    for (const char* name :
         {"SUNDIALS", "Eigen", "Boost", "HDF5", "toml++", "CLI11", "fmt", "spdlog", "nlohmann-json"}) {
        CAPTURE(name);
        const auto found =
            std::ranges::find(build.libraries, name, &std::pair<std::string, std::string>::first);
        REQUIRE(found != build.libraries.end());
        CHECK(std::regex_search(found->second, std::regex(R"(^\d+\.\d+)")));
    }
}

TEST_CASE("The CPU has a name") { CHECK_FALSE(rodwake::cpu_model().empty()); }
