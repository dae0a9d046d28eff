#include "straight_walkers.hpp"

#include "pair_decision.hpp"

#include <boost/multiprecision/cpp_bin_float.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rodwake::rods {

namespace {

using std::abs, std::cos, std::sin, std::sqrt; // beside those of Quad

using Contact = EncounterBounds::Contact;
using Extended = long double;
using Quad = boost::multiprecision::cpp_bin_float_quad;

/// R_0 - R_1 of two of them.
template<class Real>
struct StraightPair {
    Real x, y, vx, vy, t_end;

    StraightPair(const Pose& a, const Pose& b, double end)
        : x(Real(a.x) - b.x), y(Real(a.y) - b.y), vx(cos(Real(a.heading)) - cos(Real(b.heading))),
          vy(sin(Real(a.heading)) - sin(Real(b.heading))), t_end(end) {}

    Real square_speed() const { return vx * vx + vy * vy; }
    Real distance(Real t) const {
        const Real a = x + vx * t, b = y + vy * t;
        return sqrt(a * a + b * b);
    }
    Real nearest(Real from) const {
        const Real square = square_speed();
        const Real t = square > 0 ? Real(-(x * vx + y * vy) / square) : from;
        return distance(std::clamp(t, from, t_end));
    }
    Real largest() const { return sqrt(x * x + y * y) + 2 * t_end; }
    Real gap(double contact) const { return nearest(Real(0)) - contact; }
    /// They start apart and come nearer than that: |d x v| < contact |v|.
    double meeting(double contact) const {
        const Real closing = -(x * vx + y * vy), reach = contact * sqrt(square_speed());
        const Real across = abs(x * vy - y * vx), depth = (reach - across) * (reach + across);
        const Real outside = (sqrt(x * x + y * y) - contact) * (sqrt(x * x + y * y) + contact);
        return static_cast<double>(outside / (closing + (depth > 0 ? Real(sqrt(depth)) : Real(0))));
    }
};

template<class Real>
Contact contact_of(const StraightPair<Real>& pair, double contact) {
    const Real gap = pair.gap(contact),
               rounding = 32 * std::numeric_limits<Real>::epsilon() * (pair.largest() + contact);
    if (contact == 0.0 || gap > rounding)
        return Contact::none;
    return gap < -rounding ? Contact::certain : Contact::unknown;
}

/// Two that do not meet, to the rounding of double.
EncounterBounds straight_bounds(const Pose& a, const Pose& b, double t_end, const EndingCriteria& criteria) {
    constexpr double ulps = 16.0 * std::numeric_limits<double>::epsilon();
    const StraightPair<Extended> pair(a, b, t_end);
    const double error = ulps * static_cast<double>(pair.largest());
    EncounterBounds bounds;
    bounds.contact = Contact::none;
    bounds.x = static_cast<double>(pair.x + pair.vx * pair.t_end);
    bounds.y = static_cast<double>(pair.y + pair.vy * pair.t_end);
    bounds.heading[0] = a.heading;
    bounds.heading[1] = b.heading;
    bounds.place_error = error;
    if (a.heading != b.heading) // else their velocities are equal, however rounded
        bounds.heading_error[0] = bounds.heading_error[1] =
            ulps * (1.0 + std::max(std::abs(a.heading), std::abs(b.heading)));
    const Extended from = (1.0 - criteria.steady_fraction) * pair.t_end;
    const auto least = static_cast<double>(pair.nearest(from)),
               most = static_cast<double>(std::max(pair.distance(from), pair.distance(pair.t_end)));
    bounds.late_least = {least - error, least + error};
    bounds.late_most = {most - error, most + error};
    return bounds;
}

/// Beyond the doubt of 113 bits the likelier of both.
double meeting_of(const Pose& a, const Pose& b, double t_end, double contact) {
    const StraightPair<Extended> pair(a, b, t_end);
    switch (contact_of(pair, contact)) {
    case Contact::none:
        return HUGE_VAL;
    case Contact::certain:
        return pair.meeting(contact);
    case Contact::unknown:
        break;
    }
    const StraightPair<Quad> exact(a, b, t_end);
    return exact.gap(contact) < 0 ? exact.meeting(contact) : HUGE_VAL;
}

} // namespace

std::optional<Ending> straight_ending(const RodProblem& problem, const EndingCriteria& criteria) {
    const std::span<const Pose> rods = problem.rods;
    const double contact = problem.contact_distance.value_or(0.0);
    std::vector<std::optional<Ending>> pairs;
    bool clear = true; // of contacts that are not certain: a contact outdoes the other endings
    for (std::size_t a = 0; a < rods.size(); ++a)
        for (std::size_t b = a + 1; b < rods.size(); ++b) {
            Contact met = contact_of(StraightPair<Extended>(rods[a], rods[b], problem.t_end), contact);
            if (met == Contact::unknown)
                met = contact_of(StraightPair<Quad>(rods[a], rods[b], problem.t_end), contact);
            if (met == Contact::certain)
                return Ending::contact;
            clear = clear && met == Contact::none;
            pairs.push_back(certain_ending(straight_bounds(rods[a], rods[b], problem.t_end, criteria),
                                           criteria, [](double) { return false; }));
        }
    return clear ? together(pairs) : std::nullopt;
}

double first_meeting(const RodProblem& problem) {
    const std::span<const Pose> rods = problem.rods;
    double first = HUGE_VAL;
    for (std::size_t a = 0; problem.contact_distance && a < rods.size(); ++a)
        for (std::size_t b = a + 1; b < rods.size(); ++b)
            first = std::min(first, meeting_of(rods[a], rods[b], problem.t_end, *problem.contact_distance));
    // But for rounding it is within the run: rods that start at the limit may be within it by a bit.
    return first < HUGE_VAL ? std::clamp(first, std::numeric_limits<double>::min(), problem.t_end) : first;
}

} // namespace rodwake::rods
