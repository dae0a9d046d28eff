#include "rodwake/scene/read.hpp"
#include "support.hpp"

#include <catch2/catch.hpp>

using namespace scene_test;

TEST_CASE("overrides replace values, entries of lists go by index") {
    const Scene scene = parse(
        complete, {"coupling.kappa=2", "rods.1.position.0=2.0", "rods.0.heading=0.3", "rods_run.method=adams",
                   "title=two words", "rods_run.t_end=5 f/(mu v0)", " medium.eta = 3 ", "field.x=[-1, 1]"});
    CHECK(scene.coupling->kappa == 2.0);
    CHECK(scene.rods[1].position == std::vector{2.0, -2.5});
    CHECK(scene.rods[0].heading == 0.3);
    CHECK(scene.rods_run->method == rodwake::integrate::Method::adams);
    CHECK(scene.title == "two words");
    CHECK(scene.rods_run->t_end == 5.0);
    CHECK(scene.medium->eta == 3.0);
    CHECK(scene.field->x == std::vector{-1.0, 1.0});
}

TEST_CASE("later overrides win, missing tables are made") {
    CHECK(parse(complete, {"coupling.kappa=2", "coupling.kappa=3"}).coupling->kappa == 3.0);
    CHECK(parse(two_rods(), {"coupling.kappa=2", "medium.eta=1", "medium.xi=2"}).medium->xi == 2.0);
}

TEST_CASE("an override of one form drops the others of the file") {
    CHECK(parse(complete, {"medium.xi=4"}).medium->xi == 4.0); // the file gives alpha
    CHECK(parse(complete, {"medium.poisson_ratio=0.0"}).medium->eta == 1.0);
    CHECK(parse(complete, {"medium.lame_lambda=1.0", "medium.mu=0.5"}).medium->eta == 3.0);
    CHECK(
        parse(two_rods("output_times = [1.0]\n"), {"rods_run.output_interval=0.5"}).rods_run->output_times ==
        std::vector{0.5, 1.0, 1.5, 2.0});
    const std::string lame = replaced(complete, "eta = 1.0", "lame_lambda = 1.0\nmu = 1.0");
    CHECK(parse(lame, {"medium.mu=0.5"}).medium->eta == 3.0);
    CHECK(error_text(complete, {"medium.xi=4", "medium.alpha=2"}).find("give one of xi | alpha") !=
          std::string::npos);
}

TEST_CASE("errors of overrides name the override") {
    CHECK(error_text(complete, {"coupling.kapa=1"})
              .starts_with("-s coupling.kapa=1: [coupling] unknown key \"kapa\" (did you mean \"kappa\"?). "
                           "Known keys: kappa, "));
    CHECK(error_text(complete, {"medium.eta=-2"})
              .starts_with("-s medium.eta=-2: medium.eta = -2: must be > -1"));
    CHECK(error_text(complete, {"rods.1.position.0=oops"})
              .starts_with("-s rods.1.position.0=oops: rods[1].position[0]: "));
    CHECK(error_text(complete, {"rods.2.heading=0"}) ==
          "-s rods.2.heading=0: no entry 2: rods has 2 (numbered from 0)");
    CHECK(error_text(complete, {"rods.-1.heading=0"}).find("rods is a list: give an index from 0 after it") !=
          std::string::npos);
    CHECK(error_text(complete, {"rods.99999999999999999999.heading=0"}).find("rods is a list") !=
          std::string::npos);
    CHECK(error_text(complete, {"rods.heading=0"})
              .find("rods is a list: give an index from 0 after it, not \"heading\"") != std::string::npos);
    CHECK(error_text(complete, {"schema.x=0"}) == "-s schema.x=0: schema is not a table: 1 (integer)");
    CHECK(error_text("schema = 1\n", {"rods.0.heading=0"})
              .starts_with("-s rods.0.heading=0: no entry 0: the scene has no"));
    CHECK(error_text(complete, {"coupling.kappa=[1"})
              .starts_with("-s coupling.kappa=[1: the value is not valid TOML: "));
    CHECK(error_text(complete, {"coupling.kapa="}) ==
          "-s coupling.kapa=: nothing to unset: coupling has no kapa (did you mean \"kappa\"?)");
    CHECK(error_text(complete, {"rods.2="}) == "-s rods.2=: no entry 2: rods has 2 (numbered from 0)");
    CHECK(error_text(complete, {"nothing="}) == "-s nothing=: nothing to unset: the scene has no nothing");
    CHECK(error_text(complete, {"schema="}).find("the scene needs the key schema") != std::string::npos);
    CHECK(error_text(complete, {"coupling.kappa=-1e400"}) ==
          "-s coupling.kappa=-1e400: -1e400 is too large for a number, which ends at 1.8e308");
    CHECK(error_text(complete, {"title=a\nb = 1"}).find("a value is one line") != std::string::npos);
    for (const std::string bad : {"nothing", "=1", "a..b=1", ".a=1", "a.=1", ""})
        CHECK(error_text(complete, {bad}) ==
              "-s " + bad + ": expected table.key=value, for example coupling.kappa=0.5");
}

TEST_CASE("several wrong overrides and the file's own errors come together") {
    const std::string text = replaced(complete, "kappa = 0.5", "kapa = 0.5");
    const auto problems = problems_of(text, {"medium.eta=-2", "nonsense", "rods.7.heading=1"});
    CHECK(problems.size() == 4);
}

TEST_CASE("a key, a table and an entry of a list are taken out") {
    CHECK(parse(complete, {"coupling.kappa="}).coupling->kappa == 0.0);
    CHECK(!parse(two_rods("[coupling]\nkappa = 1\n[medium]\neta = 1\nxi = 1\n"), {"coupling= "}).coupling);
    CHECK(parse(two_rods(), {"rods.0="}).rods.size() == 1);
}

TEST_CASE("numbers that TOML writes otherwise") {
    CHECK(parse(complete, {"coupling.kappa=.5"}).coupling->kappa == 0.5);
    CHECK(parse(complete, {"coupling.kappa = 5."}).coupling->kappa == 5.0);
    CHECK(error_text(replaced(complete, "kappa = 0.5", "kappa = 1e400"))
              .find("1e400 is too large for a number") != std::string::npos);
}

TEST_CASE("angles that were meant in degrees are pointed out") {
    using rodwake::scene::advice;
    CHECK(advice(parse(complete)).empty());
    CHECK(advice(parse(complete, {"rods.1.heading=6.28"})).empty());
    CHECK(advice(parse(complete, {"rods.1.heading=90 deg"})).empty());
    CHECK(advice(parse(complete, {"rods.1.heading=-90"})) ==
          std::vector<std::string>{
              "rods[1].heading = -90 rad is -14.3 turns; a plain number is in rad, degrees are "
              "written as \"90 deg\""});
}
