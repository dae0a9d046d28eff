#pragma once
// The medium as Python has it: eta, xi and the domain.

#include "rodwake/core/periodic.hpp"
#include "rodwake/elastic/medium.hpp"

#include <optional>

namespace rodwake::python {

struct Medium {
    elastic::Medium elastic;
    std::optional<PeriodicBox> box; ///< f/mu; absent: infinite plane
};

} // namespace rodwake::python
