#include "key.hpp"

#include <cmath>
#include <fmt/format.h>

namespace rodwake::scene {

namespace {

/// 1e+12 rather than 1000000000000.
std::string bound(double value) {
    return std::abs(value) < 1e7 ? fmt::format("{}", value) : fmt::format("{:g}", value);
}

} // namespace

std::string Range::text() const {
    if (low == high)
        return bound(low);
    if (low == -high)
        return "within +-" + bound(high);
    return fmt::format("{} {} and <= {}", open_low ? ">" : ">=", bound(low), bound(high));
}

std::string Key::count_text(const std::string& of) const {
    return min_items == max_items ? fmt::format("{} {}", min_items, of)
                                  : fmt::format("{} to {} {}", min_items, max_items, of);
}

Key key(std::string name) {
    Key result;
    result.name = std::move(name);
    return result;
}

} // namespace rodwake::scene
