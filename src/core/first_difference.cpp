#include "rodwake/core/first_difference.hpp"

#include <sstream>

namespace rodwake {

std::string first_difference(const std::string& there, const std::string& here) {
    std::istringstream a(there), b(here);
    const auto next = [](std::istringstream& text, std::string& line) {
        const bool is_there = static_cast<bool>(std::getline(text, line));
        if (!is_there)
            line.clear();
        return is_there;
    };
    const auto told = [](const std::string& line) { return line.empty() ? "nothing" : line; };
    std::string line_a, line_b;
    for (bool more = true; more;) {
        const bool in_a = next(a, line_a), in_b = next(b, line_b);
        if (line_a != line_b)
            return told(line_a) + " there, " + told(line_b) + " here";
        more = in_a || in_b;
    }
    return "no line";
}

} // namespace rodwake
