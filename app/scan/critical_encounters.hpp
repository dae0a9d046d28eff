#pragma once
// The encounters behind one critical value: runs at values of the last axis, for one point of the others.

#include "critical.hpp"
#include "rodwake/app/rods.hpp"
#include "rodwake/app/scan_problem.hpp"
#include "rodwake/core/encounter.hpp"

#include <optional>
#include <string>
#include <vector>

namespace rodwake::app {

/// An encounter at one value of the key; lengths reduced.
struct Encounter {
    double at = 0.0;
    Ending ending = Ending::undecided;
    int group = 2;
    bool parted = false; ///< undecided, but half the run's length or farther apart, each in the other's trail
    double time = 0.0;
    double orbit = std::numeric_limits<double>::quiet_NaN(); ///< separation of the orbit in which rods end
    double closest = 0.0; ///< of an orbit that shrinks its own separation; of a contact not known
};

/// A point that could not be evaluated ends the search in its bracket.
struct PointFailed {
    scan::Status status;
    std::string cause;
};

/// A bracket: its ends are of different groups.
struct Bracket {
    Encounter low, high;

    double width() const { return high.at - low.at; }
    bool is_between(Ending one, Ending other) const {
        return (low.ending == one && high.ending == other) || (low.ending == other && high.ending == one);
    }
    /// The inner point replaces the end of its group; a third group, with which nothing may begin, the upper.
    void take(const Encounter& inner) { (inner.group == low.group ? low : high) = inner; }
};

/// At one tolerance. The plan must outlive it.
class Encounters {
public:
    Encounters(const ScanPlan& plan, const scan::Point& point, const std::function<bool()>& stop);

    /// Until its outcome is decided, or the limit of time. Throws PointFailed.
    Encounter at(double value) { return both(value, value).low; }
    /// Two at once, which costs little more.
    Bracket both(double low, double high);
    /// The closest approach; of rods in contact, which walk on, that of the first minimum, or of the orbit in
    /// which they end.
    double closest_approach(const Encounter& one);
    double contact_distance(double value) { return problem_at(value).contact_distance.value_or(0.0); }
    /// Valid until the next call.
    const rods::RodProblem& problem_at(double value) { return problem_.at(point(value)); }
    rods::RodOptions options(const rods::RodProblem& problem) const;
    /// One more run, as of scan_parts.hpp.
    rods::RodResult run(const rods::RodProblem& problem, const rods::RodOptions& options);

    long count = 0;

private:
    scan::Point point(double value) const;

    const ScanPlan& plan_;
    scan::Point point_;
    const std::function<bool()>& stop_;
    scan::Evaluate evaluate_;
    PointProblem problem_;
    std::size_t axis_, time_ = 0, closest_ = 0, apart_ = 0, orbit_ = 0;
    OutputUnits units_;
};

/// Whether the fixed points of rods/pair_equilibria.hpp are this problem's.
bool has_fixed_points(const rods::RodProblem& problem);

/// The pose of rod 1 seen from rod 0, step by step.
struct Path {
    std::vector<double> times, separations;
    std::vector<rods::Pose> poses;
};
Path follow(Encounters& encounters, const Encounter& one);

/// The fold at which an orbit vanishes within the bracket.
std::optional<double> fold_near(Encounters& encounters, const Bracket& bracket);

/// Where the orbit in which rods end has shrunk to the contact distance: the root of its own separation, as
/// encounters end ever later near it. Secants follow the orbit, which shrinks by at most 30 % in each.
/// Nothing if the rods come closer on the way, or if the orbit does not lead from one end of the bracket to
/// the other.
std::optional<double> shrunk_orbit(Encounters& encounters, const Bracket& bracket);

struct Departure {
    double value; ///< the separatrix, to rounding at this tolerance
    double rate, error;
};

/// The rate of departure from the fixed point of a separatrix, and its difference from 1/slope of the times
/// over ln(1/|p - p*|) in eight decades.
std::optional<Departure> departure(Encounters& encounters, Bracket bracket);

} // namespace rodwake::app
