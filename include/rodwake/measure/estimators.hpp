#pragma once
// Which way something is measured, where there are several: what a scene chooses from.

namespace rodwake::measure {

/// Of the displacement field; displacement.hpp says what each does.
enum class DisplacementMethod { phase, lagrangian, density };
/// What a displacement is relative to: its mean over the box, or the beads far from the rods.
enum class Reference { box, far };
/// Whose angles count in psi_6: beads nearer than a cut-off, or Delaunay neighbours.
enum class Neighbours { cutoff, delaunay };

} // namespace rodwake::measure
