#include "chebyshev_grid.hpp"

#include "rodwake/core/error.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace rodwake::elastic {

namespace {

constexpr double eighth = 0.25 * std::numbers::pi;

/// A coordinate's piece, and the polynomials there with their derivatives by the coordinate.
template<std::size_t nodes>
struct GridAxis {
    std::size_t piece;
    std::array<double, nodes> t, slope;

    /// `u` on [0, 1], `scale` = du over the coordinate's change.
    GridAxis(double u, std::size_t pieces, double scale) {
        const double position = u * static_cast<double>(pieces);
        piece = static_cast<std::size_t>(std::clamp(position, 0.0, static_cast<double>(pieces) - 0.5));
        const double s = 2.0 * (position - static_cast<double>(piece)) - 1.0,
                     rate = 2.0 * scale * static_cast<double>(pieces);
        t = {1.0, s};
        slope = {0.0, rate};
        for (std::size_t n = 2; n < nodes; ++n) {
            t[n] = 2.0 * s * t[n - 1] - t[n - 2];
            slope[n] = 2.0 * (s * slope[n - 1] + rate * t[n - 1]) - slope[n - 2];
        }
    }
};

/// sum over n of weight[n] data[n * stride + m], m < stride. Three rows at a time, which the compiler turns
/// into vector arithmetic over m.
template<std::size_t nodes>
void contract(const std::array<double, nodes>& weight, const double* __restrict data, std::size_t stride,
              double* __restrict sum) {
    static_assert(nodes % 3 == 0);
    for (std::size_t n = 0; n < nodes; n += 3) {
        const double a = weight[n], b = weight[n + 1], c = weight[n + 2];
        const double *const p = data + n * stride, *const q = p + stride, *const r = q + stride;
        if (n == 0)
            for (std::size_t m = 0; m < stride; ++m)
                sum[m] = a * p[m] + b * q[m] + c * r[m];
        else
            for (std::size_t m = 0; m < stride; ++m)
                sum[m] += a * p[m] + b * q[m] + c * r[m];
    }
}

constexpr std::size_t plane_nodes = place_nodes * place_nodes;

using PlaceWeights = std::array<double, place_nodes>;

/// The functions at a place from their coefficients by x and y.
void contract_plane(const PlaceWeights& in_x, const PlaceWeights& in_y, const double* plane,
                    std::size_t functions, double* v) {
    std::array<double, place_nodes * ChebyshevGrid::most> line;
    contract(in_y, plane, place_nodes * functions, line.data());
    contract(in_x, line.data(), functions, v);
}

/// One line of values at the nodes to coefficients, `stride` apart.
template<std::size_t nodes>
void transform_line(double* data, std::size_t stride) {
    static const auto matrix = [] { // row i: what the values at the nodes give to coefficient i
        std::array<std::array<double, nodes>, nodes> m;
        for (std::size_t i = 0; i < nodes; ++i)
            for (std::size_t a = 0; a < nodes; ++a)
                m[i][a] = std::cos(std::numbers::pi * static_cast<double>(i) *
                                   (static_cast<double>(a) + 0.5) / nodes) *
                          (i > 0 ? 2.0 : 1.0) / nodes;
        return m;
    }();
    std::array<double, nodes> f{};
    for (std::size_t i = 0; i < nodes; ++i)
        for (std::size_t a = 0; a < nodes; ++a)
            f[i] += matrix[i][a] * data[a * stride];
    for (std::size_t i = 0; i < nodes; ++i)
        data[i * stride] = f[i];
}

} // namespace

double chebyshev_node(std::size_t p, std::size_t pieces, std::size_t a, std::size_t nodes) {
    const double s = std::cos(std::numbers::pi * (static_cast<double>(a) + 0.5) / static_cast<double>(nodes));
    return (static_cast<double>(p) + 0.5 * (1.0 + s)) / static_cast<double>(pieces);
}

ChebyshevGrid::ChebyshevGrid(const Pieces& pieces, std::size_t functions)
    : pieces_(pieces), functions_(functions), data_(pieces.cells() * cell_nodes * functions),
      centre_(pieces.angle * angle_nodes * functions) {}

