// Field list of [[granular.rods]].

#include "fields.hpp"

namespace rodwake::scene {

namespace {

using enum Dimension;
using granular::RodKind, granular::Taper;

long default_spheres(RodKind kind) { return kind == RodKind::apolar ? 13 : 12; }
double default_thickness(RodKind kind) { return kind == RodKind::apolar ? 0.95e-3 : 1.1e-3; }

template<class T>
std::optional<T> unless(T value, T fallback) {
    return value == fallback ? std::nullopt : std::optional(value);
}

/// Keys whose default depends on the kind; one that has its default is left to follow the kind.
void kind_fields(Visitor& v, granular::RodShape& rod) {
    auto spheres = unless(static_cast<long>(rod.spheres), default_spheres(rod.kind));
    auto thick = unless(rod.thick_diameter, default_thickness(rod.kind));
    v(key("kind")
          .doc("motile: tapers from one end to the other; apolar: from the middle to both ends")
          .example("\"motile\""),
      choice(rod.kind, {{"motile", RodKind::motile}, {"apolar", RodKind::apolar}}));
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
        rod.spheres = static_cast<std::size_t>(spheres.value_or(default_spheres(rod.kind)));
        rod.thick_diameter = thick.value_or(default_thickness(rod.kind));
    });
}

void shape_fields(Visitor& v, granular::RodShape& rod) {
    v(key("thin_diameter").unit(length).above(0.0, 1.0).doc("of the thin end or ends").example("\"0.8 mm\""),
      rod.thin_diameter);
    v(key("length").unit(length).above(0.0, 1.0).doc("end to end").example("\"4.5 mm\""), rod.length);
    v(key("taper")
          .doc("linear: radii fall evenly along the axis; stepwise: in equal pieces of constant radius")
          .example("\"linear\""),
      choice(rod.taper, {{"linear", Taper::linear}, {"stepwise", Taper::stepwise}}));
    v(key("segments")
          .within(1, 1000)
          .written_if(rod.taper == Taper::stepwise)
          .doc("pieces of a stepwise taper")
          .example("4"),
      rod.segments);
    v(key("density").unit(density).above(0.0, 1e6).doc("mass density").example("8500.0"), rod.density);
}

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
          .doc("in-plane velocity along the heading that is held whatever hits the rod, which does not turn "
               "then; "
               "0: pinned")
          .example("\"1 mm/s\""),
      rod.imposed_speed);
    kind_fields(v, rod.shape);
    shape_fields(v, rod.shape);
}

} // namespace rodwake::scene
