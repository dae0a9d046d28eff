#pragma once
// What a run shows and hears: messages and progress on standard error, a JSON-lines log on demand, signals.

#include "options.hpp"
#include "rodwake/app/run_context.hpp"

namespace rodwake::cli {

/// To standard error, without what a terminal would obey. That it is closed or full is nobody's failure.
void print_message(const std::string& text);

/// A library that runs out of memory where no exception may pass (a destructor) ends the program with a
/// message and exit code 1, as anywhere else, and not by abort.
void end_well_without_memory();

/// Standard input, output and error that are closed become /dev/null, so that no file takes their place.
void open_standard_streams();

/// The context of a command: its threads, --force and command line; messages and progress go to standard
/// error as --quiet and -v want them, and to --log-json; Ctrl-C and SIGTERM stop, SIGUSR1 asks for a
/// checkpoint. Throws RunError if the JSON log cannot be opened.
app::RunContext context_of(const Options& options);

void install_signal_handlers();

/// 0, or the number of the signal that asked to stop.
int stop_signal();

/// How often SIGUSR1 asked for a checkpoint; every run compares it with what it has seen.
int checkpoint_requests();

/// 128 + signal: 130 for SIGINT, 143 for SIGTERM.
int signal_exit_code(int signal);

} // namespace rodwake::cli
