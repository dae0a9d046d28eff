#pragma once
// Equations of motion of N motile rods in each other's wakes (paper Eqs. motileEoM, thetaeq), heading-angle
// form.
//
//   x_a' = cos theta_a,  y_a' = sin theta_a
//   theta_a' = sum over b != a of z.[n_a x (kappa eps_b.n_a + gamma1 lap u_b + gamma2 grad div u_b)] at R_a
//
// Reduced units: lengths f/mu, times f/(mu v0), so v0 = 1 and f/mu = 1. Each rod's field is the steady one of
// elastic/field.hpp, turned to its heading at that instant: the quasi-static closure of the paper.
// State layout: x_0, y_0, theta_0, x_1, y_1, theta_1, ... (3 N doubles).

#include "rodwake/elastic/field.hpp"
#include "rodwake/integrate/ode.hpp"
#include "rodwake/rods/couplings.hpp"

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace rodwake::rods {

struct Pose {
    double x = 0.0, y = 0.0;
    double heading = 0.0; ///< theta, rad, counter-clockwise from +x
};

/// Right-hand side and Jacobian. Without medium, without coupling or with one rod on the infinite plane no
/// field is evaluated. Cost: N (N - 1) field points a call. Thread-safe. Throws InputError if two rods are in
/// the same place.
class RodModel {
public:
    /// With `box` each rod's field is that of all its images in a periodic box of that side along the lab's
    /// axes (elastic/periodic.hpp), and its own images turn a rod too.
    RodModel(std::optional<elastic::Medium> medium, const Couplings& couplings, std::size_t rods,
             std::optional<double> box = {});

    std::size_t rods() const { return rods_; }
    bool interacting() const { return field_.has_value(); }

    void rhs(integrate::State y, std::span<double> ydot) const;
    /// jacobian(i, j) = d rhs_i / d y_j, 3 N x 3 N. Throws InputError in a periodic box: take difference
    /// quotients.
    void jacobian(integrate::State y, Eigen::Ref<Eigen::MatrixXd> jacobian) const;

    /// "rods[3].theta"
    static std::string component_name(std::size_t component);

private:
    void add_periodic_turning(integrate::State y, std::span<double> ydot) const;

    std::optional<elastic::Field> field_; ///< empty: nothing interacts
    std::optional<double> box_;
    Couplings couplings_;
    std::size_t rods_;
};

std::vector<double> to_state(std::span<const Pose> rods);
Pose pose(integrate::State y, std::size_t rod);

} // namespace rodwake::rods
