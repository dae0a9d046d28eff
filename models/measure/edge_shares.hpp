#pragma once
// The part of a window's shares that is vectorised (window.cpp): a circle of growing radius about a point,
// and one edge of a polygon.

#include <cstddef>

namespace rodwake::measure {

/// acos(u) for 0 <= u <= 1 to 2e-15 is sqrt(1 - u) times this polynomial in 2 u - 1, which goes through the
/// Chebyshev points of the rest.
inline constexpr double arc_cosine_rest[] = {
    1.4809609793861221,     -0.076016091234650298,  0.011029313317973909,  -0.0021491358597180601,
    0.00048205410080041989, -0.0001174124943522419, 3.0187166843649764e-5, -8.063600679357754e-6,
    2.2160396102889381e-6,  -6.223317961744095e-7,  1.7790703300266098e-7, -5.1979537980503993e-8,
    1.5257551778951588e-8,  -4.1020445648993842e-9, 1.2229492339493375e-9, -6.0812115232831494e-10,
    1.851111751086014e-10};

/// Takes off share[k], first <= k < last, the directions in [low, high] off the edge's normal in which the
/// edge is nearer than the radius k + 1/2: those within acos(distance/radius). Lengths in bins. Every element
/// is on its own, no product is fused: all instruction sets give the same bits.
void take_edge_row(double distance, double low, double high, std::size_t first, std::size_t last,
                   double* share);

} // namespace rodwake::measure
