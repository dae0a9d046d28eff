#pragma once

namespace rodwake::integrate {

enum class Method {
    bdf,   ///< CVODES, backward differentiation, order 1 to 5, dense Newton; for stiff problems. IDAS where
           ///< components are algebraic
    adams, ///< CVODES, Adams-Moulton, order 1 to 12, fixed-point iteration; fewest right-hand sides when not
           ///< stiff
    erk    ///< explicit Runge-Kutta: Tsitouras-Famelis 6(5) up to 27 components; beyond by ARKODE,
           ///< Dormand-Prince 5(4) for rtol > 1e-6, from there down Verner 6(5)
};

} // namespace rodwake::integrate
