// Which files of a folder are the run's own: what goes when its stages are done again, and what is not
// touched.

#include "catalogue.hpp"
#include "rodwake/app/run_folder.hpp"
#include "rodwake/core/error.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <fstream>

namespace rodwake::app {

namespace fs = std::filesystem;

namespace {

void remove_empty_runs(const fs::path& runs) {
    std::error_code ignored; // a folder with files of others stays
    std::vector<fs::path> folders;
    for (const fs::directory_entry& entry : fs::directory_iterator(runs, ignored))
        if (entry.is_directory() && !entry.is_symlink() && fs::is_empty(entry.path(), ignored))
            folders.push_back(entry.path());
    for (const fs::path& folder : folders)
        fs::remove(folder, ignored);
    if (fs::is_directory(runs, ignored) && fs::is_empty(runs, ignored))
        fs::remove(runs, ignored);
}

/// Files of a run are in its folder, in variants/<name>/ and models/<name>/, in points/<number>/, in
/// runs/<number>/ of each, and figures/.
std::vector<fs::path> files_of(const fs::path& folder) {
    std::vector<fs::path> files;
    const auto add = [&](const auto& entries) {
        for (const fs::directory_entry& entry : entries)
            if (entry.is_regular_file())
                files.push_back(entry.path());
    };
    add(fs::directory_iterator(folder));
    for (const std::string_view sub : own_folders)
        if (fs::is_directory(folder / sub))
            add(fs::recursive_directory_iterator(folder / sub));
    return files;
}

} // namespace

bool is_temporary(const std::string& name) {
    const auto end = name.rfind(".tmp");
    return end != std::string::npos && end + 4 < name.size() &&
           name.find_first_not_of("0123456789", end + 4) == std::string::npos;
}

void refuse_link(const fs::path& path) {
    if (fs::is_symlink(path))
        throw InputError(path.string() + ": is a link, and rodwake does not write through links: remove it, "
                                         "or choose another folder with -o");
}

/// Results that are kept may be links.
void RunFolder::refuse_links() const {
    const auto require = [&](const fs::directory_entry& entry) {
        const FileKind* kind = kind_of(entry.path().filename().string());
        const std::string name = entry.path().lexically_relative(path_).generic_string();
        const bool ours = kind ? kind->lifetime == Lifetime::progress || kind->lifetime == Lifetime::record ||
                                     is_outdated(*kind, name)
                               : entry.is_directory() && is_own(name + "/");
        if (ours)
            refuse_link(entry.path());
    };
    for (const fs::directory_entry& entry : fs::directory_iterator(path_))
        require(entry);
    for (const std::string_view sub : own_folders)
        if (fs::is_directory(path_ / sub))
            for (const fs::directory_entry& entry : fs::recursive_directory_iterator(path_ / sub))
                require(entry);
}

bool RunFolder::is_outdated(const FileKind& kind, const std::string& name) const {
    const std::optional<Stage> stage = stage_of(kind, name);
    if (!stage || (only_restores() && is_drawn(name)))
        return kind.lifetime == Lifetime::result && !only_restores();
    if (std::ranges::count(dropped_, *stage) > 0)
        return true;
    if (std::ranges::count(stages_, *stage) == 0)
        return false;
    const bool goes_on = !anew_ && old_.contains(to_string(*stage));
    return !goes_on || kind.lifetime == Lifetime::result;
}

void RunFolder::remove_outdated() const {
    std::error_code error;
    std::ifstream manifest_file(path_ / "manifest.json");
    const nlohmann::json manifest = nlohmann::json::parse(manifest_file, nullptr, false);
    for (const fs::path& file : files_of(path_)) {
        const std::string name = file.filename().string();
        const FileKind* kind = kind_of(name);
        const bool figure = !only_restores() && file.parent_path() == path_ / "figures" &&
                            manifest.is_object() && manifest.contains("files") &&
                            manifest["files"].contains("figures/" + name);
        const bool litter = is_temporary(name) && kind_of(name.substr(0, name.rfind(".tmp")));
        if (!litter &&
            !(had_run_ &&
              (figure || (kind && is_outdated(*kind, file.lexically_relative(path_).generic_string())))))
            continue;
        if (name == "result.h5" && keeps_datasets()) // it is replaced as a whole, with what is kept
            continue;
        if (fs::remove(file, error); error)
            throw RunError(file.string() +
                           ": cannot remove this result of the earlier run: " + error.message());
    }
    if (anew_) {
        remove_empty_runs(path_ / "runs");
        const fs::path points = path_ / "points";
        std::error_code ignored;
        std::vector<fs::path> folders;
        for (const fs::directory_entry& entry : fs::directory_iterator(points, ignored))
            folders.push_back(entry.path());
        for (const fs::path& folder : folders)
            remove_empty_runs(folder / "runs");
        folders.push_back(points);
        for (const fs::path& folder : folders)
            if (fs::is_directory(folder, ignored) && fs::is_empty(folder, ignored))
                fs::remove(folder, ignored);
    }
}

} // namespace rodwake::app
