// What a person sees: place, found, legal, nearest name.

#include "support.hpp"

#include <catch2/catch.hpp>

using namespace scene_test;

TEST_CASE("all problems of a file are listed at once, in order, with places") {
    const std::string text = "schema = 1\n"
                             "[medium]\n"
                             "eta = -2\n"
                             "  alpha = \"much\"\n"
                             "[coupling]\n"
                             "kapa = 1\n"
                             "[[rods]]\n"
                             "heading = true\n"
                             "[[rods]]\n"
                             "position = [0.0, \"abc\"]\n"
                             "[[rods]]\n"
                             "position = \"abc\"\n"
                             "[rods_run]\n"
                             "t_end = inf\n";
    CHECK(error_text(text) ==
          "x.toml:3:7: medium.eta = -2: must be > -1 and <= 1e+12: the longitudinal modulus 1 + eta must be "
          "positive\n"
          "x.toml:4:11: medium.alpha: expected a number, found \"much\" (string)\n"
          "x.toml:6:1: [coupling] unknown key \"kapa\" (did you mean \"kappa\"?). Known keys: kappa, gamma1, "
          "gamma2, "
          "polar_basis, gamma_flow, gamma_rows, rows_direction\n"
          "x.toml:7:1: rods[0] needs the key position, for example position = [0.0, 2.5]\n"
          "x.toml:8:11: rods[0].heading: expected an angle (a number, or a string such as \"30 deg\"), found "
          "true "
          "(boolean)\n"
          "x.toml:10:18: rods[1].position[1]: expected a length, found \"abc\" (string): a string must be a "
          "finite number "
          "and a unit: m, cm, mm, um, a, f/mu\n"
          "x.toml:12:12: rods[2].position: expected 2 numbers, found \"abc\" (string)\n"
          "x.toml:14:9: rods_run.t_end = inf: must be a finite number");
}

TEST_CASE("problems carry file, line, column and key") {
    const auto problems = problems_of("schema = 1\n[field]\nnx = 1\n[medium]\neta = 1\nxi = 1\n");
    REQUIRE(problems.size() == 1);
    CHECK(problems[0].file == "x.toml");
    CHECK(problems[0].line == 3);
    CHECK(problems[0].column == 6);
    CHECK(problems[0].key == "field.nx");
}

TEST_CASE("TOML errors have the same form") {
    const auto duplicate = error_text("schema = 1\nschema = 1\n");
    CHECK(duplicate.starts_with("x.toml:2:"));
    CHECK(duplicate.find(": not valid TOML: ") != std::string::npos);
    CHECK(duplicate.find("redefine") != std::string::npos);
    CHECK(error_text("schema = \n").starts_with("x.toml:1:10: not valid TOML: "));
    CHECK(error_text("a = \"open\n").starts_with("x.toml:1:"));
}

TEST_CASE("conflicting and missing forms name all places") {
    const std::string start = "schema = 1\n[field]\nx = [0, 1]\ny = [0, 1]\n[medium]\n";
    CHECK(
        error_text(start + "eta = 1\nxi = 1\npoisson_ratio = 0.1\n") ==
        "x.toml:8:1: medium gives eta (line 6) and poisson_ratio (line 8): give one of eta | poisson_ratio | "
        "lame_lambda + mu | bulk_modulus + mu");
    CHECK(error_text(start + "eta = 1\nxi = 1\nalpha = 1\n") ==
          "x.toml:8:1: medium gives xi (line 7) and alpha (line 8): give one of xi | alpha");
    CHECK(error_text(start + "eta = 1\n") == "x.toml:5:1: medium needs one of xi | alpha");
    CHECK(error_text(start + "xi = 1\nmu = 1\n").find("medium gives mu (line 7): give one of") !=
          std::string::npos);
    CHECK(error_text(two_rods("output_interval = 0.1\noutput_times = [1.0]\n"))
              .find("gives t_end (line 7) and output_interval (line 8) and output_times (line 9): give one "
                    "of ") != std::string::npos);
}

TEST_CASE("elastic forms that give an impossible eta are refused") {
    const std::string start = "schema = 1\n[field]\nx = [0, 1]\ny = [0, 1]\n[medium]\nxi = 1\n";
    CHECK(error_text(start + "lame_lambda = -2.0\nmu = 1.0\n") ==
          "x.toml:7:15: medium.lame_lambda is not usable: lame_lambda = -2: must be > -2 mu");
    CHECK(error_text(start + "bulk_modulus = 1e12\nmu = 1e-12\n").find("eta = 1e+24: must be > -1") !=
          std::string::npos);
    CHECK(error_text(start + "bulk_modulus = -1.0\nmu = 1.0\n") ==
          "x.toml:7:16: medium.bulk_modulus is not usable: bulk_modulus = -1: must be > -mu");
    CHECK(error_text(start + "lame_lambda = -1.9\nmu = 1.0\n") == "");
    CHECK(parse(start + "bulk_modulus = -0.5\nmu = 1.0\n").medium->eta == -0.5);
}

TEST_CASE("a key in the wrong table is sent to the right one") {
    CHECK(error_text("schema = 1\n[medium]\neta = 1\nxi = 1\nkappa = 1\n[field]\nx = [0, 1]\ny = [0, 1]\n")
              .find("[medium] unknown key \"kappa\" ([coupling] has it). Known keys: eta, ") !=
          std::string::npos);
}

TEST_CASE("tables and lists of the wrong kind") {
    CHECK(error_text("schema = 1\nmedium = 3\n")
              .find("x.toml:2:10: medium: expected a table [medium], found 3 (integer)") !=
          std::string::npos);
    CHECK(error_text("schema = 1\n[rods]\nposition = [0, 0]\n")
              .find("rods: expected entries [[rods]], found a table") != std::string::npos);
    CHECK(error_text("schema = 1\nrods = [1]\n")
              .find("rods[0]: expected a table [[rods]], found 1 (integer)") != std::string::npos);
    CHECK(error_text("schema = 1\n[fieldd]\n")
              .find("unknown table or key \"fieldd\" (did you mean \"field\"?)") != std::string::npos);
}

TEST_CASE("a missing schema is asked for") {
    CHECK(error_text("[field]\n").find("the scene needs the key schema, for example schema = 1") !=
          std::string::npos);
}

TEST_CASE("a long list of problems is cut") {
    std::string text = two_rods();
    for (int i = 0; i < 60; ++i)
        text += "wrong" + std::to_string(i) + " = 1\n";
    const std::string message = error_text(text);
    CHECK(std::count(message.begin(), message.end(), '\n') == 50); // 50 problems and the count of the rest
    CHECK(message.ends_with("\n... and 10 more"));
    CHECK(problems_of(text).size() == 60);
}

TEST_CASE("long values are shortened") {
    const auto message = error_text(two_rods(), {"rods_run.method=" + std::string(1000, 'x')});
    CHECK(message.find("rods_run.method: ") == std::string::npos);
    CHECK(message.find(std::string(30, 'x').append("...")) != std::string::npos);
}
