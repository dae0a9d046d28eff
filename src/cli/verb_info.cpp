#include "definition.hpp"
#include "describe_file.hpp"
#include "rodwake/assembly/schema.hpp"
#include "rodwake/core/build_info.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/scene/document.hpp"
#include "rodwake/stages/run.hpp"
#include "rodwake/stages/run_folder.hpp"
#include "rodwake/store/hdf5_reader.hpp"
#include "verbs.hpp"

#include <fmt/format.h>

#include <filesystem>

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

int describe_run(const fs::path& folder) {
    const std::string status = stages::run_status(folder);
    if (status.empty())
        throw InputError(folder.string() + ": holds no rodwake run (no provenance.json)");
    fmt::print("{}: {} run\n", folder.string(), status);
    const std::vector<stages::FileEntry> files = stages::files_of_run(folder);
    for (const stages::FileEntry& file : files)
        fmt::print("  {:<40} {}\n", file.name, file.what);
    for (const stages::FileEntry& file : files)
        if (file.name.ends_with(".json") && file.name.find('/') == std::string::npos &&
            file.name != "manifest.json" && !file.progress) {
            fmt::print("\n{}\n", file.name);
            fmt::print("{}", file_text(folder / file.name));
        }
    if (fs::exists(folder / "ledger.sqlite") && !fs::exists(folder / "scan.json"))
        fmt::print("\nledger.sqlite\n{}", file_text(folder / "ledger.sqlite"));
    if (fs::exists(folder / "result.h5"))
        fmt::print("\nresult.h5\n{}", store::list_hdf5(folder / "result.h5"));
    return 0;
}

/// The manual page or a completion script.
int print_of_definition(const Options& options) {
    Options unused;
    CLI::App app("", "rodwake");
    define_command_line(app, unused);
    fmt::print("{}", options.man                   ? man_page(app)
                     : options.completion == "zsh" ? zsh_completion(app)
                                                   : bash_completion(app));
    return 0;
}

} // namespace

int verb_info(const Options& options) {
    if (options.scene_reference) {
        fmt::print("{}", scene::scene_reference());
        return 0;
    }
    if (options.schema) {
        fmt::print("{}", assembly::schema_json());
        return 0;
    }
    if (options.man || !options.completion.empty())
        return print_of_definition(options);
    if (options.target.empty())
        return print_versions();
    if (!fs::exists(options.target))
        throw InputError(options.target + ": no such file or folder");
    if (fs::is_directory(options.target))
        return describe_run(options.target);
    fmt::print("{}", file_text(options.target));
    return 0;
}

} // namespace rodwake::cli
