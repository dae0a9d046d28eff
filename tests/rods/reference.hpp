#pragma once
// The reference trajectories of tests/data/rod_trajectories.json as problems with their answers.

#include "rodwake/rods/simulate.hpp"

#include <string>
#include <vector>

namespace rodwake::test {

struct ReferencePoint {
    double time;
    std::vector<double> state;
    bool contact; ///< the event, not an output time
};

struct ReferenceCase {
    std::string name;
    rods::RodProblem problem;
    std::vector<ReferencePoint> points;
};

/// Throws if the file is missing or holds no case.
std::vector<ReferenceCase> reference_cases(const std::string& file);
std::vector<ReferenceCase> reference_cases();

/// Largest absolute difference between the run and the reference over all points: states in reduced units and
/// rad, and contact times. Infinite if a point or the contact is missing.
double worst_error(const ReferenceCase& reference, const rods::RodResult& result);

} // namespace rodwake::test
