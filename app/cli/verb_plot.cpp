// rodwake plot, and the figures at the end of rodwake run: the plotting program, run on a folder of results.

#include "rodwake/app/child_program.hpp"
#include "rodwake/app/explore.hpp"
#include "rodwake/app/run.hpp"
#include "rodwake/app/run_folder.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/store/atomic_file.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <vector>

namespace rodwake::cli {

namespace {

namespace fs = std::filesystem;

constexpr int usage_error = 2; ///< of the plotting program

/// Where the explorer shows what ran, its page goes beside the report, which then speaks of it. Of scans
/// scan.html computes; a scene that is not readable is for the plotting program to tell.
void write_explorer(const fs::path& folder, bool quiet) {
    std::optional<scene::Scene> scene;
    try {
        scene = scene::read_scene(folder / "scene.toml");
    } catch (const InputError&) {
        return;
    }
    if (scene->scan || !scene->rods_run)
        return;
    if (const std::vector<std::string> left = app::left_out_by_explorer(*scene); !left.empty()) {
        if (!quiet && scene->rods.size() == 2)
            fmt::print("no {}: {}\n", app::explorer_file, left.front());
        return;
    }
    const std::string name = fs::absolute(folder).lexically_normal().filename().string();
    const std::string page =
        app::explorer_page(shipped_folder() / "explorer", app::ExplorerStart{*scene, name});
    std::ifstream in(folder / app::explorer_file, std::ios::binary);
    if (!in || !std::equal(std::istreambuf_iterator<char>(in), {}, page.begin(), page.end())) // another page
        store::write_atomically(folder / app::explorer_file, page);
}

} // namespace

void make_figures(const fs::path& run_directory, bool pdf, bool quiet,
                  const std::vector<std::string>& looks) {
    std::vector<std::string> command = {RODWAKE_FIGURES_PYTHON,
                                        (shipped_folder() / "plots" / "rodwake_plot.py").string()};
    if (pdf)
        command.emplace_back("--pdf");
    if (quiet)
        command.emplace_back("--quiet");
    command.insert(command.end(), looks.begin(), looks.end());
    command.insert(command.end(), {"--", run_directory.string()}); // a folder "-x" is no option
    const bool elsewhere =
        std::ranges::any_of(looks, [](const auto& look) { return look.starts_with("--output="); });
    if (!elsewhere)
        write_explorer(run_directory, quiet);
    const int code = app::run_child(command,
                                    "figures need python3 with matplotlib and h5py (tools/quickstart "
                                    "--deps-only or pip installs them)",
                                    [] { return stop_signal() != 0; })
                         .code;
    if (code == usage_error && !looks.empty()) // Python itself ends with that code, too
        throw InputError("nothing was drawn (see above)");
    if (code != 0 && !stop_signal())
        throw RunError(fmt::format("the figures could not be made (see above); the results themselves are in "
                                   "{0}, and rodwake plot {0} tries again",
                                   run_directory.string()));
    if (!elsewhere)
        app::write_manifest(run_directory);
}

int verb_plot(const Options& options) {
    fs::path folder = options.target;
    if (folder.filename() == "result.h5")
        folder = folder.has_parent_path() ? folder.parent_path() : ".";
    if (!fs::is_directory(folder))
        throw InputError(options.target + ": not a run directory; rodwake run SCENE makes one");
    const char* others[] = {"tradeoff.json", "ways.json", "design.json"}; // of commands that are no runs
    if (app::run_status(folder).empty() &&
        std::ranges::none_of(others, [&](const char* name) { return fs::exists(folder / name); }))
        throw InputError(folder.string() + ": holds no rodwake run (no provenance.json)");
    if (options.dry_run)
        return 0; // there is something to draw; that is all there is to say
    // The plotting program checks the values of these options.
    std::vector<std::string> looks;
    if (!options.figure_width.empty())
        looks.push_back("--width=" + options.figure_width);
    if (!options.figure_style.empty())
        looks.push_back("--style=" + options.figure_style);
    if (!options.font_size.empty())
        looks.push_back("--font-size=" + options.font_size);
    if (options.overlay)
        looks.emplace_back("--overlay");
    if (options.film)
        looks.emplace_back("--film");
    if (!options.output.empty())
        looks.push_back("--output=" + options.output);
    make_figures(folder, options.pdf, options.quiet, looks);
    return stop_signal() ? signal_exit_code(stop_signal()) : 0;
}

} // namespace rodwake::cli
