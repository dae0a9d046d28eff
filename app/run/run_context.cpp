#include "rodwake/app/run_context.hpp"

#include <algorithm>
#include <thread>

namespace rodwake::app {

std::size_t RunContext::thread_count() const {
    return threads > 0 ? threads : std::max(1U, std::thread::hardware_concurrency());
}

} // namespace rodwake::app
