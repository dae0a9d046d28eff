#pragma once
// A row of series.csv: one case (the scene as written, or a variant) and the main numbers of its measures.

#include "rodwake/core/estimate.hpp"
#include "rodwake/core/record.hpp"

#include <cmath>
#include <cstddef>
#include <optional>
#include <string>

namespace rodwake::app {

/// An Estimate of nothing was not measured. Lengths of measures in a.
struct SeriesRow {
    std::string name;
    double bead_radius = 0.0, phi_b = 0.0;           ///< m, 1
    std::optional<double> separation, imposed_speed; ///< m, m/s
    std::size_t runs = 0;
    Estimate psi6, exponent;
    double decay_class = std::nan(""); ///< NaN: undetermined
    Estimate stiffness, half_box_change, non_reciprocity;
    Estimate force, speed, thrust;
    Estimate c_T, C11, C22, C66;
    Estimate drag_rate, screening_length, decay_rate, inertia;
    Estimate D_r, diffusion_per_length;

    /// In a; NaN if absent.
    double scaled(const std::optional<double>& length) const {
        return length ? *length * (1.0 / bead_radius) : std::nan("");
    }

    /// Readers know the columns by this order: further ones come last.
    static constexpr auto fields() {
        using R = SeriesRow;
        return std::tuple{
            field("name", &R::name, {"1", "of the variant; scene: as written"}),
            field("phi_b", &R::phi_b, {"1", "area fraction of the beads"}),
            field("d0", {"a", "distance of two rods at the start"},
                  [](const R& r) { return r.scaled(r.separation); }),
            field("imposed_speed", {"a/s", "of the rod (empty: it is free)"},
                  [](const R& r) { return r.scaled(r.imposed_speed); }),
            field("psi6", &R::psi6,
                  {"1", "|mean over the beads of psi6|, neighbours as measure.order has them"}),
            field("exponent", &R::exponent, {"1", "of an algebraic decay of g_B"}),
            field("class", &R::decay_class,
                  {"1", "of the decay of g_B: 0 exponential, 1 algebraic, 2 long-range"}),
            field("stiffness", &R::stiffness, {"1/a^2", "1/(s MSD~(s)) at s -> 0"}),
            field("delta_y", &R::half_box_change, {"a", "change of the separation over half a box"}),
            field("runs", &R::runs, {"1", "finished runs"}),
            field("non_reciprocity", &R::non_reciprocity, {"1", "mean over the runs"}),
            field("force", &R::force, {"N", "of the rod on the beads along its heading"}),
            field("speed", &R::speed, {"a/s", "of the rod along its heading"}),
            field("thrust", &R::thrust, {"N", "of the plates on the rod along its heading"}),
            field("c_T", &R::c_T, {"a/s", "speed of transverse sound"}),
            field("C11", &R::C11, {"N/m", "elastic constant along x"}),
            field("C22", &R::C22, {"N/m", "elastic constant along y"}),
            field("C66", &R::C66, {"N/m", "shear constant"}),
            field("drag_rate", &R::drag_rate, {"1/s", "drag rate of the bed on the plates"}),
            field("screening_length", &R::screening_length, {"a", "m* c_T^2/(drag rate v)"}),
            field("decay_rate", &R::decay_rate, {"1/s", "decay rate of the bed's drift"}),
            field("inertia", &R::inertia, {"1", "inertia of the drift over mass, m*"}),
            field("D_r", &R::D_r, {"rad^2/s", "heading diffusion of the rod"}),
            field("diffusion_per_length", &R::diffusion_per_length,
                  {"rad^2/a", "heading diffusion over the speed"})};
    }
};
static_assert(undescribed_members<SeriesRow>() == 3,
              "bead_radius, separation and imposed_speed are scaled by functions; every other member of the "
              "row has its line in fields()");

} // namespace rodwake::app
