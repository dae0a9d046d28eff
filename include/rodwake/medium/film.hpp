#pragma once
// Frames of the displacement while rods run in a dynamic medium (simulate.hpp): u on a grid at equal times.
//
//   u(x_i, y_j) = sum_q u_q e^(i q.r),   x_i = (i/points - 1/2) box, y_j alike,   i, j = 0 ... points - 1
//
// of the amplitudes of modal_field.hpp: in f/mu, lab frame, the sum of the fields of all rods, also where
// each rod feels those of the others alone (self_field = false). Points are places, not cells: a grid finer
// or coarser than the modes changes no value. Error: at a step's end that of the run; within a step that of
// one step of the method to there, some 15 tolerances; of the sums some 1e-15 of the largest value.

#include "rodwake/medium/dynamic_medium.hpp"
#include "rodwake/medium/modal_field.hpp"

#include <functional>
#include <span>
#include <vector>

namespace rodwake::medium {

/// What a film of a run may take on disk; beyond, a longer film_interval or a smaller film_grid.
inline constexpr double most_film_bytes = 4e9;

/// Spans hold during the call.
struct FilmFrame {
    double time = 0.0;
    std::span<const double> poses; ///< layout of rods/model.hpp, unwrapped
    std::span<const double> ux;    ///< [j][i], f/mu: rows of equal y
    std::span<const double> uy;
};
using FilmSink = std::function<void(const FilmFrame&)>;

/// Multiples of film_interval from 0 to t_end; none without film_interval. A run that ends before has those
/// up to its end.
std::vector<double> film_times(const DynamicMedium& medium, double t_end);

/// Doubles in a frame: time, poses, ux, uy.
std::size_t film_frame_size(const DynamicMedium& medium, std::size_t rods);

/// Throws InputError for an interval or a grid that makes no film (film_grid: even, 4 to 1024, of the prime
/// factors 2, 3 and 5, box/film_grid at most force_width), for a closure, and for more than most_film_bytes.
void validate_film(const DynamicMedium& medium, std::size_t rods, double t_end);

/// u of amplitudes l_re, l_im, t_re, t_im (modal_field.hpp) at the points above, by fast Fourier transforms:
/// modes beyond the grid's own are folded onto those that are equal at its points.
class FieldGrid {
public:
    /// Throws InputError for a number of points a side with other prime factors than 2, 3 and 5.
    explicit FieldGrid(std::size_t points);

    std::size_t points() const { return points_; } ///< a side
    /// Place of point i along a side of `box`.
    double place(std::size_t i, double box) const {
        return (static_cast<double>(i) / static_cast<double>(points_) - 0.5) * box;
    }
    /// ux and uy: [j][i], points()^2 numbers each.
    void evaluate(const ModalField& modes, std::span<const double> field, std::span<double> ux,
                  std::span<double> uy) const;

private:
    std::size_t points_;
};

} // namespace rodwake::medium
