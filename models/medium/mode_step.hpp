#pragma once
// Rods and the medium's modes, one step of both, with weights of each mode that no rod changes.
//
//   (beta/alpha) u_q'' + u_q' = -lambda_q u_q + F_q,   F_q = sum_b f_q (n_b.e_q) e^(-i q.R_b),   R_b' = n_b,
//   theta_b' = T(u at R_b)
//
// Exponential Runge-Kutta method of order 4 (mode_weights.hpp), in the frame of the medium: free modes are
// exact, and a rod that moves makes errors of some (q h)^4/3000 of the part of its field with wave number q,
// where exponential_step.hpp, which needs weights of each rod for that, makes none. For many rods, whose
// forces and turning rates come from a mesh (mode_mesh.hpp), and for a medium with inertia.
//
// With sums fields are those of summed_fields.hpp; with the mesh there is one, and without self_field
// own_response.hpp is taken off. Bits do not depend on the threads.

#include "coupled_step.hpp"
#include "mode_mesh.hpp"
#include "mode_weights.hpp"
#include "own_response.hpp"
#include "summed_fields.hpp"

#include <array>
#include <optional>

namespace rodwake::medium {

class ModeStep : public CoupledStep {
public:
    ModeStep(const elastic::Medium& elastic, const DynamicMedium& medium, const rods::Couplings& couplings,
             std::size_t rods, std::size_t threads, const rods::BodyForces& bodies = {});

    Coupled start(std::vector<double> poses) override;
    void free_rates(integrate::State poses, std::span<const double> fields, std::span<double> ydot) override;
    void take(const Coupled& before, std::span<const double> rates, double h, Coupled& after) override;
    std::vector<double> own_turning(const Coupled& state) override;

    const OwnResponse* own_response() const { return own_ ? &*own_ : nullptr; }

private:
    /// Forces on the fields at a stage.
    using Forces = std::vector<double>;

    std::size_t count() const { return mesh_ ? 1 : fields_.count(); }
    void add_steady(std::span<const double> poses, std::span<double> fields);
    void prepare(double h);
    void find_forces(integrate::State poses, Forces& forces);
    void fields_at(std::size_t stage, double h, std::span<const double> from, std::span<double> to);
    void advance_row(std::size_t row, std::size_t stage, std::size_t field, std::span<const double> from,
                     std::span<double> to) const;

    ModalField modes_;
    rods::Couplings couplings_;
    std::size_t rods_;
    bool steady_;
    ThreadPool team_;
    SummedFields fields_;
    std::optional<ModeMesh> mesh_;
    std::optional<OwnResponse> own_;
    double h_ = 0.0;                  ///< of the weights
    std::vector<DecayWeights> decay_; ///< of l, of t, each of all modes; without inertia
    std::vector<WaveWeights> wave_;   ///< the same with inertia
    std::array<Forces, 4> forces_;
    std::array<std::vector<double>, 4> poses_, slopes_; ///< at the stages
    std::vector<double> stage_fields_, turning_;
};

} // namespace rodwake::medium
