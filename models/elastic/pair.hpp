#pragma once
// Two doubles in one vector register (SSE2 and NEON have it everywhere): the closed form is made of two
// potentials of one shape, so both are worked out at once.

namespace rodwake::elastic {

using Pair = double __attribute__((vector_size(16)));

} // namespace rodwake::elastic
