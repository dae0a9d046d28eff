// rodwake explore: a page that computes wakes and encounters in a browser.

#include "rodwake/app/explore.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/store/atomic_file.hpp"
#include "verbs.hpp"

#include <fmt/format.h>

#include <filesystem>

namespace rodwake::cli {

int verb_explore(const Options& options) {
    namespace fs = std::filesystem;
    const fs::path page = options.output.empty() ? "explore.html" : options.output;
    if (fs::is_directory(page))
        throw InputError(fmt::format("{}: is a folder; -o names the page, such as {}", page.string(),
                                     (page / "explore.html").string()));
    std::optional<app::ExplorerStart> start;
    if (!options.target.empty())
        start = {scene_of(options), fs::path(options.target).stem().string()};
    const std::string text = app::explorer_page(shipped_folder() / "explorer", start);
    if (fs::exists(page) && !options.force)
        throw InputError(fmt::format("{}: already exists; --force replaces it, or name another file with -o",
                                     page.string()));
    store::write_atomically(page, text);
    if (options.quiet)
        return 0;
    fmt::print("{}: {} kB; open it in a browser, no network is needed\n", page.string(), text.size() / 1000);
    return 0;
}

} // namespace rodwake::cli
