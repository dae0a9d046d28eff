#pragma once
// medium.field = "auto": exact field or table, whichever makes the run of the rods cheaper. The choice
// follows from the scene alone: costs are constants measured once (docs/validation_elastic.md, "Tables of the
// field"), never times of this machine or what its cache holds, so that the same scene gives the same bits
// everywhere.
//
//   cost = make + n_rhs (N heading + N^2 wake),   n_rhs = 130 t_end sqrt(N)/D max(1, (1e-6/rtol)^(1/6))
//
// N rods in a box of side D (on the plane: as far apart as they start); make: seconds to make a table, 0 for
// the exact field; heading: a rod's field for a new heading (boxes); wake: one rod's wake at another's place.
// n_rhs was counted in boxes of 2 to 50 xi with 2 and 8 rods, which it meets within a factor of 2.

#include "rodwake/scene/scene.hpp"

#include <string>

namespace rodwake::app {

/// The field in which the rods of a scene are integrated.
struct FieldChoice {
    scene::FieldBackend backend = scene::FieldBackend::exact; ///< never automatic
    double tolerance = 0.0;                                   ///< of the table; 0: there is none
    std::string why;                                          ///< with "auto"; else empty
};

const char* to_string(scene::FieldBackend backend);

/// The table's tolerance under "auto" is medium.table.tolerance, else rtol: rods in a table of tolerance T
/// are within 100 T of the exact ones, which is what rtol = T makes of the solver's error.
FieldChoice field_choice(const scene::Scene& scene);

/// The scene with "auto" replaced by what was chosen.
scene::Scene with_field(scene::Scene scene, const FieldChoice& choice);

} // namespace rodwake::app
