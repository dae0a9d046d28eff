#include "rodwake/measure/even_times.hpp"

#include "rodwake/core/error.hpp"

#include <fmt/format.h>

#include <cmath>

namespace rodwake::measure {

void EvenTimes::next(double time, const char* what) {
    const double step = time - last;
    if (frames > 0 && !(step > 0.0))
        throw RunError(fmt::format(
            "measure: {}: a frame at {:.9g} s follows one at {:.9g} s: times must grow", what, time, last));
    if (frames > 1 && std::abs(step - interval) > 1e-6 * interval)
        throw RunError(
            fmt::format("measure: {}: frames at {:.9g} s and {:.9g} s are {:.9g} s apart, those before "
                        "{:.9g} s: they must be evenly spaced",
                        what, last, time, step, interval));
    if (frames == 1)
        interval = step;
    last = time;
    ++frames;
}

void EvenTimes::pack(Packer& out) const {
    out.put(frames);
    out.put(last);
    out.put(interval);
}

void EvenTimes::unpack(Unpacker& in) {
    frames = in.count();
    last = in.get();
    interval = in.get();
}

} // namespace rodwake::measure
