#pragma once
// The one definition of the command line. What `rodwake new` asks is part of it: its options answer the
// questions.

#include "options.hpp"

#include <CLI/CLI.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace rodwake::cli {

/// Adds every verb and option; what is parsed goes into `options`, which must outlive the parsing.
void define_command_line(CLI::App& app, Options& options);

struct Question {
    std::string option;   ///< "--rods"
    std::string kinds;    ///< of scenes that need the answer, "rods bed"; empty: all
    std::string text;     ///< what is asked
    std::string fallback; ///< the answer to an empty line
    CLI::Validator legal;

    bool is_for(const std::string& kind) const {
        return kinds.empty() || (" " + kinds + " ").find(" " + kind + " ") != std::string::npos;
    }
};

/// The kind of scene first; two more of each kind.
std::vector<Question> new_scene_questions();

// What follows from the definition.

/// "-o", "--output" of an option; nothing of a positional one.
std::vector<std::string> option_names(const CLI::Option& option);

/// Those of all options of a verb.
std::vector<std::string> option_names(const CLI::App& verb);

bool takes_value(const CLI::Option& option);

std::string exit_codes_text();

/// rodwake(1), and the scripts that complete command lines.
std::string man_page(const CLI::App& app);
std::string bash_completion(const CLI::App& app);
std::string zsh_completion(const CLI::App& app);

// Values on the command line: what is wrong with a word that is none of the legal ones.

/// "two is not a number", "1e400 is too large for a number, which ends at 1.8e308", "-1 is not from 0 to 1".
CLI::Validator number_from(double low, double high);

/// "1.5 is not a whole number from 1 to 1024".
CLI::Validator whole_number_from(std::uint64_t low, std::uint64_t high);

/// "pth is none of final_state, path (did you mean "path"?)".
CLI::Validator one_of(const std::vector<std::string>& legal);

/// Turns "5ms", "5 ms" and "0.005" into 0.005; "soon is not a time such as 5ms, 2s or 1min".
CLI::Validator seconds();

} // namespace rodwake::cli
