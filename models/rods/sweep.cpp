#include "sweep.hpp"

#include "rodwake/core/periodic.hpp"

#include <cmath>
#include <numeric>

namespace rodwake::rods {

namespace {

constexpr std::size_t few = 16; // sorting does not pay below

/// Coordinate `axis` of each rod, in a box with that side within it.
std::vector<double> coordinates(integrate::State y, std::size_t axis, std::optional<double> side) {
    std::vector<double> at(y.size() / 3);
    for (std::size_t a = 0; a < at.size(); ++a)
        at[a] = side ? into_box(y[3 * a + axis], *side) : y[3 * a + axis];
    return at;
}

double spread(const std::vector<double>& at) {
    const auto [low, high] = std::ranges::minmax(at);
    return high - low;
}

} // namespace

Sweep::Sweep(integrate::State y, Box box) : rods_(y.size() / 3) {
    if (rods_ <= few || !std::ranges::all_of(y, [](double value) { return std::isfinite(value); }))
        return;
    std::optional<double> side = box ? std::optional(box->x) : std::nullopt,
                          other_side = box ? std::optional(box->y) : std::nullopt;
    std::vector<double> at = coordinates(y, 0, side), other = coordinates(y, 1, other_side);
    if (spread(other) > spread(at)) {
        at.swap(other);
        side.swap(other_side);
    }
    order_.resize(rods_);
    std::iota(order_.begin(), order_.end(), 0U);
    std::ranges::sort(order_, [&](auto a, auto b) { return at[a] < at[b]; });
    at_.reserve(rods_);
    for (const std::uint32_t a : order_)
        at_.push_back(at[a]);
    if (side) {
        around_ = *side;
        farthest_ = 0.5 * *side;
        double largest = 0.0;
        for (std::size_t k = 0; k < y.size(); ++k)
            largest = k % 3 == 2 ? largest : std::max(largest, std::abs(y[k]));
        rounding_ = 8.0 * std::numeric_limits<double>::epsilon() * (largest + *side);
    }
}

} // namespace rodwake::rods
