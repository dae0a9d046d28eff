#include "rodwake/rods/outcome.hpp"

#include "rodwake/rods/separation.hpp"

#include <algorithm>
#include <cmath>

namespace rodwake::rods {

using integrate::State;

Ending classify_pair(State y, State ydot, std::size_t a, std::size_t b, const LatePart& late,
                     const EndingCriteria& criteria, Box box) {
    const Offset d = offset(y, a, b, box);
    PairEnd pair;
    pair.x = d.x;
    pair.y = d.y;
    pair.vx = ydot[3 * a] - ydot[3 * b];
    pair.vy = ydot[3 * a + 1] - ydot[3 * b + 1];
    pair.heading[0] = y[3 * a + 2];
    pair.heading[1] = y[3 * b + 2];
    pair.angle = angle_between(pair.heading[0], pair.heading[1]);
    pair.late = late;
    pair.late.max_turning =
        std::max({std::abs(ydot[3 * a + 2]), std::abs(ydot[3 * b + 2]), late.max_turning});
    return classify(pair, criteria);
}

} // namespace rodwake::rods
