#pragma once
// The [scan] table: which keys of the scene vary, over what, and where points are placed.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace rodwake::scene {

/// As in TOML: a number may be given as an integer, an integer not as a number.
using Value = std::variant<bool, std::int64_t, double, std::string>;

struct Scene;

// What the points of a scan are.

/// Encounters of rods of the theory, or granular runs.
enum class ScanSubject { rods, beds };

/// The beds of a scene that has no [rods_run]; of one that has both those if an axis varies [granular].
ScanSubject scan_subject(const Scene& scene);

/// Whether points of a scan of this subject depend on the key, so that it can be an axis.
bool can_vary(std::string_view key, ScanSubject subject);

enum class ScanDesign { grid, list, lhs, sobol, adaptive, critical };
enum class ScanSpacing { linear, log };

inline constexpr long default_scan_count = 64;
inline constexpr std::size_t max_scan_axes = 6;

/// [[scan.axes]]: one key, or several that go together. Values stand as a scene file has those keys, in their
/// units.
struct ScanAxis {
    std::string key;               ///< empty: `keys`
    std::vector<std::string> keys; ///< tied: key k gets factor[k] times the axis
    std::vector<double> factor;    ///< empty: all 1
    std::string label;             ///< in figures, TeX; empty: the symbol of the key
    std::optional<Value> from, to;
    ScanSpacing spacing = ScanSpacing::linear;
    long count = default_scan_count; ///< grid: points; adaptive: cells at the start
    std::vector<Value> values;       ///< instead of from, to and count

    /// What the axis is called in results.
    const std::string& name() const { return key.empty() ? keys.front() : key; }

    bool operator==(const ScanAxis&) const = default;
};

/// [[scan.refine]]: what else than the outcome makes a cell be divided.
struct ScanRefine {
    std::string observable;
    double step = 0.0; ///< largest change over a cell

    bool operator==(const ScanRefine&) const = default;
};

struct Scan {
    ScanDesign design = ScanDesign::grid;
    long resolution = 1024; ///< adaptive: cells a side at the finest
    long samples = 1000;    ///< lhs, sobol
    std::string file;       ///< list: CSV, header = keys, a row a point
    long seed = 1;          ///< lhs and the audit
    /// Points tried at random, adaptive: in cells that were not divided; critical: values beside the coarse
    /// ones.
    std::optional<long> audit;
    std::optional<double> boundary_tolerance; ///< of the axis; absent: boundaries are not bisected
    std::optional<double> time_limit;         ///< seconds a point
    bool decide = false;                      ///< points that are undecided at t_end go on
    bool certificates = false;                ///< of rods that turn too: each takes a second run
    long trajectories = 256;                  ///< stored sample of trajectories
    long max_points = 20'000'000;             ///< more are refused
    // Critical values: of the key `solve_for` those at which the end of an encounter changes.
    std::string solve_for;
    std::optional<Value> from, to; ///< its range
    ScanSpacing spacing = ScanSpacing::linear;
    long count = 20; ///< values of the coarse pass
    std::vector<std::string> between{"capture", "escape"};
    double tolerance = 1e-8; ///< of max(|value|, range/1000)
    std::vector<ScanAxis> axes;
    std::vector<ScanRefine> refine;

    long audited() const { return audit.value_or(design == ScanDesign::critical ? count : 1000); }
    bool operator==(const Scan&) const = default;
};

} // namespace rodwake::scene
