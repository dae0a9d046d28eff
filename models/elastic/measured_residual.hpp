#pragma once
// What a measured field has beyond theory, w S[delta] of elastic/measured_field.hpp, in the rod's frame.

#include "rodwake/elastic/measured_field.hpp"
#include "smoothing_spline.hpp"

#include <vector>

namespace rodwake::elastic {

/// w with its derivatives at (x, y).
Jet blend_weight(const MeasuredOptions& options, double x, double y);
/// w without the core: 1 at the rod.
Jet edge_weight(const MeasuredOptions& options, double x, double y);

struct MeasuredResidual {
    MeasuredOptions options;
    QuinticKnots knots;
    std::vector<double> x, y; ///< coefficients of both components

    bool reaches(double px, double py) const;
    /// Adds to all quantities but the dipole, in the rod's frame.
    void add_to(FieldValues& f, double px, double py) const;
};

/// The wakes of theory with the residual of each rod, in theory's domain.
std::shared_ptr<const WakeField> measured_field(std::shared_ptr<const WakeField> theory,
                                                MeasuredResidual residual);

} // namespace rodwake::elastic
