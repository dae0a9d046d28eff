#pragma once
// From [scan] to a design, and from a point of it to a scene. A point is a function of the scene and the
// values of its axes; values are as a scene file has them as plain numbers, in the unit of the key.

#include "rodwake/scan/design.hpp"
#include "rodwake/scene/scan.hpp"
#include "rodwake/scene/scene.hpp"
#include "rodwake/scene/set.hpp"

#include <optional>
#include <string>
#include <vector>

namespace rodwake::app {

/// The rows of scan.file.
struct ScanList {
    std::vector<std::string> keys;
    std::vector<std::vector<double>> rows;
};

/// Critical values are sought on the last axis of the design, for each point of the axes before it.
struct CriticalPlan {
    std::vector<std::string> between; ///< outcomes or groups of them; one: every change
    double tolerance = 1e-8;          ///< of max(|value|, range/1000)
    std::vector<bool> audited;        ///< of each value of the last axis whether it was drawn at random
};

struct ScanPlan {
    /// A key that varies: value of its axis times `scale` (ties and units), or one of `words`.
    struct VariedKey {
        std::size_t axis = 0;
        std::string key;
        double factor = 1.0, scale = 1.0;
        bool whole = false;
        std::vector<scene::Value> words;
    };

    scene::ScanSubject subject = scene::ScanSubject::rods;
    scan::Design design; ///< of beds with granular.runs, and what a run costs
    scan::Columns columns;
    std::string description;   ///< what the results depend on, for the ledger
    scene::Scene base;         ///< the scene without what points do not need
    scene::ValueSetter setter; ///< of all keys, in the order of `keys`
    std::vector<VariedKey> keys;
    std::vector<std::string> labels;  ///< of each axis, for figures; empty: that of the key
    std::optional<double> time_limit; ///< seconds a point
    bool decide = false;              ///< undecided points go on until they are decided
    bool certificates = false;        ///< points of rods get a certificate of their outcome
    std::optional<CriticalPlan> critical = {};
};

/// Throws InputError for axes that name no key of the scene, are empty or leave the key's range, and for more
/// points than scan.max_points. `list`: the rows of scan.file.
ScanPlan plan_scan(const scene::Scene& scene, const std::optional<ScanList>& list);

/// Puts a point's values into a copy of `base`; what is wrong, or nothing.
std::optional<std::string> set_point(const ScanPlan& plan, scene::Scene& scene, const scan::Point& point);

/// The part of a scene that the points of its scan depend on, as text: neither resolution, nor the number of
/// runs, nor what is stored of a scan.
std::string scan_key(const scene::Scene& scene);

} // namespace rodwake::app
