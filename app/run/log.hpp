#pragma once
// Where the messages of a run go: to the caller, and to log.txt of the run directory.

#include "rodwake/app/run_context.hpp"

#include <spdlog/logger.h>

#include <filesystem>
#include <memory>

namespace rodwake::app {

using Logger = std::shared_ptr<spdlog::logger>;

/// Throws RunError if the file cannot be opened.
Logger make_logger(const RunContext& context, const std::filesystem::path& run_log);

/// For ranks, whose messages come home with their results.
Logger make_silent_logger();

} // namespace rodwake::app