ChebyshevGrid::ChebyshevGrid(const Pieces& pieces, std::size_t functions, std::vector<double> coefficients)
    : pieces_(pieces), functions_(functions), data_(std::move(coefficients)),
      centre_(pieces.angle * angle_nodes * functions) {
    if (data_.size() != pieces.cells() * cell_nodes * functions)
        throw InputError("table of the periodic field: its coefficients do not fit its pieces");
    set_centre();
}

double* ChebyshevGrid::values(const ChebyshevNode& n) {
    const std::size_t cell = (n.piece * pieces_.place + n.row) * pieces_.place + n.column;
    const std::size_t node = (n.k * place_nodes + n.j) * place_nodes + n.i;
    return data_.data() + (cell * cell_nodes + node) * functions_;
}

void ChebyshevGrid::transform(std::size_t cell) {
    double* const first = data_.data() + cell * cell_nodes * functions_;
    const std::size_t row = place_nodes * functions_, plane = plane_nodes * functions_;
    for (std::size_t m = 0; m < plane; ++m)
        transform_line<angle_nodes>(first + m, plane);
    for (std::size_t k = 0; k < angle_nodes; ++k) {
        for (std::size_t m = 0; m < row; ++m)
            transform_line<place_nodes>(first + k * plane + m, row);
        for (std::size_t j = 0; j < place_nodes; ++j)
            for (std::size_t m = 0; m < functions_; ++m)
                transform_line<place_nodes>(first + k * plane + j * row + m, functions_);
    }
}

std::array<GridValue, ChebyshevGrid::most> ChebyshevGrid::at(double x, double y, double angle,
                                                             GridRequest request) const {
    const GridAxis<place_nodes> in_x(x + 0.5, pieces_.place, 1.0), in_y(y + 0.5, pieces_.place, 1.0);
    const GridAxis<angle_nodes> turn(angle / eighth, pieces_.angle, 1.0 / eighth);
    const std::size_t cell = (turn.piece * pieces_.place + in_y.piece) * pieces_.place + in_x.piece;
    const double* const first = data_.data() + cell * cell_nodes * functions_;
    std::array<double, plane_nodes * most> sum;
    std::array<std::array<double, most>, 4> result{};
    contract(turn.t, first, plane_nodes * functions_, sum.data());
    contract_plane(in_x.t, in_y.t, sum.data(), functions_, result[0].data());
    if (request.by_place) {
        contract_plane(in_x.slope, in_y.t, sum.data(), functions_, result[1].data());
        contract_plane(in_x.t, in_y.slope, sum.data(), functions_, result[2].data());
    }
    if (request.by_angle) {
        contract(turn.slope, first, plane_nodes * functions_, sum.data());
        contract_plane(in_x.t, in_y.t, sum.data(), functions_, result[3].data());
    }
    std::array<GridValue, most> values;
    for (std::size_t m = 0; m < functions_; ++m)
        values[m] = {result[0][m], result[1][m], result[2][m], result[3][m]};
    return values;
}

void ChebyshevGrid::set_centre() {
    const std::size_t middle = pieces_.place / 2;
    const GridAxis<place_nodes> axis(0.5, pieces_.place, 1.0);
    for (std::size_t piece = 0; piece < pieces_.angle; ++piece)
        for (std::size_t k = 0; k < angle_nodes; ++k)
            contract_plane(axis.t, axis.t, values({middle, middle, piece, 0, 0, k}), functions_,
                           centre_.data() + (piece * angle_nodes + k) * functions_);
}

std::array<GridValue, ChebyshevGrid::most> ChebyshevGrid::at_centre(double angle) const {
    const GridAxis<angle_nodes> turn(angle / eighth, pieces_.angle, 1.0 / eighth);
    const double* const first = centre_.data() + turn.piece * angle_nodes * functions_;
    std::array<double, most> value{}, slope{};
    contract(turn.t, first, functions_, value.data());
    contract(turn.slope, first, functions_, slope.data());
    std::array<GridValue, most> values;
    for (std::size_t m = 0; m < functions_; ++m)
        values[m] = {value[m], 0.0, 0.0, slope[m]};
    return values;
}

} // namespace rodwake::elastic
