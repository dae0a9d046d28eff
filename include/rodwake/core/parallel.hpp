#pragma once
// Independent tasks over threads. Which thread does which task changes nothing but the time taken.

#include <cstddef>
#include <functional>

namespace rodwake {

/// Calls task(i) once for each i in [0, count) on up to `threads` threads. If tasks throw, the exception of
/// the lowest index is rethrown after all have ended.
void parallel_for(std::size_t count, std::size_t threads, const std::function<void(std::size_t)>& task);

} // namespace rodwake
