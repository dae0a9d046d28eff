#include "erk_table.hpp"

#include <algorithm>
#include <utility>

namespace rodwake::integrate {

namespace {

/// The same method with y1 itself as its last stage. ERKStep 6.4.1 takes the last slope of any table that
/// ends in c = 1 for the first slope of the next step (llnl/sundials issue 311), which costs Verner's table,
/// as shipped, its order. With this stage the assumption is true, at the same number of right-hand sides.
sundials::ButcherTable with_first_same_as_last(sundials::ButcherTable method) {
    const int stages = method->stages;
    sundials::ButcherTable extended(sundials::made(ARKodeButcherTable_Alloc(stages + 1, 1)));
    extended->q = method->q;
    extended->p = method->p;
    for (int i = 0; i < stages; ++i)
        std::copy_n(method->A[i], stages, extended->A[i]);
    std::copy_n(method->b, stages, extended->A[stages]);
    std::copy_n(method->b, stages, extended->b);
    std::copy_n(method->d, stages, extended->d);
    std::copy_n(method->c, stages, extended->c);
    extended->c[stages] = 1.0;
    return extended;
}

} // namespace

sundials::ButcherTable erk_table(Erk method) {
    const bool verner = method == Erk::verner;
    sundials::ButcherTable table(sundials::made(
        ARKodeButcherTable_LoadERK(verner ? ARKODE_VERNER_8_5_6 : ARKODE_DORMAND_PRINCE_7_4_5)));
    return verner ? with_first_same_as_last(std::move(table)) : std::move(table);
}

} // namespace rodwake::integrate
