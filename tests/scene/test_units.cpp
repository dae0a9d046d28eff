#include "scene/units.hpp"
#include "support.hpp"

#include <catch2/catch.hpp>
#include <numbers>

using namespace scene_test;
using rodwake::scene::Dimension;
using rodwake::scene::Scales;
using rodwake::scene::Units;
using rodwake::scene::UnitSystem;

namespace {

// f/mu = 0.5 mm and v0 = 2 mm/s: the unit of time is 0.25 s.
const std::string scales = "[scales]\nf_over_mu = 0.0005\nv0 = 0.002\n";

const std::string si = "schema = 1\nunits = \"si\"\n" + scales + R"([medium]
eta = 1.0
xi = 0.005
[coupling]
kappa = 2.0
gamma1 = 0.02
gamma2 = "-4 mm/s"
[[rods]]
position = [0.0, "1.25 mm"]
heading = "90 deg"
[[rods]]
position = [0.0, -0.00125]
[rods_run]
t_end = "7.5 s"
output_times = [2.5, 5]
contact_distance = "50 um"
[field]
x = [-0.0025, "5 f/mu"]
y = [-0.002, "5 a"]
[[field.cuts]]
at = 0.0005
from = -0.01
to = "0.25 cm"
)";

const std::string reduced = "schema = 1\nunits = \"reduced\"\n" + scales + R"([medium]
eta = 1.0
xi = 10.0
[coupling]
kappa = 0.5
gamma1 = 10.0
gamma2 = -2.0
[[rods]]
position = [0.0, 2.5]
heading = 1.5707963267948966
[[rods]]
position = [0.0, -2.5]
[rods_run]
t_end = 30.0
output_times = [10.0, 20.0]
contact_distance = 0.1
[field]
x = [-5.0, 5.0]
y = [-4.0, 4.0]
[[field.cuts]]
at = 1.0
from = -20.0
to = 5.0
)";

// Two roundings (scale, division) on top of that of the literal: 2 units in the last place.
Approx close(double value) { return Approx(value).epsilon(4.5e-16).margin(0.0); }

double value_of(const std::string& text, Dimension dimension) {
    const Units units{UnitSystem::reduced, Scales{0.0005, 0.002, 0.0004}, true};
    const auto found = rodwake::scene::parse_quantity(text, dimension, units);
    REQUIRE(found.value);
    return *found.value;
}

} // namespace

TEST_CASE("the same scene in SI and in reduced units") {
    const Scene a = parse(si), b = parse(reduced);
    CHECK(a.medium->xi == close(b.medium->xi));
    CHECK(a.coupling->kappa == close(b.coupling->kappa));
    CHECK(a.coupling->gamma1 == close(b.coupling->gamma1));
    CHECK(a.coupling->gamma2 == close(b.coupling->gamma2));
    for (std::size_t i = 0; i < 2; ++i) {
        CHECK(a.rods[i].position[1] == close(b.rods[i].position[1]));
        CHECK(a.rods[i].heading == close(b.rods[i].heading));
        CHECK(a.field->x[i] == close(b.field->x[i]));
        CHECK(a.field->y[i] == close(b.field->y[i]));
    }
    CHECK(a.rods_run->t_end == close(b.rods_run->t_end));
    REQUIRE(a.rods_run->output_times.size() == 3);
    for (std::size_t i = 0; i < 3; ++i)
        CHECK(a.rods_run->output_times[i] == close(b.rods_run->output_times[i]));
    CHECK(*a.rods_run->contact_distance == close(*b.rods_run->contact_distance));
    CHECK(a.field->cuts[0].at == close(b.field->cuts[0].at));
    CHECK(a.field->cuts[0].from == close(b.field->cuts[0].from));
    CHECK(a.field->cuts[0].to == close(b.field->cuts[0].to));
}

