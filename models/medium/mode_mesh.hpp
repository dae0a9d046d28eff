#pragma once
// Forces and turning rates of many rods in one field, by non-uniform Fourier transforms (nonuniform_fft.hpp):
// two real sums a transform, one as its real and one as its imaginary part.
//
// Error: mesh_error of the largest turning rate. Bits do not depend on the threads.

#include "elastic/nonuniform_fft.hpp"
#include "rodwake/integrate/ode.hpp"
#include "rodwake/medium/modal_field.hpp"

#include <span>
#include <vector>

namespace rodwake::medium {

class ModeMesh {
public:
    /// `modes` and `team` outlive it.
    ModeMesh(const ModalField& modes, double box, ThreadPool& team);

    /// What the rods' forces add to the rates of l_re, l_im, t_re, t_im: sum_b f_q n_b.q/|q|, and across.
    void forces(integrate::State poses, std::span<double> rates);

    /// z.[n x (kappa eps.n + gamma1 lap u + gamma2 grad div u)] at each rod, in a field.
    void turning(integrate::State poses, std::span<const double> field, const rods::Couplings& couplings,
                 std::span<double> rates);

    /// Adds the fields of rods that have always walked straight (modal_field.hpp; without inertia). With chi
    /// the heading less the direction of q, a = D q, D = (1 + eta)/alpha for l and 1/alpha for t, and r = i
    /// (sqrt(1 + a^2) - a),
    ///
    ///   l_q = (f_q/q) cos chi/(a - i cos chi) = (f_q/q) sum_k (r^|k-1| + r^|k+1|)/(2 sqrt(1 + a^2)) e^(i k
    ///   chi),
    ///
    /// of t_q sin chi and (r^|k-1| - r^|k+1|)/(2 i sqrt(1 + a^2)): transforms of the rods with weights
    /// e^(i k heading). Where |r| is near 1, at q of order alpha and below, modes are summed over rods.
    void add_steady(integrate::State poses, std::span<double> field);

    const fourier::NonuniformFft& transform() const { return transform_; }

private:
    void place(integrate::State poses);
    /// Puts a + i b into both modes +-q of a row, a and b of +q by `make(i, qx, qy)`.
    template<class Make>
    void fill_row(std::size_t row, const Make& make);
    void add_harmonic_row(std::size_t row, int k, std::span<double> field) const;
    double largest_ratio(std::size_t row, std::size_t column) const;
    bool summed(std::size_t row, std::size_t column) const;
    std::size_t first_summed() const;

    const ModalField& modes_;
    ThreadPool& team_;
    fourier::NonuniformFft transform_;
    std::vector<double> placed_; ///< poses the transform knows of
    std::vector<fourier::Complex> values_;
};

} // namespace rodwake::medium
