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

/// Whether the times are in order; if not, it is reported.
bool increasing(Visitor& v, const RodsRun& run, const std::vector<double>& times) {
    for (std::size_t i = 0; i < times.size(); ++i)
        if (times[i] > run.t_end || (i > 0 && times[i] <= times[i - 1])) {
            v.complain("output_times",
                       fmt::format("entry {} is {} f/(mu v0): times must increase strictly "
                                   "within 0 <= t <= t_end = {}",
                                   i, times[i], run.t_end));
            return false;
        }
    return true;
}

void resolve_times(Visitor& v, RodsRun& run, std::vector<double> times) {
    if (!increasing(v, run, times))
        return;
    if (!times.empty() && times.front() == 0.0)
        times.erase(times.begin()); // the start is stored in any case
    if (times.empty() || times.back() < run.t_end)
        times.push_back(run.t_end);
    run.output_times = std::move(times);
}

void resolve_interval(Visitor& v, RodsRun& run, std::optional<double> interval) {
    const double step = interval.value_or(run.t_end / default_outputs);
    if (step > run.t_end || run.t_end / step > max_outputs)
        return v.complain(
            "output_interval",
            fmt::format("is {} f/(mu v0): must be between t_end/1000000 and t_end = {}", step, run.t_end));
    run.output_times = output_grid(step, run.t_end);
}

/// The ways to say how long a run is and when it is stored, in the order of resolve_run's cases.
const Forms run_forms = {
    {"t_end"}, {"t_end", "output_interval"}, {"t_end", "output_times"}, {"output_times"}};
constexpr int without_t_end = 3;

struct RunTimes {
    std::optional<double> t_end, interval;
    std::vector<double> times;
};

void resolve_run(Visitor& v, RodsRun& run, const RunTimes& given, int form) {
    run.t_end_from_outputs = form == without_t_end;
    const double last = given.times.empty() ? 0.0 : given.times.back();
    run.t_end = run.t_end_from_outputs ? last : given.t_end.value_or(0.0);
    if (run.t_end_from_outputs && given.times == std::vector{0.0})
        return v.complain("output_times", "has no entry above 0, so the run has no end: give t_end");
    if (!(run.t_end > 0.0)) // reported already
        return;
    form < 2 ? resolve_interval(v, run, given.interval) : resolve_times(v, run, given.times);
}

/// Coordinates matter on the scale of f/mu, headings on that of a radian.
double default_atol(double rtol) { return rtol / 100.0; }

void solver_fields(Visitor& v, RodsRun& run) {
    std::string form = "angle"; // the only one so far
    v(key("method")
          .doc("CVODES BDF or Adams, ARKODE explicit Runge-Kutta; auto: explicit Runge-Kutta, or BDF for "
               "stiff headings")
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
    v.derive([&] { run.atol = atol.value_or(default_atol(run.rtol)); });
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

void fields(Visitor& v, FieldTable& table) {
    v(key("tolerance").within(1e-14, 1e-1).doc("relative error of the tabulated field").example("1e-8"),
      table.tolerance);
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
    v.table(key("table").doc("Interpolation of the field; not used with field = \"exact\"."), medium.table);
    v.one_form({{"eta"}, {"poisson_ratio"}, {"lame_lambda", "mu"}, {"bulk_modulus", "mu"}},
               [&](int form) { resolve_eta(v, elastic, form, medium); });
    v.one_form({{"xi"}, {"alpha"}},
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

void fields(Visitor& v, Noise& noise) {
    v(key("rotational_diffusion")
          .unit(rate)
          .within(0.0, 0.0)
          .because("noise is not available in this version")
          .doc("diffusion coefficient of the headings, rad^2 per time")
          .example("0.0"),
      noise.rotational_diffusion);
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
    RunTimes given;
    if (!run.t_end_from_outputs && run.t_end > 0.0)
        given.t_end = run.t_end;
    if (run.t_end_from_outputs || !grid)
        given.times = run.output_times;
    else if (!is_default)
        given.interval = grid;
    v(key("t_end")
          .unit(time)
          .above(0.0)
          .absent("the last of output_times")
          .doc("end of the run; needed unless output_times are given")
          .example("30.0"),
      given.t_end);
    v(key("output_times")
          .unit(time)
          .within(0.0, 1e12)
          .items(1, static_cast<std::size_t>(max_outputs))
          .doc("times to store, strictly increasing up to t_end; 0 and t_end are stored in any case")
          .example("[10.0, 20.0, 30.0]"),
      given.times);
    v(key("output_interval")
          .unit(time)
          .above(0.0)
          .absent(given.times.empty() ? "t_end / 200" : "")
          .doc("store i * output_interval and t_end; at most 1000000 times")
          .example("0.5"),
      given.interval);
    v(key("contact_distance")
          .unit(length)
          .above(0.0)
          .absent("no stop")
          .doc("stop when two rods are this near")
          .example("0.1"),
      run.contact_distance);
    solver_fields(v, run);
    v.one_form(run_forms, [&](int form) { resolve_run(v, run, given, form); });
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
    const auto is_kind = [&](const char* kind) { return figure.kind == kind; };
    v(key("name").required().file_name().doc("file name without ending").example("\"wake\""), figure.name);
    v(key("kind")
          .required()
          .one_of({"extensional_axis", "polar_streamlines", "cut", "trajectories"})
          .doc("what is drawn: the first two need the grid of [field], cut one of field.cuts, trajectories "
               "[[rods]]")
          .example("\"cut\""),
      figure.kind);
    v(key("title").absent("made from the data").doc("title").example("\"Wake\""), figure.title);
    v(key("cut")
          .within(0, 99)
          .written_if(is_kind("cut"))
          .doc("kind cut: index into field.cuts, from 0")
          .example("0"),
      figure.cut);
    v(key("component")
          .one_of({"Ux", "Uy"})
          .written_if(is_kind("cut"))
          .doc("kind cut: displacement component")
          .example("\"Uy\""),
      figure.component);
    v(key("sqrt_scaled")
          .written_if(is_kind("cut"))
          .doc("kind cut: draw |s|^(1/2) U instead of U")
          .example("true"),
      figure.sqrt_scaled);
    v(key("gammas")
          .written_if(is_kind("polar_streamlines"))
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
    v.table(key("noise").doc("Random turning of the rods."), scene.noise);
    v.list(key("rods").items(0, max_rods).doc("One entry for each rod."), scene.rods);
    v.table(key("rods_run").doc("Integration of the rods."), scene.rods_run);
    v.table(
        key("field").doc("The field of one rod at the origin heading along +x, on a grid and along cuts."),
        scene.field);
    v.list(key("figures").items(0, 100).doc("What `rodwake plot` draws."), scene.figures);
    v.list(key("variants").items(0, 100).doc("The rods run again with some keys changed."), scene.variants);
    for (const char* name : {"granular", "measure", "fit", "scan"})
        v.planned(name);
}

} // namespace rodwake::scene
