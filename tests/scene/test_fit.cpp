// [fit]: units of its lengths, what its tables must agree on, what it needs of the data, the fitted medium.

#include "support.hpp"

#include "rodwake/scene/read.hpp"

#include <catch2/catch.hpp>

using namespace scene_test;
using rodwake::scene::fit_bounds;
using rodwake::scene::fit_in_log;

namespace {

const std::string ux = "[[fit.profiles]]\nfile = \"ux.csv\"\n";
const std::string uy = "[[fit.profiles]]\nfile = \"uy.csv\"\ncomponent = \"Uy\"\nat = \"4 a\"\n";
const std::string tracks = "[[fit.trajectories]]\nfile = \"rods.csv\"\n";
const std::string medium = "[medium]\nfitted = true\n";

/// A scene with nothing but a fit.
std::string fitted(const std::string& keys, const std::string& data = ux,
                   const std::string& parameters = "\"f_over_mu\", \"eta\", \"xi\"") {
    return "schema = 1\n[fit]\nparameters = [" + parameters + "]\n" + keys + data;
}

} // namespace

TEST_CASE("lengths of [fit] are in the profiles' unit, strings become bead radii") {
    const std::string keys =
        "box = \"31.2 mm\"\ncore = 8.0\nheading = \"90 deg\"\nindependent_spacing = \"4.2 a\"\n";
    const auto fit = *parse(fitted(keys, uy)).fit;
    CHECK(fit.box->x == Approx(78.0)); // 0.4 mm by default
    CHECK(fit.box->square());
    CHECK(fit.core == 8.0);
    CHECK(*fit.independent_spacing == Approx(4.2));
    CHECK(fit.profiles[0].at == Approx(4.0));
    CHECK(fit.heading == Approx(1.5707963267948966));
    const std::string si = "units = \"si\"\n[scales]\nf_over_mu = 1e-3\nv0 = 1e-3\nbead_radius = \"1 mm\"\n";
    const auto scaled = *parse(replaced(fitted(keys), "schema = 1\n", "schema = 1\n" + si)).fit;
    CHECK(scaled.box->x == Approx(31.2));
    CHECK(scaled.core == 8.0); // whatever `units` says
    const auto bed_fit = *parse(bed("bead_radius = \"0.5 mm\"\n") + fitted(keys).substr(11)).fit;
    CHECK(bed_fit.box->x == Approx(62.4));
    says(fitted("box = \"2 f/mu\"\n"), "unknown unit \"f/mu\"");
}

TEST_CASE("fit.box is one side or two") {
    const auto fit = *parse(fitted("box = [\"78 a\", \"31.2 mm\"]\n")).fit;
    CHECK(fit.box->x == Approx(78.0));
    CHECK(fit.box->y == Approx(78.0));
    const std::string both = "box = [\"78 a\", \"77 a\"]\n";
    check_round_trip(parse(fitted(both)));
    CHECK(*parse(bed("") + fitted(both).substr(11)).fit->box == rodwake::PeriodicBox(78.0, 77.0));
    says(fitted("box = [\"78 a\", \"-77 a\"]\n"), "fit.box");
    says(fitted("box = [\"78 a\"]\n"), "fit.box");
    says(fitted("box = [1, 2, 3]\n"), "fit.box");
    says(fitted("box = \"wide\"\n"), "fit.box");
}

TEST_CASE("a profile's range goes from low to high") {
    const auto fit = *parse(fitted("", uy + "range = [\"10 a\", 39.0]\n")).fit;
    CHECK(fit.profiles[0].range == std::vector{10.0, 39.0});
    check_round_trip(parse(fitted("", uy + "range = [10.0, 39.0]\n")));
    says(fitted("", uy + "range = [39.0, 10.0]\n"), "from a lower to a higher position");
}

