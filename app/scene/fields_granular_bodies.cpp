// Field lists of [[granular.rods]], [granular.rods_random] and [[granular.bead_kinds]].

#include "fields.hpp"

#include <numbers>

namespace rodwake::scene {

namespace {

using enum Dimension;
using granular::RodKind, granular::Taper;

} // namespace

void fields(Visitor& v, GranularRod& rod) {
    v(key("position")
          .required()
          .unit(length)
          .within(-1e3, 1e3)
          .items(2, 2)
          .doc("of the centre of mass, [x, y]; the box reaches from 0 to L_x, L_y")
          .example("[\"20 a\", \"46.5 a\"]"),
      rod.position);
    v(key("heading").unit(angle).doc("of the thin end, counter-clockwise from +x").example("\"90 deg\""),
      rod.heading);
    v(key("imposed_speed")
          .unit(speed)
          .within(-10.0, 10.0)
          .absent("the rod moves freely")
          .doc("in-plane velocity along the heading, held fixed under all impacts; the rod does not turn; 0: "
               "pinned")
          .example("\"1 mm/s\""),
      rod.imposed_speed);
    // The defaults of two keys depend on the kind; one that has its default is left to follow the kind.
    granular::RodShape& shape = rod.shape;
    const granular::RodShape usual = default_shape(shape.kind);
    std::optional<long> spheres;
    std::optional<double> thick;
    if (shape.spheres != usual.spheres)
        spheres = static_cast<long>(shape.spheres);
    if (shape.thick_diameter != usual.thick_diameter)
        thick = shape.thick_diameter;
    v(key("kind")
          .doc("motile: tapers from one end to the other; apolar: from the middle to both ends")
          .example("\"motile\""),
      choice(shape.kind, {{"motile", RodKind::motile}, {"apolar", RodKind::apolar}}));
    v(key("spheres")
          .within(1, 1000)
          .absent("12; apolar: 13")
          .doc("overlapping spheres in a row; apolar: an odd number, an even row has no middle and starts to "
               "move")
          .example("13"),
      spheres);
    v(key("thick_diameter")
          .unit(length)
          .above(0.0, 1.0)
          .absent("1.1 mm; apolar: 0.95 mm, the middle of the motile rod")
          .doc("motile: of the thick end; apolar: of the middle")
          .example("\"1.1 mm\""),
      thick);
    v.derive([&] {
        const granular::RodShape fallback = default_shape(shape.kind);
        shape.spheres = spheres ? static_cast<std::size_t>(*spheres) : fallback.spheres;
        shape.thick_diameter = thick.value_or(fallback.thick_diameter);
    });
    v(key("thin_diameter").unit(length).above(0.0, 1.0).doc("of the thin end or ends").example("\"0.8 mm\""),
      rod.shape.thin_diameter);
    v(key("length").unit(length).above(0.0, 1.0).doc("end to end").example("\"4.5 mm\""), rod.shape.length);
    v(key("taper")
          .doc("linear: radii fall evenly along the axis; stepwise: in equal pieces of constant radius")
          .example("\"linear\""),
      choice(rod.shape.taper, {{"linear", Taper::linear}, {"stepwise", Taper::stepwise}}));
    v(key("segments")
          .within(1, 1000)
          .written_if(rod.shape.taper == Taper::stepwise)
          .doc("pieces of a stepwise taper")
          .example("4"),
      rod.shape.segments);
    v(key("density").unit(density).above(0.0, 1e6).doc("mass density").example("8500.0"), rod.shape.density);
}

void fields(Visitor& v, RandomBedRods& random) {
    v(key("count").required().within(1, max_rods).doc("number of rods").example("12"), random.count);
    v(key("kind")
          .doc("shape of the rods: what [[granular.rods]] of this kind have by default")
          .example("\"apolar\""),
      choice(random.kind, {{"motile", RodKind::motile}, {"apolar", RodKind::apolar}}));
    v(key("min_separation")
          .unit(length)
          .within(0.0, 1e3)
          .doc("no two rods start with less than this between their surfaces, nor a rod and a wall")
          .example("\"4 a\""),
      random.min_separation);
    v(key("heading")
          .unit(angle)
          .doc("middle of the start directions, counter-clockwise from +x")
          .example("\"90 deg\""),
      random.heading);
    v(key("spread")
          .unit(angle)
          .within(0.0, std::numbers::pi)
          .doc("headings are uniform within this of it to both sides; pi: any")
          .example("\"30 deg\""),
      random.spread);
    v(key("seed")
          .within(0, largest_seed)
          .doc("of the positions and headings; --seed replaces it")
          .example("7"),
      random.seed);
}

void fields(Visitor& v, granular::BeadKind& kind) {
    v(key("radius")
          .required()
          .unit(length)
          .above(0.0, 1.0)
          .doc("of the beads of this kind")
          .example("\"0.56 mm\""),
      kind.radius);
    v(key("share")
          .above(0.0, 1e6)
          .doc("of the number of beads, over the sum of the shares of all kinds; rounded by largest "
               "remainders")
          .example("0.5"),
      kind.share);
}

} // namespace rodwake::scene
