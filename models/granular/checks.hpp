#pragma once
// Collects everything that is wrong with an input, so that one error names it all.

#include "rodwake/core/error.hpp"
#include "rodwake/core/periodic.hpp"

#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

namespace rodwake::granular {

class Checks {
public:
    void require(bool legal, std::string problem) {
        if (!legal)
            problems_.push_back(std::move(problem));
    }
    /// nan and inf are outside every range.
    void number(bool legal, std::string_view name, double value, std::string_view range) {
        require(legal && std::isfinite(value), fmt::format("{} = {}: must be {}", name, value, range));
    }
    void positive(std::string_view name, double value) { number(value > 0.0, name, value, "> 0 and finite"); }
    void sides(const PeriodicBox& box) {
        positive("box", box.x);
        if (!box.square())
            positive("box, second side", box.y);
    }
    bool passed() const { return problems_.empty(); }
    /// Throws InputError with one line a problem, if there is any.
    void finish() const {
        if (!passed())
            throw InputError(fmt::format("{}", fmt::join(problems_, "\n")));
    }

private:
    std::vector<std::string> problems_;
};

} // namespace rodwake::granular
