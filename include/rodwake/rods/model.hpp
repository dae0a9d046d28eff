#pragma once
// Equations of motion of N motile rods in each other's wakes (paper Eqs. (12), (22)), heading-angle
// form.
//
//   x_a' = cos theta_a,  y_a' = sin theta_a
//   theta_a' = sum over b != a of z.[n_a x (kappa eps_b.n_a + gamma1 lap u_b + gamma2 grad div u_b)] at R_a
//              - gamma_rows sin 6(theta_a - direction)    with Rows
//   and what the contacts of their bodies add to all three (rods/body.hpp)
//
// Reduced units: lengths f/mu, times f/(mu v0), so v0 = 1 and f/mu = 1. Each rod's field is the steady one of
// elastic/field.hpp, turned to its heading at that instant: the quasi-static closure of the paper. In a
// periodic box it is that of all its images, and b = a counts too: a rod is in the wakes of its own images.
// State layout: x_0, y_0, theta_0, x_1, y_1, theta_1, ... (3 N doubles).
//
// Errors: those of the field, times couplings; the Jacobian within 1e-7 of its largest entry of differences,
// whose own error that is (200 random states of 2 to 5 rods, build/dev/tests/test_rods).
//
// Degenerate input to rhs:
//   two rods in one place                   InputError; without a coupling theta' = 0, and it goes unnoticed
//   a place that is not finite              InputError, likewise
//   a coupling that is NaN                  theta' is NaN
//   one rod on the plane; no rods           theta' = 0; nothing is written

#include "rodwake/elastic/wake_field.hpp"
#include "rodwake/integrate/ode.hpp"
#include "rodwake/rods/body.hpp"
#include "rodwake/rods/couplings.hpp"

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace rodwake::rods {

struct Pose {
    double x = 0.0, y = 0.0;
    double heading = 0.0; ///< theta, rad, counter-clockwise from +x
};

/// Right-hand side and Jacobian. Without field, without coupling or with one rod on the infinite plane no
/// field is evaluated. Thread-safe. Throws InputError if two rods are in the same place.
class RodModel {
public:
    /// `field`: the wakes, and with them the domain, plane or periodic box; none: nothing of them turns rods.
    RodModel(std::shared_ptr<const elastic::WakeField> field, const Couplings& couplings, std::size_t rods,
             const Rows& rows = {}, BodyForces bodies = {});

    std::size_t rods() const { return rods_; }
    bool interacting() const { return field_ != nullptr; }
    const Rows& rows() const { return rows_; }
    const BodyForces& bodies() const { return bodies_; }
    /// Whether jacobian() can be asked for: the field has gradients, or none is evaluated.
    bool has_jacobian() const { return !field_ || field_->capabilities().gradients; }

    void rhs(integrate::State y, std::span<double> ydot) const;
    /// At each rod the wakes of the others, lab components; as they were if none is evaluated.
    void wakes(integrate::State y, std::span<elastic::FieldValues> sums) const;
    /// jacobian(i, j) = d rhs_i / d y_j, 3 N x 3 N.
    void jacobian(integrate::State y, Eigen::Ref<Eigen::MatrixXd> jacobian) const;
    /// Both at once, on the plane from one look at each wake.
    void linearise(integrate::State y, std::span<double> ydot, Eigen::Ref<Eigen::MatrixXd> by_state) const;

    /// "rods[3].theta"
    static std::string component_name(std::size_t component);

private:
    void fill_jacobian(integrate::State y, Eigen::Ref<Eigen::MatrixXd> jacobian,
                       std::span<double> rates) const;

    std::shared_ptr<const elastic::WakeField> field_; ///< none: nothing interacts
    Couplings couplings_;
    std::size_t rods_;
    Rows rows_;
    BodyForces bodies_;
};

std::vector<double> to_state(std::span<const Pose> rods);
Pose pose(integrate::State y, std::size_t rod);

} // namespace rodwake::rods
