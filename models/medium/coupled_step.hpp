#pragma once
// One step of rods and medium together, in any of its ways: with sums (exponential_step.hpp), on a mesh or
// with inertia (mode_step.hpp).

#include "rodwake/integrate/ode.hpp"
#include "rodwake/medium/modal_field.hpp"
#include "rodwake/rods/body.hpp"
#include "rodwake/rods/model.hpp"

#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace rodwake::medium {

struct Coupled {
    std::vector<double> poses;  ///< layout of rods/model.hpp
    std::vector<double> fields; ///< of the medium, in the layout of the way it is integrated
};

class CoupledStep {
public:
    explicit CoupledStep(rods::BodyForces bodies) : bodies_(std::move(bodies)) {}
    CoupledStep(const CoupledStep&) = delete;
    CoupledStep& operator=(const CoupledStep&) = delete;
    virtual ~CoupledStep() = default;

    /// The start of a run: the medium as DynamicMedium::start says.
    virtual Coupled start(std::vector<double> poses) = 0;

    /// Rates of the rods' coordinates in these fields, which need not be of the same instant, without
    /// contacts of bodies. Turning rates are linear in the fields.
    virtual void free_rates(integrate::State poses, std::span<const double> fields,
                            std::span<double> ydot) = 0;
    /// The same with contacts.
    void rates(integrate::State poses, std::span<const double> fields, std::span<double> ydot) {
        free_rates(poses, fields, ydot);
        bodies_.add_rates(poses, ydot);
    }

    /// From `before`, whose rates are `rates`, by h > 0.
    virtual void take(const Coupled& before, std::span<const double> rates, double h, Coupled& after) = 0;

    /// Turning rates that each rod's own field gives it; empty where it is not kept by itself.
    virtual std::vector<double> own_turning(const Coupled&) { return {}; }

private:
    rods::BodyForces bodies_;
};

/// The way that suits the medium.
std::unique_ptr<CoupledStep> make_step(const elastic::Medium& elastic, const DynamicMedium& medium,
                                       const rods::Couplings& couplings, std::size_t rods,
                                       std::size_t threads, const rods::BodyForces& bodies = {});

/// Amplitudes l_re, l_im, t_re, t_im of the sum of all rods' fields, of Coupled::fields.
std::vector<double> summed_amplitudes(const ModalField& modes, const DynamicMedium& medium, std::size_t rods,
                                      std::span<const double> fields);

/// Numbers in Coupled::fields.
std::size_t field_numbers(const DynamicMedium& medium, std::size_t rods);

} // namespace rodwake::medium
