#pragma once
// What is wrong with a command line, in words that name the offending word and only it.

#include <CLI/CLI.hpp>

#include <span>
#include <string>

namespace rodwake::cli {

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
