#include "pair_outcome.hpp"

#include "rodwake/measure/frame.hpp"

#include <cmath>
#include <numbers>

namespace rodwake::measure {

namespace {

bool locked(const PairTrack& track, const PairKeys& keys, std::size_t row) {
    const double between = track.heading[0][row] - track.heading[1][row];
    return std::abs(std::remainder(between, 2.0 * std::numbers::pi)) < keys.lock_angle;
}

/// The row from which on headings stay locked; the number of rows if they are not at the end.
std::size_t lock_begin(const PairTrack& track, const PairKeys& keys) {
    std::size_t row = track.t.size();
    while (row > 0 && locked(track, keys, row - 1))
        --row;
    return row;
}

/// One rod behind the other rather than beside it, as their mean heading has it.
bool in_line(const PairTrack& track, const PairKeys& keys, std::size_t row) {
    const double first = track.heading[0][row], second = track.heading[1][row];
    const double heading = second + std::remainder(first - second, 2.0 * std::numbers::pi) / 2.0;
    const double c = std::cos(heading), s = std::sin(heading);
    const Apart d = apart(track, keys.box, row);
    return std::abs(c * d.x + s * d.y) >= std::abs(c * d.y - s * d.x);
}

} // namespace

const char* to_string(PairOutcome outcome) {
    switch (outcome) {
    case PairOutcome::contact:
        return "contact";
    case PairOutcome::pursuit:
        return "pursuit";
    case PairOutcome::escape:
        break;
    }
    return "escape";
}

Apart apart(const PairTrack& track, double box, std::size_t row) {
    const auto step = [&](const std::vector<double>(&place)[2]) {
        const double first = place[0][0] - place[1][0];
        return nearest(first, box) + (place[0][row] - place[1][row] - first);
    };
    return {step(track.x), step(track.y)};
}

double image_distance(const PairTrack& track, double box, std::size_t row) {
    return std::hypot(nearest(track.x[0][row] - track.x[1][row], box),
                      nearest(track.y[0][row] - track.y[1][row], box));
}

Ending ending(const PairTrack& track, const PairKeys& keys) {
    const std::size_t last = track.t.size() - 1;
    for (std::size_t row = 0; row <= last; ++row)
        if (image_distance(track, keys.box, row) < keys.contact_distance)
            return {PairOutcome::contact, track.t[row]};
    const std::size_t begin = lock_begin(track, keys);
    const double last_quarter = track.t[last] - (track.t[last] - track.t[0]) / 4.0;
    if (begin <= last && track.t[begin] <= last_quarter && in_line(track, keys, last))
        return {PairOutcome::pursuit, track.t[begin]};
    return {PairOutcome::escape, track.t[last]};
}

} // namespace rodwake::measure