TEST_CASE("parameters have the defaults of the reference") {
    const auto fit = *parse(fitted("bounds = { eta = [-0.5, 5.0] }\n")).fit;
    CHECK(fit_bounds(fit, "xi") == rodwake::scene::Interval{1e-6, 1e6});
    CHECK_FALSE(fit_bounds(fit, "f_over_mu"));
    CHECK(fit_in_log(fit, "xi"));
    CHECK_FALSE(fit_in_log(fit, "eta")); // its lower bound is not above 0
    CHECK_FALSE(fit_in_log(fit, "f_over_mu"));
    CHECK(rodwake::scene::fit_default_start(fit, "xi") == 10.0);
    CHECK(rodwake::scene::fit_default_start(fit, "offset") == 0.0);
    const auto of_tracks = *parse(fitted("fixed = { eta = 1.0 }\n", tracks, "\"kappa\", \"xi\"")).fit;
    CHECK(rodwake::scene::fit_default_start(of_tracks, "xi") == 1.0);
    CHECK(rodwake::scene::fit_default_start(of_tracks, "alpha") == 1.0);
}

TEST_CASE("a fit survives writing and reading") {
    check_round_trip(parse(
        fitted("start = { eta = 2.0, f_over_mu = -1.5 }\nbounds = { eta = [0.1, 1e3] }\nlog = [\"eta\"]\n"
               "fixed = { offset = 0.25 }\ntied = { f2d_over_mu = [\"f_over_mu\", -0.5] }\nstarts = 7\n"
               "method = \"bobyqa\"\nloss = \"huber\"\nloss_width = 2.0\nlikelihood = [\"xi\"]\n",
               ux + "role = \"predict\"\n" + ux + "name = \"N\"\n" +
                   "[[fit.compare]]\nname = \"c\"\nvalues = { alpha = 0.1 }\n")));
    check_round_trip(parse("schema = 1\n" + medium + "periodic = 40.0\n" + fitted("").substr(11)));
    check_round_trip(
        parse(fitted("", tracks + "sigma_position = 0.1\nsigma_heading = 0.2\ncontact_distance = 0.3\n",
                     "\"kappa\", \"eta\", \"alpha\"")));
    check_round_trip(parse(fitted(
        "likelihood = [\"eta\"]\nstarts = 2\n",
        ux +
            "[[figures]]\nname = \"f\"\nkind = \"fit\"\nprofiles = [0]\nresiduals = false\nx = [1, \"2 a\"]\n"
            "[[figures]]\nname = \"g\"\nkind = \"fit_likelihood\"\nparameter = \"eta\"\n")));
}

TEST_CASE("unknown parameters are named with the nearest known one, where they stand") {
    CHECK(error_text(fitted("start = { etta = 2.0 }\n")) ==
          "x.toml:4:11: fit.start.etta: unknown parameter \"etta\" (did you mean \"eta\"?). Known "
          "parameters: f_over_mu, f2d_over_mu, eta, xi, alpha, drag_area, x0, amplitude, force, p_xx, p_yy, "
          "q_xxx, q_xyy, q_yxy, t_xxxx, t_xxyy, h_xxxxx, h_xxxyy, c11, c22, c12, c66, zeta, rho, eta_s, "
          "offset, offset_y, kappa, gamma1, gamma2, gamma_flow, gamma_rows, rows_direction, "
          "stall_overlap, mobility_ratio, D_r, D_t");
    says(fitted("tied = { x0 = [\"f_over_my\", 1.0] }\n"), "did you mean \"f_over_mu\"?");
    says(fitted("", ux, "\"f_over_mu\", \"etta\", \"xi\""), "did you mean \"eta\"?");
}

TEST_CASE("each parameter is free, fixed or tied") {
    says(fitted("fixed = { eta = 1.0 }\n"), "eta is fitted (fit.parameters) and fixed");
    says(fitted("tied = { eta = [\"xi\", 1.0] }\n"), "eta is tied and also fitted");
    says(fitted("tied = { x0 = [\"offset\", 1.0] }\nfixed = { offset = 1.0 }\n"),
         "x0 is tied to offset, which is not fitted; fit.parameters has f_over_mu, eta, xi");
    says(fitted("start = { x0 = 1.0 }\n"),
         "fit.start has x0, which is not in fit.parameters, fit.fixed or fit.tied");
    says(fitted("bounds = { x0 = [0.0, 1.0] }\n"), "fit.bounds has x0, which is not in");
    says(fitted("likelihood = [\"x0\"]\n"), "x0 is not among fit.parameters: nothing to profile");
}

