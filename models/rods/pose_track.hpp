#pragma once
// The poses along a solve in any form. Directors tell headings but for whole turns; a step turns a rod by
// less than half of one, so each heading is the one nearest to that of the step before.

#include "rodwake/rods/simulate.hpp"

namespace rodwake::rods {

class PoseTrack {
public:
    /// At `time`, with these headings (one a rod); `output_times` are those of the solve.
    PoseTrack(Formulation form, std::vector<double> headings, std::span<const double> output_times);

    /// The next step; the spans hold until the next call.
    integrate::Step step(const integrate::Step& raw);
    /// A state at the end of the last step.
    std::vector<double> poses(integrate::State raw) const { return to_poses(form_, raw, headings_); }
    /// The first states of the solve at its output times.
    std::vector<std::vector<double>> outputs(std::span<const std::vector<double>> raw) const;
    const std::vector<double>& headings() const { return headings_; }

private:
    Formulation form_;
    std::span<const double> output_times_;
    std::vector<double> headings_, before_, after_;
    std::vector<std::vector<double>> at_outputs_; ///< headings at the end of each output's step
};

} // namespace rodwake::rods
