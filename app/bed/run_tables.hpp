#pragma once
// What a granular run wrote beside its frames, for the measures that are made from it.

#include "bed/measure_kind.hpp"
#include "rodwake/core/encounter.hpp"
#include "rodwake/core/record.hpp"

#include <array>
#include <filesystem>

namespace rodwake::app {

/// Read when they are asked for.
RunTables run_tables(const std::filesystem::path& folder);

/// As the columns of pairs.csv: lengths in a, angles in rad, times in s.
struct PairNumbers {
    double outcome_time = 0.0, half_box_change = 0.0, last_change = 0.0, separation = 0.0,
           min_separation = 0.0;
    std::array<double, 2> turn{};
    double non_reciprocity = 0.0;
    int leader = 0;
    Ending outcome = Ending::undecided;

    /// Of the tables of a scan.
    static constexpr auto fields() {
        using R = PairNumbers;
        return std::tuple{
            field("time", &R::outcome_time, {"s", "of contact, else the end of the run"}),
            field("delta_y", &R::half_box_change,
                  {"a",
                   "change of the separation when the pair had come half a box, outwards positive (empty: it "
                   "has not)"}),
            field("last_change", &R::last_change,
                  {"a", "change of the separation at the end, outwards positive"}),
            field("separation", &R::separation, {"a", "at the start, across the mean first heading"}),
            field("min_separation", &R::min_separation, {"a", "smallest separation of two rods"}),
            field(
                "turn", &R::turn,
                {"rad", "of the rod from start to end; in beds + is towards the other rod's first position"}),
            field("non_reciprocity", &R::non_reciprocity,
                  {"1", "(|turn of the rear| - |turn of the front|)/(their sum)"}),
            field("leader", &R::leader, {"1", "rod that was ahead when the pair had turned most"})};
    }
};

/// From t = 0 on. Throws InputError where the tracks are none of two rods.
PairNumbers pair_numbers(const scene::Scene& scene, const RunTables& run);

} // namespace rodwake::app