TEST_CASE("starts and bounds are of the physics and of each other") {
    says(fitted("bounds = { eta = [5.0, 1.0] }\n"),
         "bounds of eta are reversed: low = 5 must be below high = 1");
    says(fitted("bounds = { eta = [5.0, 9.0] }\n"), "eta starts at 1 (default), outside its bounds [5, 9]");
    says(fitted("start = { eta = -0.5 }\n"), "eta starts at -0.5, outside its default bounds [1e-06, 1e+06]");
    says(fitted("start = { xi = -1.0 }\nbounds = { xi = [-2.0, 1.0] }\n"), "xi must be above 0");
    says(fitted("bounds = { eta = [-2.0, 5.0] }\n"), "eta must be above -1");
    says(fitted("method = \"crs\"\n"), "f_over_mu has none: give fit.bounds.f_over_mu = [low, high]");
    says(fitted("log = [\"f_over_mu\"]\n"), "needs bounds above 0: give fit.bounds.f_over_mu");
    says(fitted("log = [\"x0\"]\n"), "x0 is not among fit.parameters");
    CHECK(error_text(fitted(
              "method = \"crs\"\nbounds = { f_over_mu = [0.1, 10.0] }\nlog = [\"f_over_mu\"]\n")) == "");
}

TEST_CASE("all errors of a fit are listed at once") {
    CHECK(
        problems_of(fitted("start = { eta = -0.5 }\nfixed = { xi = 1.0 }\nlikelihood = [\"x0\"]\n")).size() ==
        3);
}

TEST_CASE("data and parameters belong together") {
    says(fitted("", ""), "[fit] has no data: give [[fit.profiles]], [[fit.maps]] or [[fit.trajectories]]");
    says(fitted("", ux + "role = \"predict\"\n"), "every one of [[fit.profiles]] has role = \"predict\"");
    says(fitted("", ux, "\"f_over_mu\", \"eta\""), "the field needs xi or alpha");
    says(fitted("", ux, "\"f_over_mu\", \"xi\""), "the field needs eta");
    says(fitted("", ux, "\"eta\", \"xi\""), "profiles need f_over_mu or f2d_over_mu");
    says(fitted("fixed = { alpha = 0.1 }\n"), "give xi or alpha = f_over_mu/xi, not both");
    says(fitted("", uy, "\"f2d_over_mu\", \"eta\", \"alpha\""), "alpha = f_over_mu/xi needs f_over_mu");
    says(fitted("", uy, "\"f_over_mu\", \"eta\", \"xi\", \"offset\""),
         "no data depend on offset: it needs a profile of Ux");
    says(fitted("", ux + uy + "role = \"predict\"\n", "\"f_over_mu\", \"eta\", \"xi\", \"offset_y\""),
         "no data depend on offset_y: it needs a profile of Uy with role = \"fit\"");
    CHECK(error_text(fitted("fixed = { offset_y = 1.0 }\n", ux + uy + "role = \"predict\"\n")) == "");
    says(fitted("", ux, "\"f_over_mu\", \"eta\", \"xi\", \"kappa\""),
         "no data depend on kappa: it needs [[fit.trajectories]]");
    says(fitted("", tracks, "\"eta\", \"alpha\""),
         "nothing turns the rods. Put kappa, gamma1, gamma2, gamma_flow or gamma_rows into fit.parameters");
    says(fitted("", tracks, "\"f_over_mu\", \"kappa\", \"eta\", \"xi\""),
         "no data depend on f_over_mu: it needs [[fit.profiles]]");
    says(fitted("", ux + tracks, "\"f_over_mu\", \"kappa\", \"eta\", \"xi\""),
         "profiles and trajectories together need alpha");
    CHECK(error_text(fitted("", ux + tracks, "\"f_over_mu\", \"kappa\", \"eta\", \"alpha\"")) == "");
    says(fitted("core = 8.0\n", tracks, "\"kappa\", \"eta\", \"alpha\""), "core belongs to [[fit.profiles]]");
    says(fitted("heading = 0.5\n"), "heading is the angle of the rod to the sides of the periodic box");
    says(fitted("loss_width = 3.0\n"), "loss_width belongs to loss");
    says(fitted("length_unit = \"\"\n"), "length_unit must not be empty");
}

