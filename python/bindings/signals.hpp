#pragma once
// Ctrl-C while the library works. Python runs its signal handlers on its main thread only, and only when
// asked.

#include <pybind11/pybind11.h>

#include <chrono>
#include <exception>
#include <functional>

namespace rodwake::python {

/// For work on the thread that was called from Python, with the interpreter released. Polled once a step:
/// asks Python now and then, so that a step costs nothing.
class Interrupt {
public:
    explicit Interrupt(unsigned polls_a_look = 16) : polls_a_look_(polls_a_look) {}

    bool operator()() {
        if (++polls_ % polls_a_look_ != 0 || Clock::now() < next_)
            return raised_;
        next_ = Clock::now() + std::chrono::milliseconds(50);
        const pybind11::gil_scoped_acquire acquire;
        raised_ = raised_ || PyErr_CheckSignals() != 0; // sets KeyboardInterrupt
        return raised_;
    }
    /// With the interpreter: throws what a signal handler raised.
    void rethrow() const {
        if (raised_)
            throw pybind11::error_already_set();
    }

private:
    using Clock = std::chrono::steady_clock;
    unsigned polls_a_look_; ///< the clock is not free either
    unsigned polls_ = 0;
    Clock::time_point next_ = Clock::now() + std::chrono::milliseconds(50);
    bool raised_ = false;
};

/// Does `work` on a thread of its own. This one, which has the interpreter, meanwhile lets signals through
/// and calls `attend` some ten times a second. What either raises calls `stop`, and is thrown once work has
/// ended.
void attended(const std::function<void()>& work, const std::function<void()>& attend,
              const std::function<void()>& stop);

} // namespace rodwake::python
