#pragma once
// Runs a test on each instruction set of this machine that Highway has kernels for.

#include <hwy/highway.h>

namespace rodwake {

/// Calls `test()` with the dispatch restricted to one instruction set after the other; all are allowed again
/// at the end, however it ends.
template<class Test>
void for_each_instruction_set(const Test& test) {
    struct Restore {
        ~Restore() {
            hwy::SetSupportedTargetsForTest(0);
            hwy::GetChosenTarget().Update(hwy::SupportedTargets());
        }
    } restore;
    for (auto left = hwy::SupportedTargets(); left != 0; left &= left - 1) {
        const auto target = left & -left;
        hwy::SetSupportedTargetsForTest(target);
        hwy::GetChosenTarget().Update(target);
        test();
    }
}

} // namespace rodwake
