#pragma once
// Tables of wakes, made once and kept for other runs.
//
// Each stands in $XDG_CACHE_HOME/rodwake (~/.cache/rodwake), its name a hash of what it was made from and its
// bytes covered by checksums; a file that is damaged or of another version is made anew. Without a writable
// cache folder a table is made for the run alone.

#include "rodwake/app/run_context.hpp"
#include "rodwake/elastic/periodic_table.hpp"
#include "rodwake/elastic/plane_table.hpp"
#include "rodwake/elastic/wake_field.hpp"
#include "rodwake/scene/scene.hpp"

#include <array>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>

namespace rodwake::app {

/// Where tables are kept; empty if the environment names no place.
std::filesystem::path table_folder();

/// "plane-0123456789abcdef.rwt"
std::string table_file_name(double eta, double tolerance);
/// "box-0123456789abcdef.rwt"
std::string table_file_name(const elastic::Medium& medium, double box, double tolerance);

/// Thread-safe; a table is made or read at most once.
class WakeTables {
public:
    explicit WakeTables(const RunContext& context, std::filesystem::path folder = table_folder())
        : context_(context), folder_(std::move(folder)) {}

    /// The plane's table of this eta. Throws InputError for an illegal eta or tolerance.
    std::shared_ptr<const elastic::PlaneTable> plane(double eta, double tolerance);
    /// The table of a medium in a box. Throws InputError for a box too large for the tolerance.
    elastic::PeriodicTable periodic(const elastic::Medium& medium, double box, double tolerance);

private:
    const RunContext& context_;
    std::filesystem::path folder_;
    std::mutex mutex_;
    std::map<std::pair<double, double>, std::shared_ptr<const elastic::PlaneTable>> planes_;
    std::map<std::array<double, 4>, elastic::PeriodicTable> boxes_; ///< by eta, xi, box, tolerance
};

/// The wake that the scene asks for by medium.field: exact, from a table, or measured (its file is also
/// looked for in `folder`).
std::shared_ptr<const elastic::WakeField> wake_field(const scene::Scene& scene,
                                                     const std::filesystem::path& folder);

} // namespace rodwake::app
