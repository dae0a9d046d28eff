// rodwake scenes: lists the scenes that are shipped, prints one, or copies them all with the data they read.

#include "rodwake/core/error.hpp"
#include "rodwake/core/spelling.hpp"
#include "rodwake/scene/read.hpp"
#include "verbs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <utility>
#include <vector>

namespace rodwake::cli {

namespace {

namespace fs = std::filesystem;

/// Folders below the shipped one that `scenes -o` copies. The names of scenes leave "scenes/" out.
constexpr const char* copied_folders[] = {"scenes", "fitting/problems", "fitting/data"};
constexpr std::string_view scenes_prefix = "scenes/";

std::string text_of(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::string text(std::istreambuf_iterator<char>(file), {});
    if (!file.is_open() || file.bad())
        throw RunError(path.string() + ": cannot be read; install rodwake anew");
    return text;
}

/// Scenes by the name they are asked for: "pair", "fitting/problems/monopole".
std::map<std::string, fs::path> scene_files() {
    std::map<std::string, fs::path> files;
    for (const fs::path folder : {"scenes", "fitting/problems"}) {
        std::error_code error;
        for (const auto& entry : fs::directory_iterator(shipped_folder() / folder, error))
            if (entry.path().extension() == ".toml") {
                const std::string name = (folder / entry.path().stem()).string();
                files[name.starts_with(scenes_prefix) ? name.substr(scenes_prefix.size()) : name] =
                    entry.path();
            }
        if (error)
            throw RunError((shipped_folder() / folder).string() + ": no shipped scenes: " + error.message());
    }
    return files;
}

int list() {
    const auto files = scene_files();
    for (const bool of_fits : {false, true})
        for (const auto& [name, path] : files)
            if (name.starts_with("fitting/") == of_fits) {
                // The description is the comment that a scene begins with.
                std::istringstream lines(text_of(path));
                std::string text, out, shown = "   ";
                for (std::string line; std::getline(lines, line) && line.starts_with("# ");)
                    text += (text.empty() ? "" : " ") + line.substr(2);

                // Its words go into indented lines of at most 78 characters.
                std::istringstream words(text);
                for (std::string word; words >> word;) {
                    if (shown.size() + 1 + word.size() > 78)
                        out += std::exchange(shown, "   ") + "\n";
                    shown += " " + word;
                }
                fmt::print("{}\n{}{}\n", name, out, shown);
            }
    fmt::print(
        "\nrodwake scenes pair > my.toml prints one; rodwake scenes -o . copies all, with the data of the "
        "fits.\n");
    return 0;
}

int print(std::string name) {
    if (name.ends_with(".toml"))
        name.resize(name.size() - 5);
    if (name.starts_with(scenes_prefix))
        name.erase(0, scenes_prefix.size());
    const auto files = scene_files();
    const auto found = files.find(name);
    if (found == files.end()) {
        std::vector<std::string_view> known;
        std::ranges::transform(files, std::back_inserter(known),
                               [](const auto& file) { return std::string_view(file.first); });
        throw InputError(fmt::format("{}: no such scene is shipped{}; rodwake scenes lists them", name,
                                     did_you_mean(name, known)));
    }
    fmt::print("{}", text_of(found->second));
    return 0;
}

} // namespace

fs::path shipped_folder() {
    std::error_code error;
    const fs::path program = fs::read_symlink("/proc/self/exe", error);
    const fs::path installed = program.parent_path().parent_path() / "share" / "rodwake";
    return !error && fs::is_directory(installed, error)
               ? installed
               : (program.parent_path() / RODWAKE_UNINSTALLED).lexically_normal();
}

scene::Scene scene_of(const Options& options) {
    const fs::path path = options.target;
    if (!fs::exists(path) && fs::exists(shipped_folder() / scenes_prefix / (path.stem().string() + ".toml")))
        throw InputError(
            fmt::format("{}: no such file; rodwake scenes -o . copies the shipped scenes into this "
                        "folder, rodwake scenes {} prints this one",
                        options.target, path.stem().string()));
    return scene::read_scene(path, options.overrides);
}

int verb_scenes(const Options& options) {
    if (!options.output.empty()) {
        // Files as they are to stand below the target, with what they are copied from.
        std::map<fs::path, fs::path> from;
        for (const char* folder : copied_folders)
            for (const auto& entry : fs::directory_iterator(shipped_folder() / folder))
                if (entry.is_regular_file())
                    from[fs::path(options.output) / folder / entry.path().filename()] = entry.path();
        std::erase_if(from, [](const auto& file) {
            return fs::exists(file.first) && text_of(file.first) == text_of(file.second);
        });
        for (const auto& [to, source] : from)
            if (!options.force && fs::exists(to))
                throw InputError(to.string() + ": already exists and differs from the shipped one; copy into "
                                               "another folder, or --force to replace it");
        for (const auto& [to, source] : from)
            try {
                fs::create_directories(to.parent_path());
                fs::copy_file(source, to, fs::copy_options::overwrite_existing);
            } catch (const fs::filesystem_error& error) {
                throw RunError(to.string() + ": cannot be written: " + error.code().message());
            }
        if (!options.quiet)
            fmt::print("{} files copied into {} and {}\n", from.size(),
                       (fs::path(options.output) / "scenes").string(),
                       (fs::path(options.output) / "fitting").string());
        return 0;
    }
    return options.target.empty() ? list() : print(options.target);
}

} // namespace rodwake::cli
