#pragma once
// Functions of a place in the unit square about the origin and of an angle from 0 to an eighth of a turn, as
// piecewise products of Chebyshev polynomials. A group of functions is evaluated together.

#include <array>
#include <cstddef>
#include <vector>

namespace rodwake::elastic {

/// Into how many pieces each side and the range of angles are cut.
struct Pieces {
    std::size_t place, angle;
    std::size_t cells() const { return place * place * angle; }
};

inline constexpr std::size_t place_nodes = 9, angle_nodes = 12;
inline constexpr std::size_t cell_nodes = place_nodes * place_nodes * angle_nodes;

/// Node a of `nodes` in piece p of `pieces`, on [0, 1].
double chebyshev_node(std::size_t p, std::size_t pieces, std::size_t a, std::size_t nodes);

/// Which of the derivatives are wanted besides the values.
struct GridRequest {
    bool by_place = false, by_angle = false;
};

/// Of one function.
struct GridValue {
    double v = 0.0, x = 0.0, y = 0.0, angle = 0.0;
};

class ChebyshevGrid {
public:
    static constexpr std::size_t most = 4; ///< functions of a group

    ChebyshevGrid(const Pieces& pieces, std::size_t functions);
    /// From the coefficients of another of these pieces. Throws InputError if there are more or fewer.
    ChebyshevGrid(const Pieces& pieces, std::size_t functions, std::vector<double> coefficients);

    /// A node's values, to be set before `transform`: cell (row, column, angle piece), node (j, i, k).
    struct ChebyshevNode {
        std::size_t row, column, piece, j, i, k;
    };
    double* values(const ChebyshevNode& node);

    /// From values at the nodes to coefficients, one cell; cells may be done in any order and at once.
    void transform(std::size_t cell);

    /// |x|, |y| <= 1/2, 0 <= angle <= pi/4; a rounding beyond is fine.
    std::array<GridValue, most> at(double x, double y, double angle, GridRequest request) const;

    /// The same at (0, 0), where it costs a twentieth, without derivatives by place; after set_centre, which
    /// is after every cell's transform.
    std::array<GridValue, most> at_centre(double angle) const;
    void set_centre();

    const Pieces& pieces() const { return pieces_; }
    /// After every cell's transform.
    const std::vector<double>& coefficients() const { return data_; }
    std::size_t bytes() const { return data_.size() * sizeof(double); }

private:
    Pieces pieces_;
    std::size_t functions_;
    std::vector<double> data_;   ///< cell, k, j, i, function
    std::vector<double> centre_; ///< piece of the angle, k, function
};

} // namespace rodwake::elastic
