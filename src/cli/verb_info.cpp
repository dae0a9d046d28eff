#include "dem_checkpoint.hpp"
#include "rodwake/core/build_info.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/scene/document.hpp"
#include "rodwake/store/hdf5_listing.hpp"
#include "rodwake/store/run_directory.hpp"
#include "verbs.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <iterator>

namespace rodwake::cli {

namespace {

namespace fs = std::filesystem;

int print_versions() {
    const BuildInfo build = build_info();
    fmt::print("rodwake   {} ({})\ncompiler  {}\nbuild     {}\n", build.version, build.git, build.compiler,
               build.flags);
    for (const auto& [name, version] : build.libraries)
        fmt::print("{:<14} {}\n", name, version);
    fmt::print("cpu       {}\nfeatures  {}\n", cpu_model(), fmt::join(cpu_features(), " "));
    return 0;
}

void print_file(const fs::path& path) {
    std::ifstream file(path);
    fmt::print("{}", std::string(std::istreambuf_iterator<char>(file), {}));
}

int describe_run(const fs::path& folder) {
    const std::string status = store::run_status(folder);
    if (status.empty())
        throw InputError(folder.string() + ": holds no rodwake run (no provenance.json)");
    fmt::print("{}: {} run\n", folder.string(), status);
    for (const char* name : {"provenance.json", "outcome.json", "summary.json", "measure.json"})
        if (fs::exists(folder / name)) {
            fmt::print("\n{}\n", name);
            print_file(folder / name);
        }
    if (fs::exists(folder / "result.h5"))
        fmt::print("\nresult.h5\n{}", store::list_hdf5(folder / "result.h5"));
    return 0;
}

void describe_checkpoint(const fs::path& file) {
    const auto loaded = load_checkpoint(file);
    const DemCheckpoint& c = loaded->checkpoint;
    fmt::print("{}: checkpoint of a granular run by rodwake {}\n{}run {}, seed {}, step {}, {} beads, {} "
               "rods, state {:016x}\n\n{}",
               file.string(), c.build, loaded->notice.empty() ? "" : loaded->notice + "\n", c.run + 1, c.seed,
               c.state.step, c.state.beads.size(), c.state.rods.size(), granular::state_hash(c.state),
               c.scene);
}

int describe_file(const fs::path& file) {
    const std::string ending = file.extension().string();
    if (ending == ".rwc")
        describe_checkpoint(file);
    else if (ending == ".json" || ending == ".csv" || ending == ".toml" || ending == ".txt")
        print_file(file);
    else
        fmt::print("{}", store::list_hdf5(file));
    return 0;
}

} // namespace

int verb_info(const Options& options) {
    if (options.scene_reference) {
        fmt::print("{}", scene::scene_reference());
        return 0;
    }
    if (options.target.empty())
        return print_versions();
    if (!fs::exists(options.target))
        throw InputError(options.target + ": no such file or folder");
    if (fs::is_directory(options.target))
        return describe_run(options.target);
    return describe_file(options.target);
}

} // namespace rodwake::cli
