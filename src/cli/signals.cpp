#include "signals.hpp"

#include <csignal>
#include <cstdlib>

namespace rodwake::cli {

namespace {

// A handler can reach nothing but a global; this is the only one.
volatile std::sig_atomic_t requested = 0;

void request_stop(int signal) {
    if (requested)
        std::_Exit(signal_exit_code(signal));
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
