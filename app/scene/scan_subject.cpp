#include "rodwake/scene/scan_subject.hpp"

#include <algorithm>
#include <array>

namespace rodwake::scene {

namespace {

constexpr std::string_view bed_table = "granular.";

bool varies_bed(const ScanAxis& axis) {
    return axis.key.starts_with(bed_table) ||
           std::ranges::any_of(axis.keys, [](const std::string& key) { return key.starts_with(bed_table); });
}

template<std::size_t N>
bool is_of(std::string_view key, const std::array<std::string_view, N>& beginnings) {
    return std::ranges::any_of(beginnings, [&](std::string_view one) { return key.starts_with(one); });
}

} // namespace

ScanSubject scan_subject(const Scene& scene) {
    if (!scene.granular || !scene.scan)
        return ScanSubject::rods;
    return !scene.rods_run || std::ranges::any_of(scene.scan->axes, varies_bed) ? ScanSubject::beds
                                                                                : ScanSubject::rods;
}

bool can_vary(std::string_view key, ScanSubject subject) {
    // what is stored and how many runs there are is not what a run depends on
    constexpr std::array<std::string_view, 3> not_of_beds{"granular.runs", "granular.output.",
                                                          "granular.restart_from"};
    constexpr std::array<std::string_view, 14> not_of_rods{
        "scan.", "figures.", "variants.", "field.", "granular.", "measure.", "fit.", "title", "schema",
        // a scan takes the exact field, and its table has no order of rods
        "medium.field", "medium.table.", "medium.measured.", "medium.dynamic.", "rods_order."};
    return subject == ScanSubject::beds ? key.starts_with(bed_table) && !is_of(key, not_of_beds)
                                        : !is_of(key, not_of_rods);
}

} // namespace rodwake::scene
