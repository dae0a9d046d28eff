#pragma once
// SIGUSR1 asks for a checkpoint. Ctrl-C and SIGTERM ask the running stage to stop at its next step; a second
// one ends the program at once. A file beyond the system's limit is a failed write, not an end without a
// word.

namespace rodwake::cli {

void install_signal_handlers();

/// 0, or the number of the signal that asked to stop.
int stop_signal();

/// How often SIGUSR1 asked for a checkpoint; every run compares it with what it has seen.
int checkpoint_requests();

/// 128 + signal: 130 for SIGINT, 143 for SIGTERM.
int signal_exit_code(int signal);

} // namespace rodwake::cli
