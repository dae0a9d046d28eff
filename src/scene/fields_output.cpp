// Field lists of what is shown: [field] and its cuts, [[figures]], [[variants]].

#include "fields.hpp"

#include <set>

namespace rodwake::scene {

namespace {

using enum Dimension;

void window_fields(Visitor& v, std::vector<double>& x, std::vector<double>& y, const std::string& what,
                   const std::string& absent) {
    v(key("x").unit(length).items(2, 2).absent(absent).doc(what + ", [min, max] of x").example("[-5.0, 5.0]"),
      x);
    v(key("y").unit(length).items(2, 2).absent(absent).doc(what + ", [min, max] of y").example("[-5.0, 5.0]"),
      y);
}

void fit_figure_fields(Visitor& v, Figure& figure) {
    v(key("profiles")
          .within(0, 99)
          .items(1, 100)
          .absent("all")
          .written_if(figure.kind == "fit")
          .doc("kind fit: which of fit.profiles, indices from 0, a panel each")
          .example("[0, 1]"),
      figure.profiles);
    v(key("residuals")
          .written_if(figure.kind == "fit")
          .doc("kind fit: residuals in sigma under each panel")
          .example("false"),
      figure.residuals);
    v(key("parameter")
          .one_of(fit_parameter_names())
          .absent("the first of fit.likelihood")
          .written_if(figure.kind == "fit_likelihood")
          .doc("kind fit_likelihood: whose profile likelihood")
          .example("\"eta\""),
      figure.parameter);
}

} // namespace

bool shows_measures(const Figure& figure) {
    static const std::set<std::string> kinds = {
        "pair_correlation", "bond_order",       "msd",        "series", "flow", "dragged",
        "profile",          "displacement_map", "pair_tracks"};
    return kinds.contains(figure.kind);
}

bool shows_the_fit(const Figure& figure) { return figure.kind.starts_with("fit"); }

bool shows_the_bed(const Figure& figure) {
    static const std::set<std::string> kinds = {"snapshot", "rod_tracks", "side_view", "movie",
                                                "granular_table"};
    return kinds.contains(figure.kind) || shows_measures(figure);
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

void fields(Visitor& v, Figure& figure, const FigureUnits& units) {
    const auto is_kind = [&](const char* kind) { return figure.kind == kind; };
    v(key("name").required().file_name().doc("file name without ending").example("\"wake\""), figure.name);
    v(key("kind")
          .required()
          .one_of({"extensional_axis",
                   "polar_streamlines",
                   "cut",
                   "trajectories",
                   "snapshot",
                   "rod_tracks",
                   "side_view",
                   "movie",
                   "granular_table",
                   "pair_correlation",
                   "bond_order",
                   "msd",
                   "series",
                   "flow",
                   "dragged",
                   "profile",
                   "displacement_map",
                   "pair_tracks",
                   "fit",
                   "fit_starts",
                   "fit_likelihood",
                   "fit_correlation",
                   "fit_trajectories"})
          .doc("what is drawn: the first two need the grid of [field], cut one of field.cuts, trajectories "
               "[[rods]], the five from snapshot on [granular], those of the fit [fit], the others what they "
               "show in [measure]")
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
          .written_if(is_kind("cut") || is_kind("profile"))
          .doc("kinds cut, profile: displacement component")
          .example("\"Uy\""),
      figure.component);
    v(key("sqrt_scaled")
          .written_if(is_kind("cut") || is_kind("profile"))
          .doc("kinds cut, profile: draw |s|^(1/2) U instead of U")
          .example("true"),
      figure.sqrt_scaled);
    v(key("along")
          .one_of({"x", "y"})
          .written_if(is_kind("profile"))
          .doc("kind profile: the axis of the rod's frame along which U is drawn")
          .example("\"y\""),
      figure.along);
    v(key("quantity")
          .one_of({"psi6", "stiffness", "exponent", "delta_y", "non_reciprocity", "force", "speed"})
          .written_if(is_kind("series"))
          .doc("kind series: what is drawn, a point for the scene and one for each of [[variants]]")
          .example("\"stiffness\""),
      figure.quantity);
    v(key("against")
          .one_of({"phi_b", "d0", "imposed_speed"})
          .written_if(is_kind("series"))
          .doc("kind series: against what; d0 is the separation at which a pair starts")
          .example("\"imposed_speed\""),
      figure.against);
    v(key("gammas")
          .written_if(is_kind("polar_streamlines"))
          .unit(speed)
          .items(1, 16)
          .doc("kind polar_streamlines: a panel for each [gamma1, gamma2]")
          .example("[[10.0, 0.0], [0.0, 10.0]]"),
      figure.gammas);
    v(key("frame")
          .within(-1, 1e9)
          .written_if(is_kind("snapshot"))
          .doc("kind snapshot: which stored frame, from 0; -1: the last")
          .example("-1"),
      figure.frame);
    v(key("colour")
          .one_of({"order", "orientation"})
          .written_if(is_kind("snapshot") || is_kind("movie"))
          .doc("kinds snapshot, movie: what colours the beads, their sixfold order or the direction of their "
               "close-packed rows")
          .example("\"order\""),
      figure.colour);
    v(key("fps")
          .within(1, 120)
          .written_if(is_kind("movie"))
          .doc("kind movie: stored frames shown a second")
          .example("20"),
      figure.fps);
    fit_figure_fields(v, figure);
    v.use_units(shows_the_fit(figure) ? units.fit : shows_the_bed(figure) ? units.bed : units.scene);
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

} // namespace rodwake::scene
