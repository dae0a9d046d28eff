#include "signals.hpp"

#include <future>

namespace rodwake::python {

namespace py = pybind11;

namespace {

bool has_ended(const std::future<void>& done) {
    const py::gil_scoped_release release;
    return done.wait_for(std::chrono::milliseconds(50)) == std::future_status::ready;
}

} // namespace

void attended(const std::function<void()>& work, const std::function<void()>& attend,
              const std::function<void()>& stop) {
    std::future<void> done = std::async(std::launch::async, work);
    std::exception_ptr raised;
    const auto guarded = [&](const auto& act) {
        try {
            act();
        } catch (...) {
            raised = std::current_exception();
            stop();
        }
    };
    while (!has_ended(done))
        if (!raised) // of several the first
            guarded([&] {
                if (PyErr_CheckSignals() != 0)
                    throw py::error_already_set();
                attend();
            });
    if (raised)
        std::rethrow_exception(raised);
    if (PyErr_CheckSignals() != 0) // goes before an error of workers that the same signal ended
        throw py::error_already_set();
    done.get();
    attend(); // what was reported last
}

} // namespace rodwake::python