TEST_CASE("every unit word") {
    CHECK(value_of("1 m", Dimension::length) == close(2000.0));
    CHECK(value_of("1 cm", Dimension::length) == close(20.0));
    CHECK(value_of("1 mm", Dimension::length) == close(2.0));
    CHECK(value_of("1 um", Dimension::length) == close(0.002));
    CHECK(value_of("10 a", Dimension::length) == close(8.0));
    CHECK(value_of("2.2 f/mu", Dimension::length) == 2.2);
    CHECK(value_of("1 s", Dimension::time) == close(4.0));
    CHECK(value_of("10 ms", Dimension::time) == close(0.04));
    CHECK(value_of("5 us", Dimension::time) == close(0.00002));
    CHECK(value_of("1 min", Dimension::time) == close(240.0));
    CHECK(value_of("3 f/(mu v0)", Dimension::time) == 3.0);
    CHECK(value_of("1 m/s", Dimension::speed) == close(500.0));
    CHECK(value_of("1 cm/s", Dimension::speed) == close(5.0));
    CHECK(value_of("2.8 mm/s", Dimension::speed) == close(1.4));
    CHECK(value_of("2 um/s", Dimension::speed) == close(0.001));
    CHECK(value_of("5 a/s", Dimension::speed) == close(1.0));
    CHECK(value_of("7 v0", Dimension::speed) == 7.0);
    CHECK(value_of("1 1/s", Dimension::rate) == close(0.25));
    CHECK(value_of("1 1/ms", Dimension::rate) == close(250.0));
    CHECK(value_of("6 1/min", Dimension::rate) == close(0.025));
    CHECK(value_of("4 Hz", Dimension::rate) == close(1.0));
    CHECK(value_of("4 kHz", Dimension::rate) == close(1000.0));
    CHECK(value_of("3 mu v0/f", Dimension::rate) == 3.0);
    CHECK(value_of("180 deg", Dimension::angle) == std::numbers::pi);
    CHECK(value_of("0.5 rad", Dimension::angle) == 0.5);
    CHECK(value_of("2700 kg/m^3", Dimension::density) == 2700.0); // no reduced unit: SI in every scene
    CHECK(value_of("2.7 g/cm^3", Dimension::density) == 2700.0);
    CHECK(value_of("9.81 m/s^2", Dimension::acceleration) == 9.81);
    CHECK(value_of("9810 mm/s^2", Dimension::acceleration) == 9.81);
}

TEST_CASE("spaces around number and unit do not matter") {
    CHECK(value_of("1mm", Dimension::length) == close(2.0));
    CHECK(value_of("1e0   mm  ", Dimension::length) == close(2.0));
}

TEST_CASE("strings that are no quantity say why") {
    const Units units{UnitSystem::reduced, Scales{0.0005, 0.002, 0.0004}, true};
    const auto why = [&](const std::string& text) {
        return rodwake::scene::parse_quantity(text, Dimension::length, units).why;
    };
    CHECK(why("5 s") == "\"s\" is a time; known: m, cm, mm, um, a, f/mu");
    CHECK(why("5 parsec") == "unknown unit \"parsec\"; known: m, cm, mm, um, a, f/mu");
    CHECK(why("5").starts_with("a string needs a unit"));
    CHECK(why("inf mm").starts_with("a string must be a finite number"));
    CHECK(why("nan m").starts_with("a string must be a finite number"));
    CHECK(why("1e999 m").starts_with("a string must be a finite number"));
    CHECK(why("").starts_with("a string must be a finite number"));
    CHECK(why("mm").starts_with("a string must be a finite number"));
}

TEST_CASE("physical units and SI need scales") {
    const auto unit = error_text(two_rods("contact_distance = \"0.1 mm\"\n"));
    CHECK(unit == "x.toml:8:20: rods_run.contact_distance = \"0.1 mm\": a physical unit needs [scales] with "
                  "f_over_mu and v0, what one reduced unit of length and speed is worth");
    CHECK(
        error_text("units = \"si\"\n" + two_rods()).starts_with("x.toml:1:9: units = \"si\" needs [scales]"));
    CHECK(error_text(two_rods("contact_distance = \"0.1 f/mu\"\n")) == "");
    says(two_rods("contact_distance = \"0.1 mm\"\n[scales]\nv0 = 1\n"), "scales needs the key f_over_mu");
    CHECK(error_text(two_rods("contact_distance = \"0.1 mm\"\n"),
                     {"scales={ f_over_mu = 1e-3, v0 = 1e-3 }"}) == "");
}

TEST_CASE("scales are SI in every scene and may use bead radii") {
    const Scene scene =
        parse(two_rods("[scales]\nf_over_mu = \"2.2 a\"\nv0 = \"7 a/s\"\nbead_radius = \"0.5 mm\"\n"));
    CHECK(scene.scales->f_over_mu == close(1.1e-3));
    CHECK(scene.scales->v0 == close(3.5e-3));
    says(two_rods("[scales]\nf_over_mu = \"1 f/mu\"\nv0 = 1\n"), "unknown unit \"f/mu\"");
}

TEST_CASE("elastic constants") {
    const std::string start = "schema = 1\n[field]\nx = [0, 1]\ny = [0, 1]\n[medium]\n";
    CHECK(parse(start + "alpha = 0.1\nlame_lambda = 0.5\nmu = 2.0\n").medium->eta == 1.25);
    CHECK(parse(start + "alpha = 0.1\nbulk_modulus = 3.0\nmu = 2.0\n").medium->eta == 1.5);
    // nu = lambda_L/(lambda_L + 2 mu) with lambda_L = 2, mu = 3: 1/4; eta = 5/3.
    CHECK(parse(start + "alpha = 0.1\npoisson_ratio = 0.25\n").medium->eta == close(5.0 / 3.0));
    CHECK(parse(start + "alpha = 0.1\neta = 2\n").medium->xi == 10.0);
    CHECK(parse("units = \"si\"\n" + start + "alpha = 0.1\neta = 2\n" + scales).medium->xi == 10.0);
}
