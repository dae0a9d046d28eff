#pragma once
// Values on the command line: what is wrong with a word that is none of the legal ones.

#include <CLI/CLI.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace rodwake::cli {

/// "two is not a number", "1e400 is too large for a number, which ends at 1.8e308", "-1 is not from 0 to 1".
CLI::Validator number_from(double low, double high);

/// "1.5 is not a whole number from 1 to 1024".
CLI::Validator whole_number_from(std::uint64_t low, std::uint64_t high);

/// "pth is none of final_state, path (did you mean "path"?)".
CLI::Validator one_of(const std::vector<std::string>& legal);

/// Turns "5ms", "5 ms" and "0.005" into 0.005; "soon is not a time such as 5ms, 2s or 1min".
CLI::Validator seconds();

} // namespace rodwake::cli
