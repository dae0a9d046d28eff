#include "structure_keys.hpp"

#include "rodwake/core/error.hpp"

#include <fmt/format.h>

#include <cmath>

namespace rodwake::measure {

namespace {

constexpr double most_bins = 1e6;

void want(bool legal, const std::string& what) {
    if (!legal)
        throw InputError("measure: " + what);
}

bool positive(double value) { return std::isfinite(value) && value > 0.0; }

void want_bins(const Layout& layout, const StructureKeys& keys) {
    const double half = 0.5 * layout.box, ratio = keys.order_bin / keys.bin;
    want(positive(keys.bin) && keys.bin <= half && half / keys.bin <= most_bins,
         fmt::format("bin {:g} m of g(r): must be above 0, at most half the box, {:g} m, and at least a "
                     "millionth of that",
                     keys.bin, half));
    want(positive(keys.order_bin) && keys.order_bin <= half,
         fmt::format("bin {:g} m of g_B(r): must be above 0 and at most half the box, {:g} m", keys.order_bin,
                     half));
    want(ratio > 0.5 && std::abs(ratio - std::round(ratio)) <= 1e-9 * ratio,
         fmt::format("bin {:g} m of g_B(r): must be a whole multiple of the bin of g(r), {:g} m",
                     keys.order_bin, keys.bin));
}

} // namespace

void validate(const Layout& layout, const StructureKeys& keys) {
    validate(layout);
    want(layout.beads >= 2, fmt::format("{} bead: order needs at least 2", layout.beads));
    want_bins(layout, keys);
    want(positive(keys.block), fmt::format("blocks of {:g} s: must be above 0", keys.block));
    want(keys.cutoff_frames >= 1, "cut-off from 0 frames: must be at least 1");
    want(!keys.cutoff || (positive(*keys.cutoff) && *keys.cutoff <= 0.5 * layout.box),
         fmt::format("cut-off {:g} m for neighbours: must be above 0 and at most half the box, {:g} m",
                     keys.cutoff.value_or(0.0), 0.5 * layout.box));
}

std::size_t bins_of_order_bin(const StructureKeys& keys) {
    return static_cast<std::size_t>(std::round(keys.order_bin / keys.bin));
}

} // namespace rodwake::measure
