#pragma once
// Heat of many rods in a periodic square: the sum of nodes (heat_nodes.hpp), and its fields at the rods.
//
// Each node's forces are spread on a grid of 1.2 points a mode with the Kaiser-Bessel kernel
// I0(beta sqrt(1 - s^2))/I0(beta), transformed, given their Gaussian and added up as modes of the
// displacement,
//
//   u_q = sum_k w_k [ e^(-D_T q^2 t_k) N + i q (e^(-D_T q^2 t_k) - D_L e^(-D_L q^2 t_k)) S ],
//
// S = sum_b e^(-i q.(R_b - n_b t_k)) and N with n_b in front; the modes' fields go back the same way. So few
// points a mode will do because modes that they spoil, at the edge, are those that the Gaussian extinguishes:
// the error is some e^-cutoff of the Gaussian at its centre, `cutoff` that of its modes.
//
// Numbers of a grid are real, so modes are those of m >= 0. Bits depend neither on the threads, since each
// grid point adds up its rods in their order, nor on the vectors of a machine.

#include "heat_nodes.hpp"
#include "nonuniform_fft.hpp"

#include <map>

namespace rodwake::elastic {

/// The kernel's numbers at the points that it covers, by how far the first lies beyond its edge, z in [0, 1):
/// of each of `pieces` parts of that a polynomial. Rows are filled up to whole vectors with zeros.
class MeshKernel {
public:
    static constexpr std::size_t narrowest = 4, widest = 16, pieces = 16, terms = 6;

    explicit MeshKernel(std::size_t width);

    /// Wide enough for errors of e^-cutoff.
    static std::size_t width_for(double cutoff);
    std::size_t width() const { return width_; }
    std::size_t row() const { return width_ > 8 ? 16 : 8; }
    const double* values() const { return values_.data(); } ///< piece by piece, term by term
    /// Of the kernel, at mode m of a grid.
    double transform(double m, double grid) const;

private:
    std::size_t width_;
    double beta_, top_; ///< and I0 of it
    std::vector<double> values_;
};

/// A grid of some fields: each line has a row of each field, with room at both ends for what reaches over.
struct MeshGrid {
    std::size_t size, half, width, pad, fields, columns, lines;
    double per_length;

    MeshGrid(double box, std::size_t half_modes, std::size_t kernel_width, std::size_t field_count);
};

class HeatMesh {
public:
    /// Of kernels from the narrowest on, which outlive it.
    HeatMesh(double eta, std::span<const MeshKernel> kernels) : diffusivity_(1.0 + eta), kernels_(kernels) {}

    /// Begins a sum in a square from (x, y) on, of modes up to `half` each way; `team` outlives it.
    void begin(double x, double y, double box, std::size_t half, ThreadPool& team);
    /// Forces of the rods within `felt` of the inner square, which is `margin` from the sides.
    void add(const NearSources& rods, const HeatNode& node, double cutoff, double margin, double felt);
    /// Adds strain, and polar vectors if there are sums for them, at rods within the square.
    void read(const NearSources& rods, double cutoff, std::span<double* const> sums);

private:
    /// Of a node, by mode.
    struct Weights {
        double node;
        std::vector<double> shear, longitudinal;
    };
    const MeshKernel& kernel(double cutoff) const;
    double wave(std::size_t m) const { return unit_ * static_cast<double>(m); }
    std::vector<double> gaussian(const MeshKernel& kernel, const MeshGrid& g, double spread) const;
    void reserve(const MeshGrid& g);
    void add_modes(const MeshGrid& g, const fourier::Fft& fft, const Weights& weights, std::size_t block);

    double diffusivity_; ///< D_L
    std::span<const MeshKernel> kernels_;
    ThreadPool* team_ = nullptr;
    double x_ = 0.0, y_ = 0.0, box_ = 0.0, unit_ = 0.0; ///< unit of wave numbers
    std::size_t half_ = 0;
    std::vector<fourier::Complex> ux_, uy_;       ///< modes (m, n) at (n + half) (half + 1) + m
    std::vector<double> between_re_, between_im_; ///< one direction transformed: m, then a line of the grid
    std::vector<double> grid_;
    std::map<std::size_t, fourier::Fft> ffts_;
};

// By vectors (heat_points.cpp).

/// Rods on a grid, `time` ago.
struct MeshRods {
    const MeshKernel& kernel;
    const MeshGrid& grid;
    const NearSources& rods;
    double x, y, time;      ///< corner of the square
    double lowest, highest; ///< coordinates that are meant, in grid points
};

/// Adds their numbers 1, n_x, n_y to lines from `begin` to `end`.
void spread_rods(const MeshRods& task, std::size_t begin, std::size_t end, double* to);
/// Adds the fields at a vector of rods, the first of which is `from`.
void read_rods(const MeshRods& task, std::size_t from, std::size_t fields, const double* grid,
               double* const* sums);

} // namespace rodwake::elastic
