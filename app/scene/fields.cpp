// Field lists of [scales] and of the scene as a whole.

#include "fields.hpp"

namespace rodwake::scene {

namespace {

using enum Dimension;

/// What "a" means in tables of the bed.
double bed_radius(const Scene& scene) {
    return scene.granular || scene.tracks ? measured_radius(scene) : default_bead_radius;
}

/// What "a" means in [fit].
double bead_radius(const Scene& scene) {
    return !scene.granular && !scene.tracks && scene.scales ? scene.scales->bead_radius : bed_radius(scene);
}

} // namespace

void fields(Visitor& v, Scales& scales) {
    // One metre and one metre per second as units of length and speed: values in here stay SI.
    Units units = si_units(scales.bead_radius);
    units.bead_words = false;
    v.use_units(units);
    v(key("bead_radius")
          .symbol("a")
          .says_units()
          .unit(length)
          .above(0.0)
          .doc("length of the unit \"a\"")
          .example("\"0.4 mm\""),
      scales.bead_radius);
    v.use_units(si_units(scales.bead_radius));
    v(key("f_over_mu")
          .symbol("f/\\mu")
          .says_units()
          .required()
          .unit(length)
          .above(0.0)
          .doc("unit of length, f/mu")
          .example("\"2.2 a\""),
      scales.f_over_mu);
    v(key("v0")
          .symbol("v_0")
          .says_units()
          .required()
          .unit(speed)
          .above(0.0)
          .doc("self-propulsion speed; the unit of time is f_over_mu / v0")
          .example("\"2.8 mm/s\""),
      scales.v0);
}

void fields(Visitor& v, Scene& scene) {
    v(key("schema").required().within(1, 1).doc("version of the scene format").example("1"), scene.schema);
    v(key("units")
          .says_units()
          .doc("what plain numbers mean: reduced (f/mu, v0) or SI; SI needs [scales]")
          .example("\"reduced\""),
      choice(scene.units, {{"reduced", UnitSystem::reduced}, {"si", UnitSystem::si}}));
    v(key("title").absent("none").doc("title of the report").example("\"Two rods side by side\""),
      scene.title);
    v.table(key("scales").doc(
                "What one reduced unit is worth, always in SI. Needed for units = \"si\" and for strings "
                "with a physical unit."),
            scene.scales);
    const Units units{scene.units, scene.scales};
    v.use_units(units);
    v.table(key("medium").doc("The elastic continuum."), scene.medium);
    v.table(key("coupling").doc("How a rod turns in the strain of the others."), scene.coupling);
    v.table(key("noise").doc("White noise on the rods: an ensemble of runs in which they diffuse."),
            scene.noise);
    v.table(
        key("body").doc("Rods with bodies: tapered rows of discs that push each other aside. Absent: rods "
                        "are points and pass through each other."),
        scene.body);
    v.table(key("rods_random")
                .doc("Rods at random in a square or disc round the origin, instead of [[rods]]. They depend "
                     "on these "
                     "keys and on [body] alone."),
            scene.rods_random, [&](RandomRods& random) { fields(v, random, scene.body); });
    std::vector<Rod> none;
    v.list(key("rods").items(0, max_rods).doc("One entry for each rod."),
           scene.rods_random ? none : scene.rods);
    v.derive([&] {
        if (scene.rods_random)
            scene.rods = random_rods(*scene.rods_random, scene.body);
    });
    v.table(key("rods_run").doc("Integration of the rods."), scene.rods_run);
    v.table(
        key("field").doc("The field of one rod at the origin heading along +x, on a grid and along cuts."),
        scene.field);
    v.table(key("granular")
                .doc("Beads and rods between two vibrating plates, periodic in x and y. SI, with its "
                     "own `a`."),
            scene.granular);
    v.table(key("tracks").doc(
                "What a camera saw, instead of [granular]: a file of tracks. SI, with its own `a`."),
            scene.tracks);
    FigureUnits of_figures{units, si_units(bed_radius(scene)), file_units(bead_radius(scene), "a")};
    v.use_units(scene.granular && !scene.rods_run ? of_figures.bed : units);
    v.table(key("rods_order")
                .doc("Order parameters and clusters in time of the rods that are integrated; without "
                     "[rods_run] of the motile rods of the bed, then SI with the bed's `a`."),
            scene.rods_order);
    v.use_units(of_figures.bed);
    v.table(key("measure").doc("What is measured of the granular run, or of the tracks; what is absent is "
                               "not measured. SI, with "
                               "their `a`."),
            scene.measure);
    v.use_units(of_figures.fit);
    // Numbers of rods.csv in reduced units go by these scales.
    const bool known = scene.units == UnitSystem::si && scene.scales;
    const FitUnits of_fit{of_figures.fit, si_units(bead_radius(scene)),
                          known ? *scene.scales : Scales{1.0, 1.0, bead_radius(scene)}};
    v.table(key("fit").doc("What is fitted to measured profiles and tracks."), scene.fit,
            [&](Fit& fit) { fields(v, fit, of_fit); });
    if (scene.fit)
        of_figures.fit = file_units(bead_radius(scene), scene.fit->length_unit);
    v.use_units(units);
    v.list(key("figures").items(0, 100).doc("What `rodwake plot` draws."), scene.figures,
           [&](Figure& figure) { fields(v, figure, of_figures); });
    v.list(key("variants").items(0, 100).doc("The rods, or the bed, run again with some keys changed."),
           scene.variants);
    v.table(key("scan").doc("Keys of the scene that vary, and how: a phase diagram of its rods or beds."),
            scene.scan);
}

} // namespace rodwake::scene
