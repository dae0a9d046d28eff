#include "signals.hpp"

#include <future>

namespace rodwake::python {

namespace py = pybind11;

void attended(const std::function<void()>& work, const std::function<void()>& attend,
              const std::function<void()>& stop) {
    std::future<void> done = std::async(std::launch::async, work);
    std::exception_ptr raised;
    for (;;) {
        {
            const py::gil_scoped_release release;
            if (done.wait_for(std::chrono::milliseconds(50)) == std::future_status::ready)
                break;
        }
        if (raised) // of several the first
            continue;
        try {
            if (PyErr_CheckSignals() != 0)
                throw py::error_already_set();
            attend();
        } catch (...) {
            raised = std::current_exception();
            stop();
        }
    }
    if (raised)
        std::rethrow_exception(raised);
    if (PyErr_CheckSignals() != 0) // goes before an error of workers that the same signal ended
        throw py::error_already_set();
    done.get();
    attend(); // what was reported last
}

} // namespace rodwake::python
