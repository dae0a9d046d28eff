#include "signals.hpp"

#include <csignal>
#include <cstdlib>
#include <ctime>

namespace rodwake::cli {

namespace {

// A handler can reach nothing but globals; these are the only ones.
volatile std::sig_atomic_t requested = 0;
volatile std::sig_atomic_t checkpoint_requested = 0; // how often
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

void request_checkpoint(int) { checkpoint_requested = checkpoint_requested + 1; }

} // namespace

void install_signal_handlers() {
    std::signal(SIGINT, request_stop);
    std::signal(SIGTERM, request_stop);
    std::signal(SIGUSR1, request_checkpoint);
    std::signal(SIGCHLD, SIG_DFL); // whoever started us may ignore it, and then no child tells how it ended
    std::signal(SIGXFSZ, SIG_IGN); // a write beyond the limit fails and says so
}

int checkpoint_requests() { return checkpoint_requested; }

int stop_signal() { return requested; }

int signal_exit_code(int signal) { return 128 + signal; }

} // namespace rodwake::cli
