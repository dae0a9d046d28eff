// Field lists of what is shown: [field] and its cuts, [[figures]], [[variants]].

#include "fields.hpp"
#include "figure_kinds.hpp"

namespace rodwake::scene {

namespace {

using enum Dimension;

void window_fields(Visitor& v, std::vector<double>& x, std::vector<double>& y, const char* of_x,
                   const char* of_y, const char* absent) {
    v(key("x").unit(length).items(2, 2).absent(absent).doc(of_x).example("[-5.0, 5.0]"), x);
    v(key("y").unit(length).items(2, 2).absent(absent).doc(of_y).example("[-5.0, 5.0]"), y);
}

void fit_figure_fields(Visitor& v, Figure& figure) {
    v(key("profiles")
          .within(0, 99)
          .items(1, 100)
          .absent("all")
          .written_if(has_key(figure, "profiles"))
          .doc("which of fit.profiles, indices from 0, one panel per index")
          .example("[0, 1]"),
      figure.profiles);
    v(key("residuals")
          .written_if(has_key(figure, "residuals"))
          .doc("residuals in sigma under each panel")
          .example("false"),
      figure.residuals);
    v(key("parameter")
          .one_of(fit_parameter_names())
          .absent("the first of fit.likelihood")
          .written_if(has_key(figure, "parameter"))
          .doc("whose profile likelihood")
          .example("\"eta\""),
      figure.parameter);
}

/// Which one is drawn unless the scene says so depends on the kind.
void component_field(Visitor& v, Figure& figure) {
    v(key("component")
          .one_of({"Ux", "Uy", "U"})
          .absent("Ux; displacement_map: U")
          .written_if(has_key(figure, "component"))
          .doc("displacement component; U, the size, for displacement_map only")
          .example("\"Uy\""),
      figure.component);
    v.derive([&] {
        if (figure.component.empty() && has_key(figure, "component"))
            figure.component = figure.kind == "displacement_map" ? "U" : "Ux";
    });
}

/// As above: beads and points of a scan are coloured by different things.
void colour_field(Visitor& v, Figure& figure) {
    v(key("colour")
          .absent("order; phase_diagram: outcome")
          .written_if(has_key(figure, "colour"))
          .doc("what colours beads, their sixfold order or the direction of their close-packed rows (order, "
               "orientation); of phase_diagram outcome, time (to contact; of beds to capture), "
               "final_separation, "
               "non_reciprocity or any column of scan.csv")
          .example("\"order\""),
      figure.colour);
    v.derive([&] {
        if (figure.colour.empty() && has_key(figure, "colour"))
            figure.colour = figure.kind == "phase_diagram" ? "outcome" : "order";
    });
}

void scan_figure_fields(Visitor& v, Figure& figure) {
    v(key("cells")
          .written_if(has_key(figure, "cells"))
          .doc("outline the cells of an adaptive scan")
          .example("true"),
      figure.cells);
    v(key("boundary")
          .written_if(has_key(figure, "boundary"))
          .doc("draw the boundaries that the scan traced")
          .example("false"),
      figure.boundary);
    v(key("slices")
          .items(1, 9)
          .absent("four at most, over the axis")
          .written_if(has_key(figure, "slices"))
          .doc("of a scan with three axes: values of the third, one panel each")
          .example("[0.0, 10.0]"),
      figure.slices);
    v(key("column")
          .absent("delta_y of beds, else final_separation")
          .written_if(has_key(figure, "column"))
          .doc("column of scan.csv that is drawn")
          .example("\"psi6\""),
      figure.column);
}

} // namespace

void fields(Visitor& v, Cut& cut) {
    v(key("along").one_of({"x", "y"}).doc("the coordinate that varies").example("\"x\""), cut.along);
    v(key("at").unit(length).doc("the other coordinate").example("0.0"), cut.at);
    v(key("from").required().unit(length).doc("start of the cut").example("-20.0"), cut.from);
    v(key("to").required().unit(length).doc("end of the cut, above from").example("5.0"), cut.to);
    v(key("count").within(2, 1e6).doc("number of points").example("401"), cut.count);
}

void fields(Visitor& v, Field& field) {
    window_fields(v, field.x, field.y, "grid, [min, max] of x", "grid, [min, max] of y", "no grid");
    v(key("nx").within(2, 4000).doc("grid points in x").example("161"), field.nx);
    v(key("ny").within(2, 4000).doc("grid points in y").example("161"), field.ny);
    v.list(key("cuts").items(0, 100).doc("The field along lines parallel to an axis."), field.cuts);
}

void fields(Visitor& v, Figure& figure, const FigureUnits& units) {
    const auto of_kinds = [&](const char* name) { return key(name).written_if(has_key(figure, name)); };
    v.use_units(units.scene); // whatever the figure before has
    v(key("name").required().file_name().doc("file name without ending").example("\"wake\""), figure.name);
    v(key("kind")
          .required()
          .says_units(!figure.x.empty() || !figure.y.empty())
          .one_of(figure_kind_names())
          .doc("what is drawn; docs/figures.md lists what each kind needs")
          .example("\"cut\""),
      figure.kind);
    v(key("title").absent("made from the data").doc("title").example("\"Wake\""), figure.title);
    v(of_kinds("cut").within(0, 99).doc("index into field.cuts, from 0").example("0"), figure.cut);
    component_field(v, figure);
    v(of_kinds("sqrt_scaled").doc("draw |s|^(1/2) U instead of U").example("true"), figure.sqrt_scaled);
    v(of_kinds("along")
          .one_of({"x", "y"})
          .doc("the axis of the rod's frame along which U is drawn")
          .example("\"y\""),
      figure.along);
    if (figure.quantity.empty())
        figure.quantity = figure_quantities().front();
    v(of_kinds("quantity")
          .one_of(figure_quantities())
          .doc("what is drawn, a point for the scene and one for each of [[variants]]")
          .example("\"stiffness\""),
      figure.quantity);
    v(of_kinds("against")
          .one_of({"phi_b", "d0", "imposed_speed"})
          .doc("against what; d0 is the separation at which a pair starts")
          .example("\"imposed_speed\""),
      figure.against);
    v(of_kinds("gammas")
          .unit(speed)
          .items(1, 16)
          .doc("a panel for each [gamma1, gamma2]")
          .example("[[10.0, 0.0], [0.0, 10.0]]"),
      figure.gammas);
    v(of_kinds("frame").within(-1, 1e9).doc("which stored frame, from 0; -1: the last").example("-1"),
      figure.frame);
    colour_field(v, figure);
    v(of_kinds("fps").within(1, 120).doc("stored frames shown a second").example("20"), figure.fps);
    fit_figure_fields(v, figure);
    scan_figure_fields(v, figure);
    using enum FigureSubject;
    const bool of_bed = shows(figure, bed) || shows(figure, measure);
    const Units of_axes; // numbers as they are: an axis may be anything
    v.use_units(shows(figure, fit)    ? units.fit
                : of_bed              ? units.bed
                : shows(figure, scan) ? of_axes
                                      : units.scene);
    window_fields(v, figure.x, figure.y, "window, [min, max] of x", "window, [min, max] of y",
                  "fit to the data");
}

void fields(Visitor& v, Variant& variant) {
    v(key("name").required().file_name().doc("name in results and file names").example("\"repelled\""),
      variant.name);
    v(key("label").absent("the name").doc("text in the legend").example("\"kappa = -100\""), variant.label);
    v(key("set")
          .required()
          .items(1, 100)
          .doc("keys to change, as for -s on the command line")
          .example("{ \"coupling.kappa\" = -100.0 }"),
      Settings{variant.set});
}

} // namespace rodwake::scene
