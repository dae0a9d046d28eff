#pragma once
// Who evaluates the points: threads of this process, or the ranks of an MPI job.

#include "rodwake/scan/point.hpp"

namespace rodwake::scan {

/// Gets results chunk by chunk, in any order, one call at a time.
using Take = std::function<void(std::span<const Result>)>;

/// Evaluates points and hands every result to `take`; false if it was stopped before all were done. Points
/// start in the order given, so dear ones belong first.
using Execute = std::function<bool(std::span<const Point> points, const Take& take)>;

/// On threads of this process. Chunks take about 10 ms by the cost measured so far, so that a kill loses
/// little and the last chunks end together. `stop` is asked between chunks; it may be empty.
Execute on_threads(Evaluate evaluate, std::size_t threads, std::function<bool()> stop);

} // namespace rodwake::scan
