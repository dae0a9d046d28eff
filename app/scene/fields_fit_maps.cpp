// Field list of what belongs to [[fit.maps]].

#include "fields.hpp"

namespace rodwake::scene {

using enum Dimension;

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
          .absent("that of measure.h5; needed with CSV")
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
