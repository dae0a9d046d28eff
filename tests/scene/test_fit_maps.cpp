// [[fit.maps]]: units, what its tables must agree on, what it needs of the parameters.

#include "rodwake/scene/read.hpp"
#include "support.hpp"

#include <catch2/catch.hpp>

using namespace scene_test;

namespace {

const std::string constants = "c11 = 3.0, c22 = 3.0, c12 = 1.0, c66 = 1.0";
const std::string maps = "[[fit.maps]]\nfiles = [\"measure.h5\"]\n";

std::string fitted(const std::string& keys = "", const std::string& data = maps,
                   const std::string& parameters = "\"force\", \"p_yy\"",
                   const std::string& fixed = constants) {
    return "schema = 1\n[fit]\nparameters = [" + parameters + "]\nfixed = { " + fixed + " }\n" + keys + data;
}

void says(const std::string& text, const std::string& part) {
    const std::string message = error_text(text);
    INFO(message);
    CHECK(message.find(part) != std::string::npos);
}

} // namespace

TEST_CASE("lengths of maps and masks are bead radii, angles radians") {
    const Scene scene =
        parse(fitted("rod_length = \"4.5 mm\"\nsource_width = \"1 a\"\nfixed_errors = { c66 = 0.1 }\n",
                     maps + "box = [\"78 a\", 77.0]\nspeed = -2.5\n[[fit.masks]]\nstrip = \"8 a\"\n"
                            "sector = [0.0, \"90 deg\"]\n[[fit.masks]]\nradius = 10.0\n"));
    CHECK(scene.fit->rod_length == Approx(11.25));
    CHECK(scene.fit->maps[0].box == std::vector{78.0, 77.0});
    CHECK(*scene.fit->maps[0].speed == -2.5);
    CHECK(scene.fit->masks[0].strip == Approx(8.0));
    CHECK(scene.fit->masks[0].sector[1] == Approx(1.5707963267948966));
    CHECK(scene.fit->fixed_errors.at("c66") == 0.1);
    CHECK(parse(rodwake::scene::to_toml(scene)) == scene);
}

TEST_CASE("maps need a source and all four constants") {
    says(fitted("", maps, "\"p_yy\"", "c11 = 3.0, c22 = 3.0, c66 = 1.0"), "maps need c12");
    says(fitted("", maps, "\"offset\""), "maps need force, p_xx, p_yy, q_xxx, q_xyy or q_yxy");
    CHECK_NOTHROW(parse(fitted("", maps, "\"q_xyy\"")));
    says(fitted("", maps, "\"amplitude\", \"p_yy\""), "amplitude scales the predicted monopole force");
    says(fitted("", maps, "\"force\"", "c11 = 3.0, c22 = 3.0, c12 = 1.0, c66 = -1.0"), "c66 must be above 0");
    says(fitted("", maps, "\"force\", \"kappa\""), "no data depend on kappa");
}

TEST_CASE("keys of maps without maps are refused") {
    const std::string profile = "[[fit.profiles]]\nfile = \"ux.csv\"\n";
    const std::string isotropic = "\"f_over_mu\", \"eta\", \"xi\"";
    says(fitted("", profile, isotropic), "no data depend on c11: it needs [[fit.maps]]");
    says(fitted("rod_length = 4.0\n", profile, isotropic, ""), "rod_length belongs to [[fit.maps]]");
    says(fitted("", profile + "[[fit.masks]]\nstrip = 8.0\n", isotropic, ""),
         "masks belongs to [[fit.maps]]");
}

TEST_CASE("errors belong to values that are held, and sectors go upwards") {
    says(fitted("fixed_errors = { p_yy = 1.0 }\n"), "p_yy is not in fit.fixed");
    says(fitted("fixed_errors = { c66 = 0.0 }\n"), "a standard error must be above 0");
    says(fitted("", maps + "[[fit.masks]]\nsector = [\"90 deg\", \"10 deg\"]\n"),
         "from a lower to a higher angle");
    says(fitted("", maps + "[[fit.masks]]\nsector = [\"90 deg\", \"270 deg\"]\n"), "within 0 and 180 deg");
    says(fitted("", maps + "box = [78.0, 0.0]\n"), "both must be above 0");
}

TEST_CASE("maps by the theory's own parameters are in units of the shear modulus") {
    const std::string
        theory = "\"f_over_mu\", \"eta\"",
        bed = "[granular]\nphi_b = 0.8\nbox = \"fit\"\nduration = 9.0\n[[granular.rods]]\nkind = \"motile\"\n"
              "position = [0.008, 0.016]\n[measure]\n";
    const auto text = [&](const std::string& keys, const std::string& fixed = "drag_area = 860.0",
                          const std::string& more = "") { return fitted(keys, maps + more, theory, fixed); };
    CHECK_NOTHROW(parse(text("")));
    CHECK_NOTHROW(parse(text("", "xi = 500.0")));
    says(text("", "xi = 500.0, drag_area = 860.0"), "give one of xi, alpha and drag_area");
    says(text("", "c11 = 3.0"), "maps with f_over_mu and eta are in units of mu: leave out c11");
    says(text("", "drag_area = -1.0"), "drag_area must be above 0");
    says(text("measured_drag = true\n"), "drag_area is measured and also fitted, fixed or tied");
    says(text("measured_drag = true\n", ""), "measured by measure.mechanics");
    says(text("", "drag_area = 860.0", "[[fit.profiles]]\nfile = \"ux.csv\"\n"),
         "cannot be combined with other fitted data");
    const std::string line =
        "[[fit.profiles]]\nfile = \"ux.csv\"\nrole = \"predict\"\n[[fit.compare]]\nname = \"line\"\n";
    CHECK_NOTHROW(parse(text("", "drag_area = 860.0", line + "line = 0\n")));
    says(text("", "drag_area = 860.0", line), "give values, or line");
    says(text("", "drag_area = 860.0", line + "line = 1\n"),
         "there is no profile 1: fit.profiles has 1 (numbered from 0)");
    const Scene measured = parse(text("measured_drag = true\n", "",
                                      bed + "displacement = \"phase\"\nmechanics = true\nrun_maps = true\n"));
    CHECK(rodwake::scene::fit_is_isotropic(*measured.fit));
    CHECK(parse(rodwake::scene::to_toml(measured)) == measured);
}
