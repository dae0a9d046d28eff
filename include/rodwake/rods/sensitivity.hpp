#pragma once
// How trajectories of rods change with couplings, medium and initial headings: the equations of motion with
// their forward sensitivities (integrate/sensitivity.hpp).
//
// Error: below 1e-7 against differences of order 8, all 12 reference trajectories, 5 parameters and headings,
// through contacts (asserted by build/dev/tests/test_rods). No parameters at all are fine.

#include "rodwake/integrate/sensitivity.hpp"
#include "rodwake/rods/simulate.hpp"

#include <span>

namespace rodwake::rods {

/// Couplings in the laplacian basis, in the order of coupling_list, the medium, the rows of a crystal, and
/// the contacts of bodies, in reduced units as everywhere here.
enum class Parameter {
    kappa,
    gamma1,
    gamma2,
    eta,
    xi,
    rows_gamma,
    rows_direction,
    stall_overlap,
    mobility_ratio
};
static_assert(static_cast<std::size_t>(Parameter::eta) == std::size(coupling_list));

/// nullptr for the others.
constexpr const Coupling* coupling_of(Parameter parameter) {
    return parameter < Parameter::eta ? &coupling_list[static_cast<std::size_t>(parameter)] : nullptr;
}

double& value(RodProblem& problem, Parameter parameter);
double value(const RodProblem& problem, Parameter parameter);

/// Columns: `parameters`, then the initial headings of the rods named, then initial `places`: 2 rod for its
/// x, 2 rod + 1 for its y. With a contact distance the contact is a terminal event, its gradient that of the
/// closest pair. A coupling that is 0 but a parameter is differentiated like any other. Throws InputError as
/// simulate(), for couplings or eta and xi without a medium, for rods that are not there, and for a field
/// without the derivatives needed.
integrate::SensitivityProblem to_sensitivity_problem(const RodProblem& problem,
                                                     std::span<const Parameter> parameters,
                                                     std::span<const std::size_t> headings,
                                                     std::span<const std::size_t> indices = {});

} // namespace rodwake::rods
