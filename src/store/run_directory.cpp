#include "rodwake/store/run_directory.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/store/atomic_file.hpp"

#include <nlohmann/json.hpp>

#include <fstream>

namespace rodwake::store {

namespace fs = std::filesystem;

namespace {

bool has_files(const fs::path& folder) {
    std::error_code error;
    return fs::directory_iterator(folder, error) != fs::directory_iterator{};
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

} // namespace

std::string run_status(const fs::path& folder) {
    std::ifstream file(folder / "provenance.json");
    const auto json = nlohmann::json::parse(file, nullptr, false);
    return json.is_object() ? json.value("status", std::string()) : std::string();
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
    resumed_ = !status.empty() && status != "finished";
}

void RunDirectory::write(std::string_view name, std::string_view content) const {
    const fs::path target = path_ / name;
    std::error_code error;
    fs::create_directories(target.parent_path(), error);
    write_atomically(target, content);
}

} // namespace rodwake::store
