// Field list of [fit]. Lengths are in the profiles' own unit (fields(Scene) says so).

#include "fields.hpp"

#include <fmt/format.h>

namespace rodwake::scene {

namespace {

using enum Dimension;

void parameter_fields(Visitor& v, Fit& fit) {
    const auto names = fit_parameter_names();
    v(key("parameters")
          .required()
          .one_of(names)
          .items(0, names.size())
          .doc(
              "names of the parameters that are fitted; of tracks there may be none: rods that nothing turns")
          .example("[\"f_over_mu\", \"eta\", \"xi\"]"),
      fit.parameters);
    v(key("start")
          .one_of(names)
          .absent("1 for f_over_mu, eta, alpha, kappa, amplitude, force, c11, c22 and c66, 10 for xi (1 with "
                  "trajectories alone), 0.1 for gamma_rows, 0.05 for stall_overlap, 1 for mobility_ratio, "
                  "0.01 for D_r, 1e-4 for D_t, 0 for others")
          .doc("where the search starts; of no use for one that is fixed or tied")
          .example("{ f_over_mu = 2.0, eta = 1.0, alpha = 0.2 }"),
      fit.start);
    v(key("bounds")
          .one_of(names)
          .absent("[1e-6, 1e6] for eta, xi and alpha, [1e-4, 0.5] for stall_overlap, [1e-3, 1e3] for "
                  "mobility_ratio, [0, 100] for D_r and D_t, none for others")
          .doc("[low, high] within which a parameter is searched")
          .example("{ eta = [0.05, 50.0] }"),
      fit.bounds);
    v(key("fixed")
          .one_of(names)
          .absent("none")
          .doc(
              "values of parameters that are not fitted. A term takes part if and only if its strength is in "
              "parameters, fixed or tied")
          .example("{ f2d_over_mu = 0.1 }"),
      fit.fixed);
    v(key("fixed_errors")
          .one_of(names)
          .absent("none: the values of fixed are exact")
          .doc("standard errors of values in fixed: the fit is made again with each value moved by its error "
               "either way, and what that changes is added to the errors")
          .example("{ c66 = 0.02 }"),
      fit.fixed_errors);
    v(key("tied")
          .one_of(names)
          .absent("none")
          .doc("parameters that are a factor times a fitted one: [name, factor]")
          .example("{ f2d_over_mu = [\"f_over_mu\", 0.5] }"),
      fit.tied);
    v(key("measured_drag")
          .written_if(fit.measured_drag)
          .doc("drag_area is held at what measure.mechanics of this run found, with its error (as in fixed "
               "and "
               "fixed_errors): drift of the bed over the speed of the rod through it, times the area of the "
               "box")
          .example("true"),
      fit.measured_drag);
    v(key("log")
          .one_of(names)
          .items(0, names.size())
          .doc("searched in the logarithm, which gives intervals even in the logarithm; needs bounds above 0")
          .example("[\"eta\", \"xi\", \"alpha\"]"),
      fit.log);
}

void model_fields(Visitor& v, Fit& fit) {
    v(key("box")
          .symbol("L")
          .unit(length)
          .above(0.0)
          .absent("infinite plane")
          .doc("the periodic box in which the data were measured, its side, or a list of two, "
               "along the axes of the files: images count, and U of profiles is relative to its mean over "
               "the box")
          .example("\"78 a\""),
      fit.box);
    v(key("heading").unit(angle).doc("of the rod against the sides of box").example("\"30 deg\""),
      fit.heading);
    v(key("core")
          .unit(length)
          .within(0.0, 1e12)
          .doc("points closer than this to the rod along a profile are not fitted")
          .example("\"8 a\""),
      fit.core);
    v(key("independent_spacing")
          .unit(length)
          .above(0.0)
          .absent("all points are independent")
          .doc("points closer to each other share data: sigma is multiplied by "
               "sqrt(independent_spacing/spacing of the points) if that is above 1, of maps by "
               "independent_spacing/spacing of the bins")
          .example("\"4.2 a\""),
      fit.independent_spacing);
}

void search_fields(Visitor& v, fitting::SearchOptions& search) {
    using fitting::Algorithm, fitting::Loss;
    v(key("method")
          .doc("how the minimum is searched: bobyqa, nelder-mead without derivatives; slsqp, lbfgs, mma with "
               "the "
               "gradient; mlsl, crs, isres, direct-l all over the bounds, which every parameter then needs")
          .example("\"bobyqa\""),
      choice(search.algorithm, {{"slsqp", Algorithm::slsqp},
                                {"bobyqa", Algorithm::bobyqa},
                                {"nelder-mead", Algorithm::nelder_mead},
                                {"lbfgs", Algorithm::lbfgs},
                                {"mma", Algorithm::mma},
                                {"mlsl", Algorithm::mlsl},
                                {"crs", Algorithm::crs},
                                {"isres", Algorithm::isres},
                                {"direct-l", Algorithm::direct_l}}));
    v(key("loss")
          .doc("squares: sum of r^2; huber, cauchy: residuals beyond loss_width count less")
          .example("\"huber\""),
      choice(search.loss, {{"squares", Loss::squares}, {"huber", Loss::huber}, {"cauchy", Loss::cauchy}}));
    v(key("loss_width").above(0.0, 1e6).doc("of huber and cauchy, in sigma").example("1.5"),
      search.loss_width);
    v(key("polish")
          .doc("go on from where the method ended to a stationary point (Levenberg-Marquardt)")
          .example("true"),
      search.levenberg_marquardt);
    v(key("starts").within(1, 1e6).doc("number of starts; the best end counts").example("20"), search.starts);
    v(key("spread")
          .above(1.0, 1e6)
          .doc("the starts after the first lie within this factor of it, or between the bounds")
          .example("10.0"),
      search.spread);
    v(key("seed")
          .within(0, largest_seed)
          .doc("of the starts and of random searches; --seed replaces it")
          .example("1"),
      search.seed);
    v(key("tolerance").above(0.0, 0.1).doc("relative, of parameters and chi2").example("1e-10"),
      search.tolerance);
    v(key("max_evaluations")
          .within(1, 1e9)
          .doc("of the residuals in each search; Levenberg-Marquardt steps at its end are not counted")
          .example("2000"),
      search.max_evaluations);
}

void unit_field(Visitor& v, Fit& fit) {
    v(key("length_unit")
          .absent("none")
          .doc("unit of length of the profiles and maps: m, cm, mm, um or a, into which strings with a "
               "unit are converted; any other name is for reports, and strings with another unit are refused")
          .example("\"a\""),
      fit.length_unit);
}

/// What is in the file's numbers: those of [scales] where the rods of the scene are written in them.
void scale_fields(Visitor& v, FitTrajectory& t, const Scales& scales) {
    std::optional<double> f_over_mu = t.f_over_mu, v0 = t.speed;
    v(key("f_over_mu")
          .unit(length)
          .above(0.0)
          .absent("[scales] with units = \"si\", else 1")
          .doc("what one f/mu is in the file's numbers; tracks.csv is in metres, and so is rods.csv with "
               "units = "
               "\"si\". Couplings, eta and xi come in reduced units: kappa in mu v0/f, gamma1 and gamma2 in "
               "v0, xi "
               "in f/mu")
          .example("\"0.88 mm\""),
      f_over_mu);
    v(key("speed")
          .unit(speed)
          .above(0.0)
          .absent("v0 of [scales] with units = \"si\", else 1")
          .doc("what one v0 is in the file's numbers")
          .example("\"2.8 mm/s\""),
      v0);
    v.derive([&] {
        t.f_over_mu = f_over_mu.value_or(scales.f_over_mu);
        t.speed = v0.value_or(scales.v0);
    });
}

} // namespace

void column_fields(Visitor& v, ColumnUnits& columns, const FitUnits& units) {
    const auto item = [&](const char* name, const char* what, std::string& unit, double& factor) {
        v(key(name).absent("length_unit of [fit]").written_if(!unit.empty()).doc(what).example("\"um\""),
          unit);
        v.derive([&] {
            const double radius = units.profiles.scales->bead_radius;
            const auto from = metres(unit, radius), to = metres(units.profiles.word, radius);
            factor = from && to ? *from / *to : 1.0;
            if (!unit.empty() && unit != units.profiles.word && !(from && to))
                v.complain(
                    name,
                    fmt::format("= \"{}\" cannot be converted to length_unit = \"{}\": both must be one of "
                                "m, cm, mm, um, a",
                                unit, units.profiles.word));
        });
    };
    item("place_unit", "unit of the positions in the file, if it is another", columns.place,
         columns.place_factor);
    item("value_unit", "of the displacements and sigmas in the file", columns.value, columns.value_factor);
}

void fields(Visitor& v, FitProfile& p, const FitUnits& units) {
    v(key("file")
          .required()
          .doc(
              "CSV with columns x (position along the line), value and optional sigma. Looked for in the run "
              "directory if the scene has [measure], then beside the scene, then where the program runs")
          .example("\"profile_Ux_x.csv\""),
      p.file);
    v(key("component").one_of({"Ux", "Uy"}).doc("what was measured, in the rod's frame").example("\"Uy\""),
      p.component);
    v(key("along").one_of({"x", "y"}).doc("the axis of the rod's frame along which it was").example("\"y\""),
      p.along);
    v(key("at").unit(length).doc("the other coordinate").example("\"4 a\""), p.at);
    v(key("range")
          .unit(length)
          .items(2, 2)
          .absent("all points")
          .doc("[from, to]: positions outside are not read")
          .example("[10.0, 39.0]"),
      p.range);
    v(key("role").doc("fit, or predict: compared with the fit, not fitted").example("\"predict\""),
      choice(p.role, {{"fit", FitRole::fit}, {"predict", FitRole::predict}}));
    v(key("name")
          .absent("the file's name without ending")
          .doc("name in reports")
          .example("\"along the wake\""),
      p.name);
    column_fields(v, p.columns, units);
}

void fields(Visitor& v, FitTrajectory& t, const FitUnits& units) {
    v(key("file")
          .required()
          .doc(
              "CSV with columns t,x0,y0,theta0,x1,... as in rods.csv, tracks.csv and rod_tracks.csv, which a "
              "scene with [tracks] makes; looked for as profiles are. Headings may jump by whole turns; rows "
              "with an empty field, in which a rod is not known, are left out")
          .example("\"rods.csv\""),
      t.file);
    v(key("rods")
          .within(0, 999)
          .items(1, 100)
          .absent("all of the file")
          .written_if(!t.rods.empty())
          .doc("which rods of the file, from 0")
          .example("[0, 1]"),
      t.rods);
    v(key("sigma_position")
          .above(0.0)
          .absent("1, and errors from the scatter")
          .doc("standard error of positions, in the file's unit; comes with sigma_heading")
          .example("0.1"),
      t.sigma_position);
    v(key("sigma_heading")
          .above(0.0)
          .absent("1, and errors from the scatter")
          .doc("of headings, rad")
          .example("0.05"),
      t.sigma_heading);
    v(key("free_headings").doc("fit the headings at the start too").example("true"), t.free_headings);
    v(key("start_poses")
          .written_if(t.start_poses != StartPoses::automatic)
          .doc("positions and headings of the first row: fitted (data like the others), exact, or auto: "
               "fitted if "
               "sigma_position is given")
          .example("\"exact\""),
      choice(
          t.start_poses,
          {{"auto", StartPoses::automatic}, {"fitted", StartPoses::fitted}, {"exact", StartPoses::exact}}));
    v(key("contact_distance")
          .above(0.0)
          .absent("no stop")
          .doc("the rods stop there, in the file's unit")
          .example("0.1"),
      t.contact_distance);
    v(key("contact_time")
          .above(0.0)
          .absent("not fitted")
          .doc("when they met, a datum; needs contact_distance")
          .example("40.6"),
      t.contact_time);
    v(key("sigma_contact").above(0.0).absent("1").doc("standard error of contact_time").example("0.01"),
      t.sigma_contact);
    v(key("independent_time")
          .above(0.0)
          .absent("all rows are independent")
          .doc("rows closer in time share noise: their sigmas are multiplied by "
               "sqrt(independent_time/interval of the rows) if that is above 1; in the file's unit")
          .example("1.5"),
      t.independent_time);
    v.use_units(units.tracks);
    scale_fields(v, t, units.scales);
    v.use_units(units.profiles);
    v(key("name").absent("the file's name without ending").doc("name in reports").example("\"pair\""),
      t.name);
}

void fields(Visitor& v, FitCompare& c) {
    v(key("name").required().doc("name in reports").example("\"paper\""), c.name);
    v(key("values")
          .one_of(fit_parameter_names())
          .absent("with line: what it gives")
          .doc("values of parameters of this fit; those not named are as fitted. Where maps are fitted with "
               "f_over_mu and eta: of a point force, so that moments are 0")
          .example("{ f_over_mu = 2.2, eta = 1.3, xi = 22.0 }"),
      c.values);
    v(key("line")
          .within(0, 99)
          .absent("values are given")
          .doc("the profile, from 0, that a point force is fitted to by itself, with f_over_mu, eta and xi: "
               "the medium that this line alone would give. Of fits of maps with f_over_mu and eta")
          .example("0"),
      c.line);
}

void fields(Visitor& v, Fit& fit, FitUnits units) {
    v(key("name")
          .file_name()
          .written_if(fit.name != Fit{}.name)
          .doc("of the fit as written, beside [[fit.models]]")
          .example("\"strain\""),
      fit.name);
    v.derive([&] { unit_field(v, fit); }); // read before the lengths, written behind them
    units.profiles = file_units(units.profiles.scales->bead_radius, fit.length_unit);
    v.use_units(units.profiles);
    parameter_fields(v, fit);
    model_fields(v, fit);
    search_fields(v, fit.search);
    v(key("likelihood")
          .one_of(fit_parameter_names())
          .items(0, fit_parameter_names().size())
          .doc("parameters whose 95 % interval is also taken from the profile likelihood")
          .example("[\"eta\"]"),
      fit.likelihood);
    unit_field(v, fit);
    map_fields(v, fit);
    v.list(key("profiles").items(0, 100).doc("Measured displacement along a line."), fit.profiles,
           [&](FitProfile& profile) { fields(v, profile, units); });
    v.list(key("trajectories").items(0, 100).doc("Measured tracks of rods."), fit.trajectories,
           [&](FitTrajectory& track) { fields(v, track, units); });
    v.list(
        key("maps").items(0, 100).doc("Measured displacement on a grid, fitted with an orthotropic medium."),
        fit.maps, [&](FitMap& map) { fields(v, map, units); });
    v.list(key("masks").items(0, 100).doc("Which bins of the maps are left out. The first belongs to the "
                                          "fit, which is repeated with each of the others, and the spread of "
                                          "the parameters over all is reported as the error of the choice."),
           fit.masks);
    v.list(key("compare").items(0, 20).doc(
               "Other parameter values, drawn and scored for comparison with the fit."),
           fit.compare);
    v.table(
        key("posterior")
            .doc(
                "Samples of the parameters given data and priors, and the evidence of the model. With loss = "
                "\"squares\" and data whose standard errors are known."),
        fit.posterior);
    v.list(key("models").items(0, 50).doc("Model comparison: fits of the same data with some keys changed, "
                                          "compared with each other and with the fit as written."),
           fit.models);
}

void fields(Visitor& v, FitModel& model) {
    v(key("name").required().file_name().doc("name in results and file names").example("\"shifted\""),
      model.name);
    v(key("set")
          .required()
          .items(1, 100)
          .doc("keys to change, as for -s on the command line. Entries of fit.start, fit.bounds, "
               "fit.likelihood "
               "and fit.posterior.priors for parameters that this model does not have are left out. "
               "Parameters "
               "that its fit does not name are as in medium and coupling")
          .example("{ \"fit.fixed.offset\" = 0.1 }"),
      Settings{model.set});
}

void fields(Visitor& v, FitPosterior& posterior) {
    v(key("chains").within(1, 64).doc("chains, each from a start of its own").example("4"), posterior.chains);
    v(key("samples")
          .within(8, 1e7)
          .doc("kept, of all chains together: a multiple of chains, at least 8 per chain")
          .example("4000"),
      posterior.samples);
    v(key("evidence")
          .doc(
              "find the logarithm of the evidence, too, and sample every model of [[fit.models]] for its own")
          .example("true"),
      posterior.evidence);
    v(key("priors")
          .one_of(fit_parameter_names())
          .absent("uniform between the bounds")
          .doc("what is known of a parameter before the data: kind = uniform, log_uniform (low, high) or "
               "normal (mean, sd, cut at low and high); low and high are the bounds unless given")
          .example("{ eta = { kind = \"log_uniform\", low = 0.05, high = 50.0 } }"),
      posterior.priors);
}

// Field list of what belongs to [[fit.maps]].

void fields(Visitor& v, FitMap& map, const FitUnits& units) {
    v(key("files")
          .required()
          .items(1, 1000)
          .doc("measure.h5 of rodwake measure, or CSV with columns x,y,Ux,Uy and optional sigma_x,sigma_y of "
               "a "
               "full grid, in the rod's frame; looked for as profiles are. Several are runs alike: with two "
               "or "
               "more in each table the errors are also taken from leaving out one run after the other")
          .example("[\"measure.h5\"]"),
      map.files);
    v(key("speed")
          .within(-1e12, 1e12)
          .absent("mean_speed of measure.h5, in a/s; needed with CSV where zeta, rho or eta_s is a parameter")
          .doc("of the rod against the medium along its heading, negative: backwards; length_unit over the "
               "unit of time of zeta, rho and eta_s")
          .example("2.6"),
      map.speed);
    v(key("box")
          .unit(length)
          .items(2, 2)
          .absent("from measure.h5; needed with CSV")
          .doc("sides of the periodic box along and across the heading; a measure.h5 knows its own, "
               "from which these may differ by 1 % and no more")
          .example("[\"78 a\", \"78 a\"]"),
      map.box);
    v(key("name").absent("from the files").doc("name in reports").example("\"free rod\""), map.name);
    column_fields(v, map.columns, units);
}

void fields(Visitor& v, FitMask& mask) {
    v(key("strip")
          .unit(length)
          .within(0.0, 1e12)
          .doc("bins with |y| below this are left out: the rows that the rod pushes along")
          .example("\"8 a\""),
      mask.strip);
    v(key("radius")
          .unit(length)
          .within(0.0, 1e12)
          .doc("bins closer to the rod's centre are left out")
          .example("\"10 a\""),
      mask.radius);
    v(key("sector")
          .unit(angle)
          .items(2, 2)
          .absent("all round")
          .doc("[from, to]: only bins whose direction from the rod makes such an angle with the heading, "
               "0 ahead and 180 deg behind, on both sides")
          .example("[\"90 deg\", \"180 deg\"]"),
      mask.sector);
}

void map_fields(Visitor& v, Fit& fit) {
    v(key("rod_length")
          .unit(length)
          .within(0.0, 1e12)
          .doc("of maps: the force is spread evenly over this length along the heading")
          .example("\"11.25 a\""),
      fit.rod_length);
    v(key("source_width")
          .unit(length)
          .above(0.0, 1e12)
          .doc("of maps: standard deviation of the Gaussian that smooths force, dipoles and so the field; "
               "1/1000 "
               "to 1/4 of the box")
          .example("\"1 a\""),
      fit.source_width);
}

} // namespace rodwake::scene
