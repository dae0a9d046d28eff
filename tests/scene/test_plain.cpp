#include "rodwake/scene/read.hpp"
#include "support.hpp"

#include <catch2/catch.hpp>

using namespace scene_test;

TEST_CASE("a plain scene has every key and no comment, and means the same") {
    const rodwake::scene::Scene scene = parse(complete);
    const std::string plain = rodwake::scene::to_plain_toml(scene), full = rodwake::scene::to_toml(scene);
    CHECK(full.find("\n#") != std::string::npos);
    CHECK(plain.find("\n#") == std::string::npos);
    CHECK(plain.find("kappa = 0.5\n") != std::string::npos);
    CHECK(parse(plain) == scene);
    CHECK(rodwake::scene::to_plain_toml(parse(bed("seed = 2\n"))) !=
          rodwake::scene::to_plain_toml(parse(bed())));
}
