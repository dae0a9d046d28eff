#include "fields.hpp"

#include "output_grid.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/elastic/medium.hpp"

#include <fmt/format.h>

namespace rodwake::scene {

namespace {

using enum Dimension;

/// The keys of [medium] that give eta. A resolved scene has eta itself.
struct EtaForms {
    std::optional<double> eta, poisson_ratio, lame_lambda, bulk_modulus, mu;

    /// eta of the given form; the forms are in the order of Forms below.
    double value(int form) const {
        switch (form) {
        case 0:
            return eta.value_or(1.0);
        case 1:
            return elastic::eta_from_poisson_ratio(poisson_ratio.value_or(0.0));
        case 2:
            return elastic::eta_from_lame(lame_lambda.value_or(0.0), mu.value_or(1.0));
        case 3:
            return elastic::eta_from_bulk_modulus(bulk_modulus.value_or(1.0), mu.value_or(1.0));
        default:
            return 1.0;
        }
    }
};

void eta_keys(Visitor& v, EtaForms& k) {
    v(key("eta")
          .above(-1.0)
          .because("the longitudinal modulus 1 + eta must be positive")
          .doc("(lambda_L + mu)/mu, the coefficient of grad div over mu; in 2-D also K/mu")
          .example("1.0"),
      k.eta);
    v(key("poisson_ratio")
          .above(-1.0, 1.0 - 1e-12)
          .because("the bulk modulus of a 2-D medium is positive and finite only for -1 < nu < 1")
          .doc("2-D Poisson ratio nu = lambda_L/(lambda_L + 2 mu); eta = (1 + nu)/(1 - nu)")
          .example("0.3"),
      k.poisson_ratio);
    v(key("lame_lambda")
          .doc("lambda_L of the free energy F = int [lambda_L (tr eps)^2/2 + mu tr(eps^2)], any unit, the "
               "same as mu; "
               "eta = (lambda_L + mu)/mu")
          .example("0.5"),
      k.lame_lambda);
    v(key("bulk_modulus")
          .above(0.0)
          .doc("2-D bulk modulus K = lambda_L + mu, any unit, the same as mu; eta = K/mu")
          .example("1.5"),
      k.bulk_modulus);
    v(key("mu").above(0.0).doc("shear modulus, any unit, beside lame_lambda or bulk_modulus").example("1.0"),
      k.mu);
}

void resolve_eta(Visitor& v, const EtaForms& keys, int form, Medium& medium) try {
    const double eta = keys.value(form);
    elastic::validate({eta, 1.0});
    medium.eta = eta;
} catch (const InputError& error) { // a bad eta by itself has been reported by its range
    constexpr const char* names[] = {"eta", "poisson_ratio", "lame_lambda", "bulk_modulus"};
    if (form > 0)
        v.complain(names[form], fmt::format("is not usable: {}", error.what()));
}

void resolve_times(Visitor& v, RodsRun& run, const std::vector<double>& times) {
    for (std::size_t i = 0; i < times.size(); ++i)
        if (times[i] > run.t_end || (i > 0 && times[i] <= times[i - 1]))
            return v.complain("output_times",
                              fmt::format("entry {} is {} f/(mu v0): times must increase strictly "
                                          "within 0 < t <= t_end = {}",
                                          i, times[i], run.t_end));
    run.output_times = times;
    if (!times.empty() && times.back() < run.t_end)
        run.output_times.push_back(run.t_end);
}

void resolve_interval(Visitor& v, RodsRun& run, std::optional<double> interval) {
    const double step = interval.value_or(run.t_end / default_outputs);
    if (step > run.t_end || run.t_end / step > max_outputs)
        return v.complain(
            "output_interval",
            fmt::format("is {} f/(mu v0): must be between t_end/1000000 and t_end = {}", step, run.t_end));
    run.output_times = output_grid(step, run.t_end);
}

/// Coordinates matter on the scale of f/mu, headings on that of a radian.
double default_atol(double rtol) { return rtol / 100.0; }

void solver_fields(Visitor& v, RodsRun& run) {
    std::string form = "angle"; // the only one so far
    v(key("method")
          .doc("CVODES BDF or Adams, ARKODE explicit Runge-Kutta, or chosen by tolerance")
          .example("\"bdf\""),
      choice(run.method, {{"auto", RodMethod::automatic},
                          {"bdf", RodMethod::bdf},
                          {"adams", RodMethod::adams},
                          {"erk", RodMethod::erk}}));
    v(key("form")
          .one_of({"angle"})
          .not_yet({"director", "dae"})
          .doc("form of the equations")
          .example("\"angle\""),
      form);
    v(key("rtol").within(1e-13, 1e-1).doc("relative tolerance of the local error").example("1e-8"), run.rtol);
    std::optional<double> atol = run.atol == default_atol(run.rtol) ? std::nullopt : std::optional(run.atol);
    v(key("atol")
          .above(0.0, 1.0)
          .absent("rtol / 100")
          .doc("absolute tolerance of the local error, reduced units")
          .example("1e-10"),
      atol);
    v.one_form(false, {{"atol"}}, [&](int) { run.atol = atol.value_or(default_atol(run.rtol)); });
    v(key("max_steps").within(1, 1e12).doc("ceiling on internal steps").example("1000000"), run.max_steps);
}

void window_fields(Visitor& v, std::vector<double>& x, std::vector<double>& y, const std::string& what,
                   const std::string& absent) {
    v(key("x").unit(length).items(2, 2).absent(absent).doc(what + ", [min, max] of x").example("[-5.0, 5.0]"),
      x);
    v(key("y").unit(length).items(2, 2).absent(absent).doc(what + ", [min, max] of y").example("[-5.0, 5.0]"),
      y);
}

} // namespace

void fields(Visitor& v, Scales& scales) {
    // One metre and one metre per second as units of length and speed: values in here stay SI.
    v.use_units({UnitSystem::si, Scales{1.0, 1.0, scales.bead_radius}, false});
    v(key("bead_radius").unit(length).above(0.0).doc("what \"a\" means in \"2.2 a\"").example("\"0.4 mm\""),
      scales.bead_radius);
    v.use_units({UnitSystem::si, Scales{1.0, 1.0, scales.bead_radius}, false});
    v(key("f_over_mu").required().unit(length).above(0.0).doc("unit of length, f/mu").example("\"2.2 a\""),
      scales.f_over_mu);
    v(key("v0")
          .required()
          .unit(speed)
          .above(0.0)
          .doc("self-propulsion speed; the unit of time is f_over_mu / v0")
          .example("\"2.8 mm/s\""),
      scales.v0);
}

void fields(Visitor& v, Medium& medium) {
    EtaForms elastic{medium.eta, {}, {}, {}, {}};
    std::optional<double> xi = medium.xi, alpha;
    eta_keys(v, elastic);
    v(key("xi").unit(length).within(1e-12, 1e12).doc("screening length mu/(zeta v0)").example("1.0"), xi);
    v(key("alpha")
          .within(1e-12, 1e12)
          .doc("(f/mu)/xi = f zeta v0/mu^2, the reading taken here of the paper's alpha, which it does not "
               "define")
          .example("1.0"),
      alpha);
    v(key("field")
          .one_of({"exact"})
          .not_yet({"table", "measured", "dynamic"})
          .doc("how the field is evaluated")
          .example("\"exact\""),
      choice(medium.field, {{"exact", FieldBackend::exact}}));
    v.planned("table");
    v.one_form(true, {{"eta"}, {"poisson_ratio"}, {"lame_lambda", "mu"}, {"bulk_modulus", "mu"}},
               [&](int form) { resolve_eta(v, elastic, form, medium); });
    v.one_form(true, {{"xi"}, {"alpha"}},
               [&](int form) { medium.xi = form == 1 ? 1.0 / alpha.value_or(1.0) : xi.value_or(1.0); });
}

void fields(Visitor& v, Coupling& coupling) {
    v(key("kappa").unit(rate).doc("turning by strain, kappa n x (eps n)").example("0.5"), coupling.kappa);
    v(key("gamma1")
          .unit(speed)
          .doc("polar turning by lap u (basis laplacian) or div eps (divergence)")
          .example("10.0"),
      coupling.gamma1);
    v(key("gamma2")
          .unit(speed)
          .doc("polar turning by grad div u (laplacian) or grad tr eps (divergence)")
          .example("-10.0"),
      coupling.gamma2);
    v(key("polar_basis")
          .doc("what gamma1 and gamma2 multiply; gamma1_lap = gamma1_div/2, gamma2_lap = gamma2_div + "
               "gamma1_div/2")
          .example("\"laplacian\""),
      choice(coupling.polar_basis,
             {{"laplacian", PolarBasis::laplacian}, {"divergence", PolarBasis::divergence}}));
}

void fields(Visitor& v, Rod& rod) {
    v(key("position").required().unit(length).items(2, 2).doc("start, [x, y]").example("[0.0, 2.5]"),
      rod.position);
    v(key("heading").unit(angle).doc("start direction, counter-clockwise from +x").example("\"90 deg\""),
      rod.heading);
}

void fields(Visitor& v, RodsRun& run) {
    // Written as an interval where the times are a grid; the default grid is left to follow t_end.
    const auto grid = grid_interval(run.output_times, run.t_end);
    const bool is_default = grid && *grid == run.t_end / default_outputs;
    std::vector<double> times = grid ? std::vector<double>{} : run.output_times;
    std::optional<double> interval = is_default ? std::nullopt : grid;
    v(key("t_end").required().unit(time).above(0.0).doc("end of the run").example("30.0"), run.t_end);
    v(key("output_times")
          .unit(time)
          .above(0.0)
          .items(1, static_cast<std::size_t>(max_outputs))
          .doc("times to store, strictly increasing up to t_end, which is added if missing")
          .example("[10.0, 20.0, 30.0]"),
      times);
    v(key("output_interval")
          .unit(time)
          .above(0.0)
          .absent(times.empty() ? "t_end / 200" : "")
          .doc("store i * output_interval and t_end; at most 1000000 times")
          .example("0.5"),
      interval);
    v(key("contact_distance")
          .unit(length)
          .above(0.0)
          .absent("no stop")
          .doc("stop when two rods are this near")
          .example("0.1"),
      run.contact_distance);
    solver_fields(v, run);
    v.one_form(false, {{"output_times"}, {"output_interval"}}, [&](int given) {
        if (run.t_end > 0.0) // else reported already
            given == 0 ? resolve_times(v, run, times) : resolve_interval(v, run, interval);
    });
}

void fields(Visitor& v, Cut& cut) {
    v(key("along").one_of({"x", "y"}).doc("the coordinate that varies").example("\"x\""), cut.along);
    v(key("at").unit(length).doc("the other coordinate").example("0.0"), cut.at);
    v(key("from").required().unit(length).doc("start of the cut").example("-20.0"), cut.from);
    v(key("to").required().unit(length).doc("end of the cut, above from").example("5.0"), cut.to);
    v(key("count").within(2, 1e6).doc("number of points").example("401"), cut.count);
}

void fields(Visitor& v, Field& field) {
    window_fields(v, field.x, field.y, "grid", "no grid");
    v(key("nx").within(2, 4000).doc("grid points in x").example("161"), field.nx);
    v(key("ny").within(2, 4000).doc("grid points in y").example("161"), field.ny);
    v.list(key("cuts").items(0, 100).doc("The field along lines parallel to an axis."), field.cuts);
}

void fields(Visitor& v, Figure& figure) {
    v(key("name").required().file_name().doc("file name without ending").example("\"wake\""), figure.name);
    v(key("kind")
          .required()
          .one_of({"extensional_axis", "polar_streamlines", "cut", "trajectories"})
          .doc("what is drawn: the first two need the grid of [field], cut one of field.cuts, trajectories "
               "[[rods]]")
          .example("\"cut\""),
      figure.kind);
    v(key("title").absent("made from the data").doc("title").example("\"Wake\""), figure.title);
    v(key("cut").within(0, 99).doc("kind cut: index into field.cuts, from 0").example("0"), figure.cut);
    v(key("component").one_of({"Ux", "Uy"}).doc("kind cut: displacement component").example("\"Uy\""),
      figure.component);
    v(key("sqrt_scaled").doc("kind cut: draw |s|^(1/2) U instead of U").example("true"), figure.sqrt_scaled);
    v(key("gammas")
          .unit(speed)
          .items(1, 16)
          .doc("kind polar_streamlines: a panel for each [gamma1, gamma2]")
          .example("[[10.0, 0.0], [0.0, 10.0]]"),
      figure.gammas);
    window_fields(v, figure.x, figure.y, "window", "fit to the data");
}

void fields(Visitor& v, Variant& variant) {
    v(key("name").required().file_name().doc("name in results and file names").example("\"repelled\""),
      variant.name);
    v(key("label").absent("the name").doc("text in the legend").example("\"kappa = -100\""), variant.label);
    v.settings(key("set")
                   .required()
                   .items(1, 100)
                   .doc("keys to change, as for -s on the command line")
                   .example("{ \"coupling.kappa\" = -100.0 }"),
               variant.set);
}

void fields(Visitor& v, Scene& scene) {
    v(key("schema").required().within(1, 1).doc("version of the scene format").example("1"), scene.schema);
    v(key("units")
          .doc("what plain numbers mean: reduced (f/mu, v0) or SI; SI needs [scales]")
          .example("\"reduced\""),
      choice(scene.units, {{"reduced", UnitSystem::reduced}, {"si", UnitSystem::si}}));
    v(key("title").absent("none").doc("title of the report").example("\"Two rods side by side\""),
      scene.title);
    v.table(key("scales").doc(
                "What one reduced unit is worth, always in SI. Needed for units = \"si\" and for strings "
                "with a physical unit."),
            scene.scales);
    v.use_units({scene.units, scene.scales, true});
    v.table(key("medium").doc("The elastic continuum."), scene.medium);
    v.table(key("coupling").doc("How a rod turns in the strain of the others."), scene.coupling);
    v.list(key("rods").items(0, max_rods).doc("One entry for each rod."), scene.rods);
    v.table(key("rods_run").doc("Integration of the rods."), scene.rods_run);
    v.table(
        key("field").doc("The field of one rod at the origin heading along +x, on a grid and along cuts."),
        scene.field);
    v.list(key("figures").items(0, 100).doc("What `rodwake plot` draws."), scene.figures);
    v.list(key("variants").items(0, 100).doc("The rods run again with some keys changed."), scene.variants);
    for (const char* name : {"noise", "granular", "measure", "fit", "scan"})
        v.planned(name);
}

} // namespace rodwake::scene
