#include "catalogue.hpp"

#include "rodwake/app/explore.hpp"
#include "stage_kind.hpp"

#include <algorithm>
#include <cctype>
#include <set>

namespace rodwake::app {

namespace {
using enum Lifetime;

/// Of the run as a whole.
std::vector<FileKind> general_files() {
    return {
        {"scene.toml", record, "the scene as resolved: every key with its value"},
        {"provenance.json", record,
         "who made the run, how each stage ended, the command that makes it again, elapsed seconds of the "
         "last command"},
        {"log.txt", record, "messages of every command that worked on the run"},
        {"manifest.json", record, "this list"},
        {"rodwake.lock", record, "host and process that works on the run, or did last"},
        {"film_<k>.h5md", record, "the film of [tracks], made once of a file in another format"},
        {"result.h5", result, "field and trajectories as datasets with units"},
        {"report.html", result, "figures and numbers of the run on one page"},
        {explorer_file, result, "the two rods of the run, to be dragged in a browser"}};
}

std::vector<FileKind> all_kinds() {
    std::vector<FileKind> all = general_files();
    for (const Stage stage : all_stages())
        for (FileKind file : kind_of(stage).files()) {
            file.stage = stage;
            all.push_back(file);
        }
    return all;
}

} // namespace

ColumnInfo column_info(std::string name, std::string_view unit, std::string_view meaning) {
    static std::set<std::string> names;
    return {*names.insert(std::move(name)).first, unit, meaning};
}

bool fits(std::string_view name, std::string_view pattern) {
    const auto gap = pattern.find("<k>");
    if (gap == std::string_view::npos)
        return name == pattern;
    if (!name.starts_with(pattern.substr(0, gap)))
        return false;
    const std::string_view rest = pattern.substr(gap + 3);
    for (std::size_t end = gap + 1; end <= name.size(); ++end) {
        if (!std::isalnum(static_cast<unsigned char>(name[end - 1])))
            return false;
        if (fits(name.substr(end), rest))
            return true;
    }
    return false;
}

std::span<const FileKind> file_kinds() {
    static const std::vector<FileKind> kinds = all_kinds();
    return kinds;
}

const FileKind* kind_of(std::string_view name) {
    const auto at =
        std::ranges::find_if(file_kinds(), [&](const FileKind& k) { return fits(name, k.pattern); });
    return at == file_kinds().end() ? nullptr : &*at;
}

std::optional<Stage> stage_of(const FileKind& kind, std::string_view name) {
    return kind.stage == Stage::granular && name.starts_with("points/") ? Stage::scan : kind.stage;
}

const ColumnInfo* column_of(const FileKind& kind, std::string_view name) {
    const auto at =
        std::ranges::find_if(kind.columns, [&](const ColumnInfo& c) { return fits(name, c.name); });
    return at == kind.columns.end() ? nullptr : &*at;
}

} // namespace rodwake::app
