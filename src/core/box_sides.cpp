#include "rodwake/core/box_sides.hpp"

#include <sstream>

namespace rodwake {

std::string to_string(const PeriodicBox& box) {
    std::ostringstream text;
    text << box.x;
    if (!box.square())
        text << " x " << box.y;
    return text.str();
}

} // namespace rodwake
