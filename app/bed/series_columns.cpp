#include "series_columns.hpp"

#include <algorithm>

namespace rodwake::app {

namespace {

constexpr SeriesInfo of_case[] = {{{"name", "1", "of the variant; scene: as written"}, false},
                                  {{"phi_b", "1", "area fraction of the beads"}, false},
                                  {{"d0", "a", "distance of two rods at the start"}, false},
                                  {{"imposed_speed", "a/s", "of the rod; empty: it is free"}, false}};
/// Of the case too, but readers know it behind this column.
constexpr SeriesInfo run_count = {{"runs", "1", "finished runs"}, false};
constexpr std::string_view before_runs = "delta_y";

} // namespace

std::span<const SeriesInfo> series_columns() {
    static const std::vector<SeriesInfo> columns = [] {
        std::vector<SeriesInfo> all(std::begin(of_case), std::end(of_case));
        for (const MeasureKind& kind : measure_kinds())
            all.insert(all.end(), kind.series.begin(), kind.series.end());
        const auto before =
            std::ranges::find(all, before_runs, [](const SeriesInfo& c) { return c.column.name; });
        all.insert(before == all.end() ? before : before + 1, run_count);
        return all;
    }();
    return columns;
}

} // namespace rodwake::app
