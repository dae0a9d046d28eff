#include "signals.hpp"

#include <csignal>
#include <cstdlib>
#include <ctime>

namespace rodwake::cli {

namespace {

// A handler can reach nothing but a global; this is the only one.
volatile std::sig_atomic_t requested = 0;
volatile std::time_t requested_at = 0;

/// A second signal ends the program at once, but not within a second of the first: terminals and `timeout`
/// signal both a program and its group.
void request_stop(int signal) {
    const std::time_t now = std::time(nullptr); // async-signal-safe
    if (requested && now - requested_at > 1)
        std::_Exit(signal_exit_code(signal));
    if (!requested)
        requested_at = now;
    requested = signal;
}

} // namespace

void install_signal_handlers() {
    std::signal(SIGINT, request_stop);
    std::signal(SIGTERM, request_stop);
    std::signal(SIGUSR1, SIG_IGN); // asks for a checkpoint and to go on: the stages write them on their own
}

int stop_signal() { return requested; }

int signal_exit_code(int signal) { return 128 + signal; }

} // namespace rodwake::cli
