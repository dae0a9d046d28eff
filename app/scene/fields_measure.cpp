// Field list of [measure]. SI, with the bed's `a` (fields(Scene) says so).

#include "fields.hpp"

namespace rodwake::scene {

namespace {

using enum Dimension;
using measure::DisplacementMethod, measure::Neighbours, measure::Reference;

void what_fields(Visitor& v, Measure& m) {
    v(key("order")
          .doc("g(r), psi6 and g_B(r) with its class: exponential (liquid), algebraic (hexatic), long-range "
               "(crystal)")
          .example("true"),
      m.order);
    v(key("microrheology")
          .doc("mean-square displacement of the beads and the stiffness 1/(s MSD~(s)), s -> 0")
          .example("true"),
      m.microrheology);
    v(key("flow")
          .doc("velocity of the beads in the rod's frame, and how far beads are dragged")
          .example("true"),
      m.flow);
    v(key("displacement")
          .doc(
              "displacement field U in the rod's frame, or without rods in the frame of a gaussian body "
              "force. "
              "phase: from the local phase of the Bragg peaks, the "
              "robust one; lagrangian: from each bead's position before the rod came; density: from the mean "
              "density in the rod's frame")
          .example("\"phase\""),
      choice(m.displacement, {{"none", std::nullopt},
                              {"phase", DisplacementMethod::phase},
                              {"lagrangian", DisplacementMethod::lagrangian},
                              {"density", DisplacementMethod::density}}));
    v(key("pairs")
          .doc("two rods: change of their separation over half the box, who turned, outcome; needs two "
               "[[granular.rods]]")
          .example("true"),
      m.pairs);
    v(key("force")
          .doc("mean force of the rod on the beads along its heading, from the momentum it hands over")
          .example("true"),
      m.force);
    v(key("phonons")
          .doc(
              "correlations of the longitudinal and transverse currents of the beads: sound speeds, damping, "
              "mode temperatures and elastic constants")
          .example("true"),
      m.phonons);
    v(key("mechanics")
          .doc("drift of the bed under the push of its rods or of a uniform body force, drag rate, decay "
               "of the drift and inertia, Peclet number and screening length")
          .example("true"),
      m.mechanics);
    v(key("heading_diffusion")
          .doc("how fast the rod forgets its heading, how fast it walks, and the [noise] of the theory that "
               "is "
               "as strong; needs [[granular.rods]]")
          .example("true"),
      m.heading_diffusion);
}

void when_fields(Visitor& v, Measure& m) {
    v(key("interval")
          .unit(time)
          .above(0.0, 1e7)
          .absent("interval of the stored frames, granular.output.frames")
          .doc("between the frames that are measured")
          .example("\"0.1 s\""),
      m.interval);
    const Key travel = key("from_travel")
                           .unit(length)
                           .above(0.0, 1e3)
                           .absent("from on")
                           .doc("frames before rod has come this far from where it started are not measured "
                                "either; from takes such a length, too")
                           .example("\"20 a\"");
    v(travel, m.from_travel);
    v(key("from")
          .unit(time)
          .within(0.0, 1e7)
          .doc("earlier frames are not measured; a length sets from_travel")
          .example("\"2 s\""),
      TimeOrTravel{m.from, m.from_travel, travel.range});
    v(key("block")
          .unit(time)
          .above(0.0, 1e7)
          .doc("time that counts as one independent value in standard errors")
          .example("\"10 s\""),
      m.block);
    v(key("trajectory")
          .absent("the granular run of this scene")
          .doc("H5MD file to measure instead, seen from where the program runs; of a bed like this one")
          .example("\"results/bed/trajectory.h5md\""),
      m.trajectory);
    v(key("rod").within(0, 999).doc("whose frame and force: index into granular.rods, from 0").example("0"),
      m.rod);
}

void order_fields(Visitor& v, Measure& m) {
    v(key("order_interval")
          .unit(time)
          .above(0.0, 1e7)
          .absent("interval, or the next multiple of it from 0.5 s on")
          .doc("between the frames whose order is measured; a whole multiple of interval")
          .example("\"1 s\""),
      m.order_interval);
    v(key("order_neighbours")
          .doc("whose angles count in psi6: beads nearer than order_cutoff, or Delaunay neighbours")
          .example("\"delaunay\""),
      choice(m.order_neighbours, {{"cutoff", Neighbours::cutoff}, {"delaunay", Neighbours::delaunay}}));
    v(key("order_cutoff")
          .unit(length)
          .above(0.0, 1e3)
          .absent("first minimum of g(r) of the first 16 frames")
          .doc("beads nearer than this are neighbours; with order_neighbours = \"cutoff\"")
          .example("\"2.9 a\""),
      m.order_cutoff);
    v(key("s_low")
          .unit(rate)
          .above(0.0, 1e6)
          .absent("from the length of the run")
          .doc("lower end of the range of s from which the stiffness is extrapolated to s = 0")
          .example("0.1"),
      m.s_low);
    v(key("s_high")
          .unit(rate)
          .above(0.0, 1e6)
          .absent("from the length of the run")
          .doc("upper end of it")
          .example("0.4"),
      m.s_high);
    v(key("bead_drag")
          .unit(rate)
          .within(0.0, 1e6)
          .absent("the memory kernel keeps it: k~ + Gamma s")
          .doc("microrheology: drag of the plates on a bead over its mass, Gamma/m, taken off the memory "
               "kernel; the drag rate of a bed that drifts under a uniform push")
          .example("13.9"),
      m.bead_drag);
    v(key("bead_drag_error")
          .unit(rate)
          .within(0.0, 1e6)
          .absent("unknown, and so are the errors of the kernel without drag")
          .doc("standard error of bead_drag")
          .example("0.1"),
      m.bead_drag_error);
}

void flow_fields(Visitor& v, Measure& m) {
    v(key("flow_lag")
          .unit(time)
          .above(0.0, 1e7)
          .doc("a bead's velocity is its displacement over this time; rounded to whole intervals")
          .example("\"0.2 s\""),
      m.flow_lag);
    v(key("flow_spacing")
          .unit(length)
          .above(0.0, 1e3)
          .absent("2 bead radii")
          .doc("spacing of the flow's grid")
          .example("\"2 a\""),
      m.flow_spacing);
    v(key("marked_within")
          .unit(length)
          .above(0.0, 1e3)
          .absent("6 bead radii")
          .doc("beads this close to the rod's centre in the first frame are marked and followed")
          .example("\"8 a\""),
      m.marked_within);
    v(key("marked_travel")
          .unit(length)
          .above(0.0, 1e3)
          .absent("to the end of the run")
          .doc("the marked beads are followed until the rod has come this far")
          .example("\"20 a\""),
      m.marked_travel);
}

void displacement_fields(Visitor& v, Measure& m) {
    v(key("spacing")
          .unit(length)
          .above(0.0, 1e3)
          .absent("1 bead radius")
          .doc("spacing of U's grid")
          .example("\"0.5 a\""),
      m.spacing);
    v(key("reference")
          .doc("what U is relative to. box: its mean over the periodic box, as in the periodic theory; far: "
               "beads farther than far_from from every rod")
          .example("\"far\""),
      choice(m.reference, {{"box", Reference::box}, {"far", Reference::far}}));
    v(key("far_from")
          .unit(length)
          .above(0.0, 1e3)
          .absent("0.3 of the box")
          .doc("beads farther than this from every rod are the far field")
          .example("\"25 a\""),
      m.far_from);
    v(key("mirror")
          .doc("average U with its mirror image across the rod: U_x even, U_y odd in y")
          .example("true"),
      m.mirror);
    v(key("run_maps")
          .written_if(m.run_maps)
          .doc("measure.h5 holds the displacement of each run in addition to their mean, as /runs/<k>; fits "
               "of such a file take them for maps of runs alike, which gives errors by the jackknife")
          .example("true"),
      m.run_maps);
    v(key("profile_offset")
          .unit(length)
          .within(0.0, 1e3)
          .absent("4 bead radii")
          .doc("y of the profile of U_y along x")
          .example("\"4 a\""),
      m.profile_offset);
    v(key("contact_distance")
          .unit(length)
          .above(0.0, 1e3)
          .absent("half the length of the longer rod")
          .doc("pairs: centres nearer than this are in contact")
          .example("\"12 a\""),
      m.contact_distance);
}

void phonon_fields(Visitor& v, Measure& m) {
    v(key("phonon_interval")
          .unit(time)
          .above(0.0, 1e7)
          .absent("the largest part of interval up to 5 ms")
          .doc("between the frames of which currents are taken; interval is a whole multiple of it")
          .example("\"4 ms\""),
      m.phonon_interval);
    v(key("phonon_lag")
          .unit(time)
          .above(0.0, 1e7)
          .absent("1 s, or half of block if that is shorter")
          .doc("longest lag of the current correlations; at most half of block")
          .example("\"0.5 s\""),
      m.phonon_lag);
    v(key("phonon_waves")
          .within(1, 16)
          .doc("modes q = 2 pi (m, n)/L with m^2 + n^2 up to the square of this")
          .example("6"),
      m.phonon_waves);
    v(key("shear_speed")
          .unit(speed)
          .above(0.0, 1e6)
          .absent("from phonons, if they are measured too")
          .doc("mechanics: speed of transverse sound in the bed, for the screening length")
          .example("\"120 a/s\""),
      m.shear_speed);
    v(key("inertia_factor")
          .above(0.0, 100.0)
          .absent("as mechanics measures it, if that is measured too and to 20 %; else none is used, as the "
                  "result states")
          .doc("inertia of the moving bed over the mass of its beads: elastic constants of phonons are "
               "inertia_factor rho c^2, and mechanics takes its screening length with it")
          .example("1.27"),
      m.inertia_factor);
    v(key("inertia_error")
          .within(0.0, 100.0)
          .absent("0")
          .doc("standard error of inertia_factor, which must be given with it")
          .example("0.03"),
      m.inertia_error);
}

} // namespace

void fields(Visitor& v, Measure& measure) {
    what_fields(v, measure);
    when_fields(v, measure);
    order_fields(v, measure);
    flow_fields(v, measure);
    displacement_fields(v, measure);
    phonon_fields(v, measure);
    v(key("heading_lag_low")
          .unit(time)
          .above(0.0, 1e7)
          .absent("a tenth of heading_lag_high")
          .doc("heading_diffusion: shortest lag of the fits, longer than the rod rattles")
          .example("\"0.2 s\""),
      measure.heading_lag_low);
    v(key("heading_lag_high")
          .unit(time)
          .above(0.0, 1e7)
          .absent("a quarter of block, or of what is measured if that is shorter")
          .doc("heading_diffusion: longest lag; at most half of block")
          .example("\"2 s\""),
      measure.heading_lag_high);
}

} // namespace rodwake::scene
