#include "dispenser.hpp"
#include "rodwake/core/parallel.hpp"

namespace rodwake::scan {

void work(Dispenser& dispenser, const Evaluate& evaluate) {
    std::vector<Result> results;
    for (auto points = dispenser.next(); !points.empty(); points = dispenser.next()) {
        results.assign(points.size(), {});
        try {
            evaluate(points, results);
        } catch (...) {
            dispenser.stop(); // nobody need go on
            throw;
        }
        dispenser.take(results);
    }
}

Execute on_threads(Evaluate evaluate, std::size_t threads, std::function<bool()> stop) {
    return [evaluate = std::move(evaluate), threads, stop = std::move(stop)](std::span<const Point> points,
                                                                             const Take& take) {
        Dispenser dispenser(points, take, threads, stop);
        parallel_for(threads, threads, [&](std::size_t) { work(dispenser, evaluate); });
        return !dispenser.stopped();
    };
}

} // namespace rodwake::scan
