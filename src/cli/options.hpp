#pragma once
// The command line, parsed.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace rodwake::cli {

enum class Verb { check, field, rods, dem, impact, measure, fit, run, plot, info };

struct Options {
    Verb verb = Verb::check;
    std::string target;                 ///< scene, run directory or file the verb works on
    std::string output;                 ///< -o; empty: results/<name of the scene>
    std::vector<std::string> overrides; ///< -s table.key=value
    std::size_t threads = 1;            ///< -j
    std::optional<std::uint64_t> seed;  ///< --seed; absent: that of the scene
    bool dry_run = false, quiet = false, verbose = false, force = false;
    std::string json_log; ///< --log-json FILE
    std::string command;  ///< the whole line, for provenance
    // verb-specific
    std::string points;            ///< field --points
    std::string backend = "exact"; ///< field --backend
    double table_tolerance = 1e-8; ///< field --table-tolerance; only for the backend table
    std::string cases;             ///< impact --cases
    bool pdf = false;              ///< plot --pdf
    bool scene_reference = false;  ///< info --scene-reference
};

/// Result of parsing: either options to act on, or an exit code (help, version, usage error; the text is
/// printed).
struct Parsed {
    Options options;
    bool exit_now = false;
    int exit_code = 0;
};
Parsed parse_command_line(int argc, const char* const* argv);

} // namespace rodwake::cli
