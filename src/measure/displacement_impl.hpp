#pragma once
// What a DisplacementRecord holds: the sums of its estimator and what is common to all.

#include "rodwake/measure/displacement.hpp"

#include "lagrangian_record.hpp"
#include "phase_record.hpp"

#include <optional>
#include <variant>

namespace rodwake::measure {

struct DisplacementRecord::Impl {
    using Sums = std::variant<PhaseRecord, LagrangianRecord>;

    Impl(const Layout& layout_in, const DisplacementKeys& keys_in);

    void add(const Frame& frame);
    void follow(const Frame& frame);

    Layout layout;
    DisplacementKeys keys; ///< as given
    double far_from;       ///< m, worked out
    Sums sums;
    std::size_t frames = 0;
    double path = 0.0, duration = 0.0; ///< of the rod along its heading, m; s
    double last_time = 0.0;
    RodPlace last; ///< of the rod
};

} // namespace rodwake::measure
