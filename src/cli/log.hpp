#pragma once
// Where messages go: the terminal (standard error), log.txt of the run directory, and a JSON-lines file on
// demand.

#include "options.hpp"

#include <spdlog/logger.h>

#include <filesystem>
#include <memory>

namespace rodwake::cli {

using Logger = std::shared_ptr<spdlog::logger>;

/// Throws RunError if a log file cannot be opened. `run_log` empty: no log.txt.
Logger make_logger(const Options& options, const std::filesystem::path& run_log);

} // namespace rodwake::cli