TEST_CASE("keys of trajectories and comparisons come together") {
    const auto track = [](const std::string& more) {
        return fitted("", tracks + more, "\"kappa\", \"eta\", \"alpha\"");
    };
    says(track("sigma_position = 0.1\n"), "sigma_position and sigma_heading come together");
    says(track("contact_time = 1.0\n"), "contact_time needs contact_distance");
    says(track("sigma_contact = 1.0\n"), "sigma_contact belongs to contact_time");
    const auto compared = [](const std::string& values) {
        return fitted("", ux + "[[fit.compare]]\nname = \"c\"\nvalues = { " + values + " }\n");
    };
    CHECK(error_text(compared("f_over_mu = 2.2, alpha = 0.1")) == "");
    says(compared("xi = 2.2, alpha = 0.1"), "give xi or alpha = f_over_mu/xi, not both");
    says(compared("offset = 0.1"), "offset is not a parameter of this fit; it has f_over_mu, eta, xi");
}

TEST_CASE("a fitted medium takes eta and xi from the fit") {
    const auto with = [](const std::string& keys, const std::string& fit) {
        return "schema = 1\n[medium]\n" + keys + fit.substr(11);
    };
    CHECK(error_text(with("fitted = true\n", fitted(""))) == "");
    says(with("fitted = true\neta = 1.0\n", fitted("")),
         "x.toml:4:7: medium.eta is given together with medium.fitted = true");
    says(with("fitted = true\nalpha = 1.0\npoisson_ratio = 0.3\n", fitted("")),
         "medium.poisson_ratio is given together with");
    says(with("", fitted("")), "medium needs one of eta");
    says(with("fitted = true\n", fitted("fixed = { eta = 1.0 }\n", uy, "\"f2d_over_mu\", \"xi\"")),
         "medium.fitted = true needs f_over_mu, eta and xi or alpha in [fit]");
    says("schema = 1\n" + medium + "[field]\nx = [0, 1]\ny = [0, 1]\n", "medium.fitted = true needs [fit]");
    const auto written = rodwake::scene::to_toml(parse(with("fitted = true\nperiodic = 40.0\n", fitted(""))));
    CHECK_THAT(written, Catch::Contains("fitted = true"));
    CHECK_THAT(written, Catch::Contains("periodic = 40.0"));
    CHECK_THAT(written, !Catch::Contains("xi = "));
}

TEST_CASE("figures of the fit need what they show") {
    const auto drawn = [](const std::string& kind, const std::string& more = "",
                          const std::string& keys = "") {
        return fitted(keys, ux + "[[figures]]\nname = \"f\"\nkind = \"" + kind + "\"\n" + more);
    };
    CHECK(error_text(drawn("fit", "profiles = [0]\nx = [\"1 a\", 2.0]\n")) == "");
    CHECK(error_text(drawn("fit_correlation")) == "");
    says(drawn("fit", "profiles = [1]\n"), "there is no profile 1: fit.profiles has 1 (numbered from 0)");
    says(drawn("fit_starts"), "a figure of kind fit_starts needs fit.starts of 2 or more");
    says(drawn("fit_likelihood"), "a figure of kind fit_likelihood needs fit.likelihood");
    says(drawn("fit_likelihood", "parameter = \"xi\"\n", "likelihood = [\"eta\"]\n"),
         "xi is not in fit.likelihood");
    says(drawn("fit_trajectories"), "a figure of kind fit_trajectories needs [[fit.trajectories]]");
}

// --- [[fit.maps]]: units, what its tables must agree on, what it needs of the parameters

