#pragma once
// Three formulations of the equations of motion (model.hpp), with the same solutions. With h_a = kappa
// eps(R_a).n_a + gamma1 lap u(R_a) + gamma2 grad div u(R_a), fields summed over the other rods' wakes:
//
//   angle      state x, y, theta of each rod (3 N):       R' = (cos theta, sin theta), theta' = z.[n x h]
//   director   state x, y, n_x, n_y (4 N):                R' = n, n' = (z.[n x h]) z x n
//              n' is normal to n, so |n| = 1 is kept by the exact solution; the solver's is put back on it
//              after each step.
//   dae        state x, y, n_x, n_y, lambda (5 N):        R' = n, n' = h + lambda n
//              with |n|^2 = 1. The constraint does not contain lambda (index 2). Differentiated once it does:
//                0 = n.h + lambda |n|^2 + b (|n|^2 - 1)/2
//              (index 1). Its first two terms alone would let |n| drift; the third makes a deviation of |n|^2
//              decay as exp(-b t), b = 1 mu v0/f (Baumgarte 1972). lambda = -n.h: what the rod's stiffness
//              holds against stretching by the medium. It contains the trace of eps, the motion does not.
//
// docs/numerics.md derives them and says when which is worth having. Reduced units throughout.

#include <cstddef>
#include <string>

namespace rodwake::rods {

enum class Formulation { angle, director, dae };
using Form [[deprecated("it is Formulation")]] = Formulation;

/// Components of a state in this form.
std::size_t state_size(Formulation form, std::size_t rods);

/// "angle", "director", "dae"
std::string to_string(Formulation form);

} // namespace rodwake::rods
