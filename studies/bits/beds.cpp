// Prints what must have the same bits everywhere, once for each instruction set of the vector loops that this
// machine has: "<set>,<what>,<hash>". studies/validate_bits.py compiles and compares it.

#include "granular/fixed_bits.hpp"
#include "granular/kernels.hpp"
#include "support/instruction_sets.hpp"

#include <cstdio>
#include <set>
#include <string>

namespace fixed = rodwake::granular::fixed;

int main() {
    std::set<std::string> printed;
    const auto print = [&] {
        if (!printed.insert(rodwake::granular::vector_target()).second)
            return; // Highway takes the plain loops for sets that it has no code for
        for (const auto& [what, hash] : fixed::all())
            std::printf("%s,%s,%016llx\n", rodwake::granular::vector_target(), what.c_str(),
                        static_cast<unsigned long long>(hash));
    };
#ifdef HWY_COMPILE_ONLY_STATIC
    print();
#else
    rodwake::for_each_instruction_set(print);
#endif
}
