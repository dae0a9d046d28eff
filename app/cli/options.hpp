#pragma once
// The command line, parsed.

#include "rodwake/app/convert.hpp"
#include "rodwake/app/replay.hpp"
#include "rodwake/scan/run.hpp"

#include <CLI/CLI.hpp>

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace rodwake::cli {

enum class Verb {
    scenes,
    new_scene,
    check,
    field,
    rods,
    dem,
    impact,
    measure,
    fit,
    scan,
    tradeoff,
    design,
    run,
    camera,
    convert,
    replay,
    explore,
    plot,
    info,
    help
};

struct Options {
    Verb verb = Verb::check;
    std::string target;                 ///< scene, run directory, file or verb that the verb works on
    std::string output;                 ///< -o; empty: results/<name of the scene>
    std::vector<std::string> overrides; ///< -s table.key=value
    std::size_t threads = 0;            ///< -j; 0: one for each core
    std::optional<std::uint64_t> seed;  ///< --seed; absent: that of the scene
    bool dry_run = false, quiet = false, verbose = false, force = false;
    std::string json_log; ///< --log-json FILE
    std::string command;  ///< the whole line, as a shell takes it
    // verb-specific
    std::map<std::string, std::string>
        answers;                      ///< new, tradeoff, design, camera: by option; empty: not given
    std::vector<std::string> vary;    ///< design --vary
    std::string points;               ///< field --points; "-": standard input
    std::string backend = "exact";    ///< field --backend
    double table_tolerance = 1e-8;    ///< field --table-tolerance
    std::string cases;                ///< impact --cases; "-": standard input
    std::string part;                 ///< scan --part i/n
    bool merge = false;               ///< scan --merge
    bool rerun_failed = false;        ///< scan --rerun-failed
    bool no_figures = false;          ///< run --no-figures
    app::ConvertRequest convert;      ///< convert; its files are target and output
    std::string format;               ///< convert --format; empty: automatic
    std::vector<std::string> columns; ///< convert --column, "id=NAME"
    app::ReplayRequest replay;        ///< replay --from, --to, --frames
    bool verify = false;              ///< replay --verify
    bool pdf = false;                 ///< plot --pdf
    bool scene_reference = false;     ///< info --scene-reference
    bool figure_reference = false;    ///< info --figure-reference
    bool file_reference = false;      ///< info --file-reference
    bool schema = false;              ///< info --schema
    bool man = false;                 ///< info --man
    std::string completion;           ///< info --completion
    // look of the figures, as the plotting program takes it
    std::string figure_width; ///< plot --width; empty: each its own
    std::string figure_style; ///< plot --style; empty: paper
    std::string font_size;    ///< plot --font-size, pt; empty: of the style
    bool film = false;        ///< plot --film
    bool overlay = false;     ///< plot --overlay
};

/// Result of parsing: either options to act on, or an exit code (help, version, usage error; the text is
/// printed).
struct Parsed {
    Options options;
    bool exit_now = false;
    int exit_code = 0;
};
/// --part i/n, i from 1; nothing without.
std::optional<scan::Part> part_of(const Options& options);

/// -o, or results/<scene name>; of a share of a scan part-i-of-n below it.
std::filesystem::path output_folder(const Options& options);

Parsed parse_command_line(int argc, const char* const* argv);

/// Null if there is no verb of this name.
const CLI::App* find_verb(const CLI::App& app, const std::string& name);

/// `rnu: no such verb (did you mean "run"?)`
CLI::ValidationError unknown_verb(const CLI::App& app, const std::string& word);

/// Throws CLI::ValidationError for what CLI11 would read otherwise than it was meant, or not tell: a verb
/// that does not exist, a long option with one dash (-output is -o utput).
void refuse_misread_words(const CLI::App& app, std::span<const std::string> words);

/// What to print for an error of parsing: an unknown option comes before all else, since the rest may follow
/// from it.
std::string usage_text(const CLI::App& app, const CLI::ParseError& error);

} // namespace rodwake::cli
