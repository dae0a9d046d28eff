#pragma once
// What each part of a scene brings to its tradeoff: the ways to compute it, and how one is tried.

#include "rodwake/app/ways.hpp"

#include <functional>

namespace rodwake::app {

struct WaySubject {
    std::string work, reference;
    std::vector<Way> ways; ///< their keys
    /// Fills in what way k finds, given those before it. False if it was stopped. Throws InputError or
    /// RunError for a way that cannot be gone.
    std::function<bool(std::vector<Way>& ways, std::size_t k)> attempt;
};

/// Of the scene without its variants. Time step, duration, and how often it is measured; the reference is the
/// first way, of the shortest step. Runs are kept below `folder`. The context must outlive all three.
WaySubject bed_ways(const scene::Scene& scene, double limit, const std::filesystem::path& folder,
                    const RunContext& context);
/// Search, polish, number of starts, and intervals from the curvature or the likelihood. The data may be in
/// `results`.
WaySubject fit_ways(const scene::Scene& scene, double limit, const std::filesystem::path& results,
                    const RunContext& context);
/// The exact field and tables of it, at the points of [field].
WaySubject field_ways(const scene::Scene& scene, const RunContext& context);

} // namespace rodwake::app
