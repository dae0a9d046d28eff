#pragma once
// An encounter of two rods: what its separation is measured in, and how it ends. One definition for the
// theory (exact states) and for beds (tracks with noise), so that their phase diagrams can be laid side by
// side. Any unit of length and time; in a periodic box separations are those of the nearest images.
//
//   contact    the separation fell to the contact distance
//   pursuit    headings locked and separation steady: the rear rod follows the other's trail
//   escape     the rods part, and what is left of their turning can no longer bring them back
//   orbit      the rods circle each other and come ever nearer to doing so at one distance and rate
//   bound      rods with bodies push each other: they touch for most of the end of the run
//   undecided  none of these by the end of the run
//
// Contact is an event, at its first time, and comes before all others, bound before orbit before pursuit. The
// other criteria are those of the end of the run, with r the separation, r' its rate, v_a and v_b the
// velocities:
//   bound      of rods with bodies (rods/body.hpp): they touch for 0.9 of the last quarter of the run
//   pursuit    the angle between the headings is at most locked_heading, the rear rod is within
//   lateral_offset r
//              of the other's axis and behind it, and r varied by at most steady_separation of its mean
//              (midway between its extremes) over the last part of the run. Rods that do not interact cannot
//              pursue each other, nor can those of which the front one's wake is too weak to turn the rear
//              one by felt_turn in the whole run
//   orbit      two rods in each other's steady wakes on the plane, none of the above, in the basin of a
//   stable
//              orbit (rods/settled_orbit.hpp); never of tracks
//   escape     r' > 0, and in the time r/|v_a - v_b| in which the separation doubles at these velocities
//              neither heading turns by more than residual_turn of the angle between the headings, at the
//              rate of the last part of the run: rods that part at a small angle are turned back by little
//
// In the theory velocities and the angle are those of the last instant, and the rate of turn is the largest
// of the last part. The rods of a bed rattle: their headings turn at 0.2 rad/s over 0.1 s and still at 0.1
// rad/s over 0.5 s, to and fro. So on a track the angle is the largest of the last part, velocities and rates
// of turn are means over it, and the limits are those of `noisy_track`.

#include "rodwake/core/periodic.hpp"

#include <array>
#include <cmath>
#include <string>

namespace rodwake {

enum class Ending { contact, pursuit, escape, undecided, orbit, bound };
/// In the order of the numbers that stand for them in tables.
inline constexpr std::array all_endings = {Ending::contact,   Ending::pursuit, Ending::escape,
                                           Ending::undecided, Ending::orbit,   Ending::bound};

/// Rods that stay together.
constexpr bool is_capture(Ending ending) {
    return ending == Ending::contact || ending == Ending::pursuit || ending == Ending::orbit ||
           ending == Ending::bound;
}

std::string to_string(Ending ending);

/// How well an ending is known (rods/certificate.hpp); the worst of several is the largest.
enum class Certificate { verified, checked, open };
inline constexpr std::array all_certificates = {Certificate::verified, Certificate::checked,
                                                Certificate::open};

std::string to_string(Certificate certificate);

/// The limits above; the defaults are the theory's.
struct EndingCriteria {
    double locked_heading = 0.1;     ///< rad
    double lateral_offset = 0.2;     ///< of r
    double steady_separation = 0.05; ///< relative range of r
    double steady_fraction = 0.2;    ///< of the run, its last part
    double residual_turn = 0.05;     ///< of the angle between the headings, while the separation doubles
    double felt_turn = 0.05; ///< rad, in the whole run: rods that turn each other by less do not interact

    bool operator==(const EndingCriteria&) const = default;
};

/// Wider by what a bed's rods do of themselves. At phi_b = 0.78 headings wander by some tenths of a radian
/// while a separation doubles, means of the speed over a few seconds by a quarter, and a rod 8 to 14 a behind
/// another keeps its distance within 0.15 to 0.37 of it over a quarter of the run. The rear rod is behind the
/// other rather than beside it: 1/sqrt(2).
inline constexpr EndingCriteria noisy_track{0.5, 0.70710678118654752, 0.4, 0.25, 0.5};

/// What is known of a pair over the last part of a run.
struct TailWindow {
    double min_separation = 0.0, max_separation = 0.0;
    double max_turning = 0.0; ///< largest |theta'| of either rod
};

/// Two rods at the end of a run.
struct PairEnd {
    double x = 0.0, y = 0.0;   ///< place of the first rod seen from the second
    double vx = 0.0, vy = 0.0; ///< velocity of the first relative to the second
    double heading[2] = {};    ///< rad
    double angle = 0.0;        ///< between the headings, in [0, pi]
    TailWindow late;
};

/// |difference| of two headings, in [0, pi].
double angle_between(double heading, double other);

/// Never `contact`.
Ending classify(const PairEnd& pair, const EndingCriteria& criteria);
/// Of a pair that is undecided: the criteria of pursuit and escape that it fails, with their numbers and
/// limits.
std::string failed_criteria(const PairEnd& pair, const EndingCriteria& criteria);

/// The frame of the mean first heading of two rods. Headings that are opposite have none.
class PairFrame {
public:
    /// (x, y): first place of rod 0 seen from rod 1, of the nearest images.
    PairFrame(double heading0, double heading1, double x, double y);

    bool common() const { return common_; }
    /// Along the mean first heading and to its left; 0 without one.
    double ahead(double x, double y) const { return ahead_x_ * x + ahead_y_ * y; }
    double across(double x, double y) const { return -ahead_y_ * x + ahead_x_ * y; }
    /// The side of the box nearest to the mean first heading: x without one.
    double side_along(const PeriodicBox& box) const {
        return std::abs(ahead_x_) >= std::abs(ahead_y_) ? box.x : box.y;
    }
    /// Separation across at first, >= 0.
    double separation() const;
    /// Its change, outwards positive, once rod 0 has moved by (x, y) relative to rod 1.
    double change(double x, double y) const;

private:
    bool common_ = false;
    double ahead_x_ = 0.0, ahead_y_ = 0.0; ///< unit vector
    double first_ = 0.0;                   ///< across
};
using PairCourse [[deprecated("it is PairFrame")]] = PairFrame;
using LatePart [[deprecated("it is TailWindow")]] = TailWindow;

} // namespace rodwake
