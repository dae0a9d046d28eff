// Prints what must have the same bits everywhere, once for each instruction set of the vector loops that this
// machine has: "<set>,<what>,<hash>". studies/validate_bits.py compiles and compares it.

#include "granular/fixed_bits.hpp"
#include "granular/kernels.hpp"
#include "support/instruction_sets.hpp"

#include <cstdio>

namespace fixed = rodwake::granular::fixed;

int main() {
    const auto print = [] {
        for (const auto& [what, hash] : fixed::all())
            std::printf("%s,%s,%016llx\n", rodwake::granular::vector_target(), what.c_str(),
                        static_cast<unsigned long long>(hash));
    };
#if HWY_ONCE && defined(HWY_COMPILE_ONLY_STATIC)
    print();
#else
    rodwake::for_each_instruction_set(print);
#endif
}
