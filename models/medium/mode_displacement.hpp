#pragma once
// A mode's amplitudes along and across q (modal_field.hpp) as the Cartesian components of u_q.

#include "phi.hpp"
#include "rodwake/medium/modal_field.hpp"

#include <span>

namespace rodwake::medium {

inline Complex conjugate(Complex z) { return {z.re, -z.im}; }
inline Complex times_i(Complex z) { return {-z.im, z.re}; }

struct Displacement {
    Complex x, y;
};

/// Of mode i.
inline Displacement displacement(const ModalField& modes, std::size_t i, std::span<const double> field) {
    const std::size_t size = modes.size();
    const Complex l{field[i], field[size + i]}, t{field[2 * size + i], field[3 * size + i]};
    const double ux = modes.unit_x[i], uy = modes.unit_y[i];
    return {ux * l - uy * t, uy * l + ux * t};
}

} // namespace rodwake::medium
