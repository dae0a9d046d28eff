#pragma once
// A displacement known modulo the lattice's vectors, made continuous from the far field inwards.

#include "rodwake/measure/bragg.hpp"
#include "rodwake/measure/rod_grid.hpp"

#include <array>
#include <vector>

namespace rodwake::measure {

/// Lattice vectors that belong to wave vectors: G_0.a1 = G_2.a2 = 2 pi, G_0.a2 = G_2.a1 = 0.
class LatticeVectors {
public:
    explicit LatticeVectors(const std::array<Vector2, 3>& G);
    /// u plus the lattice vector that brings it nearest to v.
    Vector2 nearest_to(const Vector2& u, const Vector2& v) const;
    /// a a1 + b a2.
    Vector2 at(double a, double b) const { return {a * a1_.x + b * a2_.x, a * a1_.y + b * a2_.y}; }

private:
    std::array<Vector2, 3> G_;
    Vector2 a1_, a2_;
};

/// Starts at the best bin farther than far_from, where the displacement is taken to be the one nearest to 0,
/// and goes on bin by bin, the best of those next to what is done first; each takes the value nearest to the
/// mean of its done neighbours (up to two bins away, because rows of a lattice leave rows of bins empty).
/// Quality 0: no data. Pieces that cannot be reached start at their own best bin. Returns which bins were
/// done.
std::vector<bool> unwrap(std::vector<Vector2>& u, const std::vector<double>& quality, const RodGrid& grid,
                         const LatticeVectors& lattice, double far_from);

} // namespace rodwake::measure
