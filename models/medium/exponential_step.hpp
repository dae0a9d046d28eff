#pragma once
// Rods and the medium's modes, one step of both.
//
//   u_q' = -lambda_q u_q + sum_b f_q (n_b.e_q) e^(-i q.R_b),   R_b' = n_b,   theta_b' = T(u at R_b)
//
// Exponential Runge-Kutta method of order 4, ETDRK4 in the form of Krogstad (J. Comput. Phys. 203, 72, 2005),
// with one change that a moving force needs: each rod's force is looked at in a frame that walks straight on
// with the velocity V which the rod has at the start of the step. With z = h (-lambda + i q.V) for -h lambda
// in the weights, what is left to vary is
//
//   f_q n_b(t) e^(-i q.(R_b(t) - R_b(0) - V t))
//
// constant for a rod that walks straight, however long the step: its field is then exact. Rods take the
// same method with z = 0, the classical Runge-Kutta method.
//
// Fields as in summed_fields.hpp. Bits do not depend on the threads: they share rows of modes and rods.

#include "coupled_step.hpp"
#include "phi.hpp"
#include "rodwake/core/parallel.hpp"
#include "rodwake/medium/modal_field.hpp"
#include "summed_fields.hpp"

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace rodwake::medium {

class ExponentialStep : public CoupledStep {
public:
    ExponentialStep(const elastic::Medium& elastic, const DynamicMedium& medium,
                    const rods::Couplings& couplings, std::size_t rods, std::size_t threads,
                    const rods::BodyForces& bodies = {});

    Coupled start(std::vector<double> poses) override;
    void free_rates(integrate::State poses, std::span<const double> fields, std::span<double> ydot) override {
        fields_.rates(poses, fields, ydot);
    }
    void take(const Coupled& before, std::span<const double> rates, double h, Coupled& after) override;
    std::vector<double> own_turning(const Coupled& state) override {
        return fields_.own_turning(state.poses, state.fields);
    }

private:
    /// Weights of one rod's force on one mode, times h.
    struct StageWeights {
        Complex half_one, half_two; ///< phi_1(z/2)/2, phi_2(z/2)
        Complex one, two, three;    ///< phi_k(z)
    };
    /// What a rod does in a step: velocities at the stages, and the phases of what it is off its frame.
    struct RodStage {
        double nx, ny;
        PhaseFactors x, y; ///< e^(-i q.(R - R(0) - V t)), factor by factor
    };
    struct RodPath {
        std::vector<RodStage> stages;
        PhaseFactors x, y; ///< e^(-i q.(R(0) + V t)) at the time that is worked out
    };

    void prepare(const Coupled& before, double h);
    void add_stage(std::size_t rod, integrate::State before, integrate::State poses, double time);
    void fields_at(std::size_t stage, integrate::State before, std::span<const double> from, double time,
                   std::span<double> to);
    void advance_row(std::size_t row, std::size_t stage, std::size_t rod, std::span<double> field) const;

    ModalField modes_;
    std::size_t rods_;
    bool steady_;
    ThreadPool team_;
    SummedFields fields_;
    std::vector<double> decay_;         ///< e^(-lambda h/2) of l, of t, then e^(-lambda h)
    std::vector<StageWeights> weights_; ///< of rod, l or t, mode
    std::vector<RodPath> paths_;
    Coupled stage_;
    std::array<std::vector<double>, 4> slopes_;
};

} // namespace rodwake::medium
