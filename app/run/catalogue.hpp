#pragma once
// Every file a run leaves in its folder: who makes it, what it is, and its columns. manifest.json is written
// from it, and a run knows by it what of an earlier one to remove. Each stage lists its files
// (stage_kind.hpp).

#include "rodwake/app/plan.hpp"
#include "rodwake/core/record.hpp"

#include <algorithm>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace rodwake::app {

enum class Lifetime {
    result,   ///< removed when its stage is done again
    progress, ///< what an interrupted stage goes on from
    kept,     ///< results that an unfinished stage goes on from: the finished runs of an ensemble
    record    ///< of the run itself, rewritten by it
};

struct FileKind {
    std::string_view pattern; ///< name in its folder; "<k>" stands for a number or a word
    Lifetime lifetime = Lifetime::result;
    std::string_view what;
    std::span<const ColumnInfo> columns = {}; ///< of a CSV file; of JSON its numbers, "rods.<k>.force"
    std::optional<Stage> stage = {};          ///< which lists it (stage_kind.hpp); absent: the run as a whole
};

std::span<const FileKind> file_kinds();

/// With a name that is made: it lasts as long as the program. Not for several threads at once.
ColumnInfo column_info(std::string name, std::string_view unit, std::string_view meaning, ReportRow row = {});

/// Returns the unit of a value's row in the report; "" for "1".
std::string_view unit_in_report(const ColumnInfo& value);
/// From the file to that unit.
double factor_in_report(const ColumnInfo& value);

/// Where files of a run are besides its folder. Below it may also lie shares of a scan, what a tradeoff tried
/// and runs of the user's own.
inline constexpr std::string_view own_folders[] = {"figures", "variants", "points", "runs", "models"};

/// Whether a file of this name from the run folder on can be the run's.
inline bool is_own(std::string_view name) {
    const auto slash = name.find('/');
    return slash == std::string_view::npos || std::ranges::count(own_folders, name.substr(0, slash)) > 0;
}

/// Left behind by a run that was killed: see PendingFile.
bool is_temporary(const std::string& name);

/// Figures and pages, by their name from the run folder on: they follow from the results.
inline bool is_drawn(std::string_view name) {
    return name.starts_with("figures/") || name.ends_with(".html");
}

/// The kind of a file by its name without folders; nullptr for one that is not ours.
const FileKind* kind_of(std::string_view name);

/// The entry of a column by its name in a file; nullptr if the kind has none such.
const ColumnInfo* column_of(const FileKind& kind, std::string_view name);

/// Who makes a file of this kind at this place in the run folder: beds in points/ are of the scan.
std::optional<Stage> stage_of(const FileKind& kind, std::string_view name);

/// Whether a name fits a pattern: "profile_Ux_x.csv" fits "profile_<k>_<k>.csv".
bool fits(std::string_view name, std::string_view pattern);

} // namespace rodwake::app