namespace {

const std::string constants = "c11 = 3.0, c22 = 3.0, c12 = 1.0, c66 = 1.0";
const std::string maps = "[[fit.maps]]\nfiles = [\"measure.h5\"]\n";

std::string with_maps(const std::string& keys = "", const std::string& data = maps,
                      const std::string& parameters = "\"force\", \"p_yy\"",
                      const std::string& fixed = constants) {
    return "schema = 1\n[fit]\nparameters = [" + parameters + "]\nfixed = { " + fixed + " }\n" + keys + data;
}

} // namespace

TEST_CASE("lengths of maps and masks are bead radii, angles radians") {
    const Scene scene =
        parse(with_maps("rod_length = \"4.5 mm\"\nsource_width = \"1 a\"\nfixed_errors = { c66 = 0.1 }\n",
                        maps + "box = [\"78 a\", 77.0]\nspeed = -2.5\n[[fit.masks]]\nstrip = \"8 a\"\n"
                               "sector = [0.0, \"90 deg\"]\n[[fit.masks]]\nradius = 10.0\n"));
    CHECK(scene.fit->rod_length == Approx(11.25));
    CHECK(scene.fit->maps[0].box == std::vector{78.0, 77.0});
    CHECK(*scene.fit->maps[0].speed == -2.5);
    CHECK(scene.fit->masks[0].strip == Approx(8.0));
    CHECK(scene.fit->masks[0].sector[1] == Approx(1.5707963267948966));
    CHECK(scene.fit->fixed_errors.at("c66") == 0.1);
    check_round_trip(scene);
}

TEST_CASE("maps need a source and all four constants") {
    says(with_maps("", maps, "\"p_yy\"", "c11 = 3.0, c22 = 3.0, c66 = 1.0"), "maps need c12");
    says(with_maps("", maps, "\"offset\""), "maps need force, p_xx, p_yy, q_xxx, q_xyy or q_yxy");
    CHECK_NOTHROW(parse(with_maps("", maps, "\"q_xyy\"")));
    says(with_maps("", maps, "\"amplitude\", \"p_yy\""), "amplitude scales the predicted monopole force");
    says(with_maps("", maps, "\"force\"", "c11 = 3.0, c22 = 3.0, c12 = 1.0, c66 = -1.0"),
         "c66 must be above 0");
    says(with_maps("", maps, "\"force\", \"kappa\""), "no data depend on kappa");
}

TEST_CASE("keys of maps without maps are refused") {
    const std::string profile = "[[fit.profiles]]\nfile = \"ux.csv\"\n";
    const std::string isotropic = "\"f_over_mu\", \"eta\", \"xi\"";
    says(with_maps("", profile, isotropic), "no data depend on c11: it needs [[fit.maps]]");
    says(with_maps("rod_length = 4.0\n", profile, isotropic, ""), "rod_length belongs to [[fit.maps]]");
    says(with_maps("", profile + "[[fit.masks]]\nstrip = 8.0\n", isotropic, ""),
         "masks belongs to [[fit.maps]]");
}

TEST_CASE("errors belong to values that are held, and sectors go upwards") {
    says(with_maps("fixed_errors = { p_yy = 1.0 }\n"), "p_yy is not in fit.fixed");
    says(with_maps("fixed_errors = { c66 = 0.0 }\n"), "a standard error must be above 0");
    says(with_maps("", maps + "[[fit.masks]]\nsector = [\"90 deg\", \"10 deg\"]\n"),
         "from a lower to a higher angle");
    says(with_maps("", maps + "[[fit.masks]]\nsector = [\"90 deg\", \"270 deg\"]\n"), "within 0 and 180 deg");
    says(with_maps("", maps + "box = [78.0, 0.0]\n"), "both must be above 0");
}

TEST_CASE("maps by the theory's own parameters are in units of the shear modulus") {
    const std::string
        theory = "\"f_over_mu\", \"eta\"",
        bed = "[granular]\nphi_b = 0.8\nbox = \"fit\"\nduration = 9.0\n[[granular.rods]]\nkind = \"motile\"\n"
              "position = [0.008, 0.016]\n[measure]\n";
    const auto text = [&](const std::string& keys, const std::string& fixed = "drag_area = 860.0",
                          const std::string& more = "") {
        return with_maps(keys, maps + more, theory, fixed);
    };
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
    check_round_trip(measured);
}
