#include "rodwake/store/run_directory.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/store/atomic_file.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <fstream>
#include <span>
#include <string_view>
#include <vector>

namespace rodwake::store {

namespace fs = std::filesystem;

namespace {

/// Left behind by a run that was killed: see PendingFile.
bool is_temporary(const std::string& name) {
    const auto end = name.rfind(".tmp");
    return end != std::string::npos && end + 4 < name.size() &&
           name.find_first_not_of("0123456789", end + 4) == std::string::npos;
}

/// A run that was killed before its first file was in place.
bool is_stillborn(const fs::path& file) {
    const std::string name = file.filename().string();
    return name.starts_with("provenance.json.") && is_temporary(name);
}

bool has_files(const fs::path& folder) {
    std::error_code error;
    const fs::directory_iterator entries(folder, error);
    return std::any_of(begin(entries), end(entries),
                       [](const auto& entry) { return !is_stillborn(entry.path()); });
}

void refuse_foreign(const fs::path& path, const std::string& status) {
    if (status == "finished")
        throw InputError(path.string() +
                         ": holds a finished run; choose another folder with -o, or --force to replace it");
    if (status.empty() && has_files(path))
        throw InputError(
            path.string() +
            ": holds files that are not a rodwake run; choose another folder with -o, or --force to "
            "write among them");
}

bool is_one_of(const fs::path& file, std::span<const std::string_view> names) {
    return std::ranges::find(names, file.filename().string()) != names.end();
}

/// What a granular run leaves when it has finished; one that is taken up keeps it.
bool is_of_finished_bed(const fs::path& file) {
    static constexpr std::array<std::string_view, 8> names = {
        "summary.json",    "runs.csv",       "table.csv",        "tracks.csv",
        "trajectory.h5md", "trajectory.xyz", "last_period.h5md", "final.rwc"};
    return is_one_of(file, names) || file.filename() == "measure.rwc";
}

/// What the measure stage makes.
bool is_measure(const fs::path& file) {
    static constexpr std::array<std::string_view, 10> names = {
        "measure.json",  "measure.h5", "gr.csv",    "gB.csv",           "msd.csv",
        "stiffness.csv", "marked.csv", "pairs.csv", "displacement.vti", "flow.vti"};
    const std::string name = file.filename().string();
    return is_one_of(file, names) || name == "series.csv" || name == "series.json" ||
           (name.starts_with("profile_") && name.ends_with(".csv"));
}

/// What the fit stage makes.
bool is_fit(const fs::path& file) {
    static constexpr std::array<std::string_view, 3> names = {"fit.json", "fit.txt", "medium.json"};
    static constexpr std::array<std::string_view, 3> tables = {"fit_profile_", "fit_curve_",
                                                               "fit_trajectory_"};
    const std::string name = file.filename().string();
    return is_one_of(file, names) ||
           (name.ends_with(".csv") &&
            std::ranges::any_of(tables, [&](const auto& start) { return name.starts_with(start); }));
}

bool is_result(const fs::path& file) {
    static constexpr std::array<std::string_view, 4> names = {"result.h5", "rods.csv", "outcome.json",
                                                              "report.html"};
    const std::string name = file.filename().string();
    return is_one_of(file, names) || is_measure(file) || is_fit(file) ||
           (name.starts_with("field_cut_") && name.ends_with(".csv")) || is_temporary(name) ||
           file.parent_path().filename() == "figures";
}

/// What a granular run goes on from: its checkpoints, and logs that mean nothing without them; and the starts
/// of a fit.
bool is_progress(const fs::path& file) {
    static constexpr std::array<std::string_view, 6> names = {"checkpoint.rwc",  "checkpoint.rwc.previous",
                                                              "rows.log",        "frames.log",
                                                              "last_period.log", "fit_starts.log"};
    return is_one_of(file, names);
}

/// `anew`: nothing of the earlier run is gone on from.
std::vector<fs::path> outdated(const fs::path& folder, bool anew) {
    std::vector<fs::path> old;
    const auto add = [&](const auto& entries) {
        for (const fs::directory_entry& entry : entries)
            if (entry.is_regular_file() &&
                (is_result(entry.path()) ||
                 (anew && (is_progress(entry.path()) || is_of_finished_bed(entry.path())))))
                old.push_back(entry.path());
    };
    add(fs::directory_iterator(folder));
    for (const char* sub : {"figures", "variants", "runs"})
        if (fs::is_directory(folder / sub))
            add(fs::recursive_directory_iterator(folder / sub));
    return old;
}

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

/// A new run removes the results of the old one, so that no file of a folder tells of another run. A run that
/// is taken up keeps what it goes on from, which includes the members of an ensemble that are finished. The
/// rods' checkpoints always stay: whoever wrote them knows whether they are of use.
void remove_results(const fs::path& folder, bool anew) {
    std::error_code error;
    for (const fs::path& path : outdated(folder, anew))
        if (fs::remove(path, error); error)
            throw RunError(path.string() +
                           ": cannot remove this result of the earlier run: " + error.message());
    if (anew)
        remove_empty_runs(folder / "runs");
}

} // namespace

std::string run_status(const fs::path& folder) {
    std::ifstream file(folder / "provenance.json");
    const auto json = nlohmann::json::parse(file, nullptr, false);
    if (!json.is_object() || !json.contains("status") || !json["status"].is_string())
        return {};
    return json["status"];
}

RunDirectory::RunDirectory(fs::path path, bool force) : path_(std::move(path)) {
    std::error_code error;
    if (fs::exists(path_, error) && !fs::is_directory(path_, error))
        throw InputError(path_.string() + ": is a file; -o names the folder for the results");
    const std::string status = run_status(path_);
    if (!force)
        refuse_foreign(path_, status);
    fs::create_directories(path_, error);
    if (error)
        throw RunError(path_.string() + ": cannot make the folder: " + error.message());
    resumed_ = !force && !status.empty() && status != "finished";
    had_run_ = !status.empty();
}

void RunDirectory::begin(std::string_view provenance) const {
    write("provenance.json", provenance);
    for (const fs::directory_entry& entry : fs::directory_iterator(path_))
        if (std::error_code ignored; is_stillborn(entry.path()))
            fs::remove(entry.path(), ignored);
    if (had_run_)
        remove_results(path_, !resumed_);
}

void RunDirectory::write(std::string_view name, std::string_view content) const {
    const fs::path target = path_ / name;
    std::error_code error;
    fs::create_directories(target.parent_path(), error);
    write_atomically(target, content);
}

} // namespace rodwake::store
