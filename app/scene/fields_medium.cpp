// Field lists of the physics: [medium], [coupling], [noise].

#include "fields.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/elastic/medium.hpp"

#include <fmt/format.h>

namespace rodwake::scene {

namespace {

using enum Dimension;

/// The keys of [medium] that give eta. A resolved scene has eta itself.
struct EtaForms {
    std::optional<double> eta, poisson_ratio, lame_lambda, bulk_modulus, mu;
};

constexpr KeyAlternative eta_forms[] = {
    {"eta"}, {"poisson_ratio"}, {"lame_lambda", "mu"}, {"bulk_modulus", "mu"}};
constexpr KeyAlternative xi_forms[] = {{"xi"}, {"alpha"}};

void eta_keys(Visitor& v, EtaForms& k, bool written) {
    v(key("eta")
          .symbol("\\eta")
          .above(-1.0)
          .written_if(written)
          .because("the longitudinal modulus 1 + eta must be positive")
          .doc("(lambda_L + mu)/mu, the coefficient of grad div over mu; in 2-D also K/mu, so > 0 in a "
               "stable free-standing material; -1 < eta < 0 is admissible only mathematically")
          .example("1.0"),
      k.eta);
    v(key("poisson_ratio")
          .symbol("\\nu")
          .above(-1.0, 1.0 - 1e-12)
          .because("the bulk modulus of a 2-D medium is positive and finite only for -1 < nu < 1")
          .doc("2-D Poisson ratio nu = lambda_L/(lambda_L + 2 mu), below 0 in auxetic materials; eta = "
               "(1 + nu)/(1 - nu), which is > 0, as in every stable free-standing material")
          .example("0.3"),
      k.poisson_ratio);
    v(key("lame_lambda")
          .symbol("\\lambda_L")
          .doc("lambda_L of the free energy F = int [lambda_L (tr eps)^2/2 + mu tr(eps^2)], any unit, the "
               "same as mu; "
               "eta = (lambda_L + mu)/mu")
          .example("0.5"),
      k.lame_lambda);
    v(key("bulk_modulus")
          .symbol("K")
          .doc("2-D bulk modulus K = lambda_L + mu, any unit, the same as mu; eta = K/mu")
          .example("1.5"),
      k.bulk_modulus);
    v(key("mu")
          .symbol("\\mu")
          .above(0.0)
          .doc("shear modulus, any unit, beside lame_lambda or bulk_modulus")
          .example("1.0"),
      k.mu);
}

/// Sets eta from the given form, an index into eta_forms.
void resolve_eta(Visitor& v, const EtaForms& keys, int form, Medium& medium) try {
    double eta = keys.eta.value_or(1.0);
    if (form == 1)
        eta = elastic::eta_from_poisson_ratio(keys.poisson_ratio.value_or(0.0));
    if (form == 2)
        eta = elastic::eta_from_lame(keys.lame_lambda.value_or(0.0), keys.mu.value_or(1.0));
    if (form == 3)
        eta = elastic::eta_from_bulk_modulus(keys.bulk_modulus.value_or(1.0), keys.mu.value_or(1.0));
    elastic::validate({eta, 1.0});
    medium.eta = eta;
} catch (const InputError& error) { // a bad eta by itself has been reported by its range
    if (form > 0)
        v.complain(eta_forms[form].first, fmt::format("is not usable: {}", error.what()));
}

/// Reports what a fitted medium must not be given; whether there was any.
bool refuse_given(Visitor& v, const EtaForms& k, const std::optional<double>& xi,
                  const std::optional<double>& alpha) {
    const std::pair<const char*, bool> keys[] = {{"eta", k.eta.has_value()},
                                                 {"poisson_ratio", k.poisson_ratio.has_value()},
                                                 {"lame_lambda", k.lame_lambda.has_value()},
                                                 {"bulk_modulus", k.bulk_modulus.has_value()},
                                                 {"mu", k.mu.has_value()},
                                                 {"xi", xi.has_value()},
                                                 {"alpha", alpha.has_value()}};
    bool any = false;
    for (const auto& [name, is_given] : keys)
        if (is_given) {
            any = true;
            v.complain(name, "is given together with medium.fitted = true, which takes eta and xi from "
                             "[fit]: leave one out");
        }
    return any;
}

} // namespace

void fields(Visitor& v, FieldTable& table) {
    v(key("tolerance").within(1e-12, 1e-1).doc("relative error of the tabulated field").example("1e-6"),
      table.tolerance);
}

void fields(Visitor& v, MeasuredMedium& measured) {
    v(key("file")
          .required()
          .doc("measure.h5 of rodwake measure with measure.displacement; looked for in the run's folder if "
               "this "
               "scene measures, beside the scene, and in the working folder. scales.f_over_mu makes f/mu of "
               "its bead radii")
          .example("\"measure.h5\""),
      measured.file);
    v(key("core")
          .unit(length)
          .above(0.0)
          .absent("4 bead radii")
          .doc("closer to the rod theory alone holds: there are no beads")
          .example("1.0"),
      measured.core);
    v(key("edge")
          .unit(length)
          .above(0.0)
          .absent("where the measured field ends")
          .doc("beyond this |x| or |y| in the rod's frame theory alone holds")
          .example("9.0"),
      measured.edge);
    v(key("blend")
          .unit(length)
          .above(0.0)
          .absent("6 bead radii")
          .doc("width over which measured field and theory are mixed, outside the core and inside the edge")
          .example("1.5"),
      measured.blend);
    v(key("correlation")
          .unit(length)
          .within(0.0, 1e12)
          .absent("0.71 lattice spacings, the window of rodwake measure")
          .doc("radius over which the errors of the bins go together in draws")
          .example("0.4"),
      measured.correlation);
    v(key("smoothing")
          .symbol("\\lambda")
          .above(0.0)
          .absent("by generalised cross-validation, for each component")
          .doc("weight of the third differences of the spline")
          .example("10.0"),
      measured.smoothing);
    v(key("samples")
          .within(0.0, 10000.0)
          .doc("runs of the rods in fields drawn from the measured one and its errors (0: none)")
          .example("32"),
      measured.samples);
    v(key("seed").within(0, largest_seed).doc("of these draws").example("1"), measured.seed);
}

void fields(Visitor& v, medium::DynamicMedium& dynamic) {
    using medium::Closure, medium::Evaluation, medium::Start;
    v(key("box")
          .unit(length)
          .above(0.0)
          .doc("side of the periodic square, at least 4 force_width")
          .example("40.0"),
      dynamic.box);
    v(key("force_width")
          .symbol("w")
          .unit(length)
          .above(0.0)
          .doc("width of the force exp(-r^2/(2 w^2))/(2 pi w^2) with which a rod pushes the medium; at least "
               "box/modes, "
               "and at most what rods start apart")
          .example("0.5"),
      dynamic.force_width);
    v(key("modes")
          .within(4.0, 2048.0)
          .doc("wave vectors along a side, |m|, |n| < modes/2; the zero mode is left out")
          .example("96"),
      dynamic.modes);
    v(key("self_field")
          .doc("each rod in the field of all rods including its own; false: in the field of the others "
               "alone, exactly with sums, with the mesh less what its own does to first order in its turning")
          .example("false"),
      dynamic.self_field);
    v(key("start")
          .doc("steady: the fields of rods that have always walked straight; rest: undeformed")
          .example("\"steady\""),
      choice(dynamic.start, {{"steady", Start::steady}, {"rest", Start::rest}}));
    v(key("closure")
          .doc(
              "none: the medium is integrated with the rods; steady: each rod has its steady wake, turned to "
              "its heading at once, so that the difference to none is the error of that closure alone; goes "
              "with start = \"steady\", sums and inertia = 0")
          .example("\"none\""),
      choice(dynamic.closure, {{"none", Closure::none}, {"steady", Closure::steady}}));
    v(key("evaluation")
          .doc("sums: over all modes for each rod, at most 64 rods without self_field; mesh: fast Fourier "
               "transforms, for many rods; auto: sums up to 64 rods, with self_field up to 16, else the mesh")
          .example("\"mesh\""),
      choice(dynamic.evaluation,
             {{"auto", Evaluation::automatic}, {"sums", Evaluation::sums}, {"mesh", Evaluation::mesh}}));
    v(key("inertia")
          .within(0.0, 1e6)
          .doc("rho v0^2/mu beside alpha: (speed of the rods over the speed of transverse sound)^2 (0: "
               "none). Not "
               "with the mesh and self_field = false")
          .example("0.01"),
      dynamic.inertia);
    v(key("film_interval")
          .unit(time)
          .above(0.0)
          .absent("no film")
          .doc("time between the frames of medium_film.h5: the displacement u on a grid, the sum of the "
               "fields "
               "of all rods, also with self_field = false. Not beside a closure; at most 4 GB")
          .example("0.5"),
      dynamic.film_interval);
    v(key("film_grid")
          .within(4.0, 1024.0)
          .doc("points a side of these frames: even, without prime factors but 2, 3 and 5, and no fewer than "
               "box/force_width")
          .example("128"),
      dynamic.film_grid);
}

void fields(Visitor& v, Medium& medium) {
    EtaForms given{medium.eta, {}, {}, {}, {}};
    std::optional<double> xi = medium.xi, alpha;
    bool fitted = medium.fitted;
    eta_keys(v, given, !medium.fitted);
    v(key("xi")
          .symbol("\\xi")
          .unit(length)
          .within(1e-12, 1e12)
          .written_if(!medium.fitted)
          .doc("screening length mu/(zeta v0)")
          .example("1.0"),
      xi);
    v(key("alpha")
          .symbol("\\alpha")
          .within(1e-12, 1e12)
          .doc("(f/mu)/xi = f zeta v0/mu^2, the reading taken here of the paper's alpha, which it does not "
               "define")
          .example("1.0"),
      alpha);
    v(key("field")
          .doc("how the field is evaluated; a table of it is made once, to table.tolerance, and kept in the "
               "user's cache folder; measured: the displacement field of measured.file, with theory where it "
               "has none; dynamic: rods in a medium that remembers, integrated with them, in the box of "
               "[medium.dynamic]")
          .example("\"exact\""),
      choice(medium.field, {{"exact", FieldBackend::exact},
                            {"table", FieldBackend::table},
                            {"measured", FieldBackend::measured},
                            {"dynamic", FieldBackend::dynamic}}));
    v(key("periodic")
          .unit(length)
          .above(0.0)
          .absent("infinite plane")
          .doc("a periodic box for the rods and the field, its side or two, [78.0, 77.0]: each rod acts "
               "with all its images. Tables of the field (field = \"table\") take one side")
          .example("78.0"),
      medium.periodic);
    v(key("fitted")
          .written_if(medium.fitted)
          .doc("eta and xi come from this scene's [fit], in units of its f_over_mu; only with rodwake run. "
               "Then eta, xi and their alternatives are not given")
          .example("true"),
      fitted);
    v.table(key("table").doc(
                "Interpolation of the field; not used with field = \"exact\"; with \"auto\" the required "
                "accuracy of a table (absent: rtol)."),
            medium.table);
    v.table(key("measured").doc("The field of rods in a bed, with field = \"measured\"."), medium.measured);
    v.table(key("dynamic").doc(
                "The medium that remembers, with field = \"dynamic\": alpha d_t u = lap u + eta grad "
                "div u + the rods' forces, in a periodic square."),
            medium.dynamic);
    if (fitted)
        return v.derive([&] { medium.fitted = !refuse_given(v, given, xi, alpha); });
    v.one_form(eta_forms, [&](int form) { resolve_eta(v, given, form, medium); });
    v.one_form(xi_forms,
               [&](int form) { medium.xi = form == 1 ? 1.0 / alpha.value_or(1.0) : xi.value_or(1.0); });
    v.derive([&] { medium.fitted = false; });
}

void fields(Visitor& v, Coupling& coupling) {
    v(key("kappa").symbol("\\kappa").unit(rate).doc("turning by strain, kappa n x (eps n)").example("0.5"),
      coupling.kappa);
    v(key("gamma1")
          .symbol("\\gamma_1")
          .unit(speed)
          .doc("polar turning by lap u (basis laplacian) or div eps (divergence)")
          .example("10.0"),
      coupling.gamma1);
    v(key("gamma2")
          .symbol("\\gamma_2")
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
    v(key("gamma_flow")
          .symbol("\\gamma_v")
          .unit(wavenumber)
          .written_if(coupling.gamma_flow != 0.0)
          .doc("turning to the velocity of the medium, gamma_flow n x du/dt: a rod as a weathercock. In the "
               "theory's "
               "field du/dt = v0 xi (lap u + eta grad div u), so that it is gamma1 = gamma_flow v0 xi with "
               "gamma2 = "
               "eta gamma1 (laplacian)")
          .example("2.0"),
      coupling.gamma_flow);
    v(key("gamma_rows")
          .symbol("\\gamma_6")
          .unit(rate)
          .written_if(coupling.rows.any())
          .doc("alignment with the lattice rows of a crystal, -gamma_rows sin 6(theta - rows_direction), "
               "independent of other rods")
          .example("0.05"),
      coupling.rows.gamma);
    v(key("rows_direction")
          .symbol("\\theta_0")
          .unit(angle)
          .written_if(coupling.rows.any() || coupling.rows.direction != 0.0)
          .doc("direction of a close-packed row, from +x; the others are at multiples of 60 deg from it")
          .example("\"30 deg\""),
      coupling.rows.direction);
}

void fields(Visitor& v, Noise& noise) {
    constexpr double most = 1e6;
    v(key("rotational_diffusion")
          .symbol("D_r")
          .unit(rate)
          .within(0.0, most)
          .doc("theta' += sqrt(2 D_r) white noise: diffusion coefficient of the headings, rad^2 per time")
          .example("0.01"),
      noise.rotational_diffusion);
    v(key("translational_diffusion")
          .symbol("D_t")
          .unit(diffusion)
          .within(0.0, most)
          .doc("the same of x and of y: each rod spreads by 2 D_t t along each axis")
          .example("0.001"),
      noise.translational_diffusion);
    v(key("runs")
          .within(1, 10'000'000)
          .doc("runs of the ensemble, each with noise of its own; rods.csv and outcome.json are of the first")
          .example("1000"),
      noise.runs);
    v(key("capture_error")
          .within(1e-4, 0.5)
          .absent("as many runs as the key runs")
          .doc("more runs until half the 95 % interval of the capture probability is no wider than this, in "
               "a scan "
               "at each point by itself")
          .example("0.05"),
      noise.capture_error);
    v(key("most_runs")
          .within(1, 10'000'000)
          .doc("with capture_error: no more runs than this, however wide the interval; runs are done in any "
               "case")
          .example("2000"),
      noise.most_runs);
    v(key("time_step")
          .unit(time)
          .above(0.0)
          .absent("0.05 of the shortest of f/(mu v0), 1/D_r and the time in which a heading relaxes in the "
                  "wakes of the start; check prints it")
          .doc("longest step; steps are halved where rods come near or turn fast, all on one Brownian path")
          .example("0.02"),
      noise.time_step);
    v(key("seed").within(0, largest_seed).doc("of the noise").example("1"), noise.seed);
}

} // namespace rodwake::scene
