#include "rodwake/medium/turning_wake.hpp"

#include "phi.hpp"

#include <cmath>

namespace rodwake::medium {

namespace {

/// -(across/z + i q_across along/z^2)/z for z = decay - i q_along: heading and wave vector along the rod and
/// across it.
Complex response(double decay, double q_along, double q_across, double along, double across) {
    const double norm = 1.0 / (decay * decay + q_along * q_along);
    const Complex inverse{decay * norm, q_along * norm}, square = inverse * inverse;
    return -1.0 * (square * (Complex{across, 0.0} + inverse * Complex{0.0, q_across * along}));
}

} // namespace

void add_turning(const ModalField& modes, const rods::Pose& rod, double rate, std::span<double> field) {
    const double nx = std::cos(rod.heading), ny = std::sin(rod.heading);
    const std::size_t size = modes.size(), columns = modes.columns();
    const Phases px = phases(modes.qx(), -rod.x), py = phases(modes.qy(), -rod.y);
    for (std::size_t i = 0; i < size; ++i) {
        if (modes.force()[i] == 0.0)
            continue;
        const std::size_t row = i / columns, column = i % columns;
        const double qx = modes.qx()[row], qy = modes.qy()[column];
        const double ux = modes.unit_x()[i], uy = modes.unit_y()[i];
        const double q_along = qx * nx + qy * ny, q_across = qy * nx - qx * ny;
        const double along = ux * nx + uy * ny, across = uy * nx - ux * ny; // of q/|q|
        const Complex phase = Complex{px.re[row], px.im[row]} * Complex{py.re[column], py.im[column]};
        const Complex f = rate * modes.force()[i] * phase;
        // n.(z x q/|q|) = -across, n'.(z x q/|q|) = along
        const Complex l = f * response(modes.decay_longitudinal()[i], q_along, q_across, along, across);
        const Complex t = f * response(modes.decay_transverse()[i], q_along, q_across, -across, along);
        field[i] += l.re;
        field[size + i] += l.im;
        field[2 * size + i] += t.re;
        field[3 * size + i] += t.im;
    }
}

} // namespace rodwake::medium
