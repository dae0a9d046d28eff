#include "pair_proof.hpp"

#include "turning_bound.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace rodwake::rods {

namespace {

using Matrix = Eigen::Matrix4d; ///< of x, y (of R_0 - R_1), theta_0, theta_1
using Vector = Eigen::Vector4d;

constexpr int most_splits = 6; ///< of a step
constexpr int most_tries = 20; ///< of a bound over a piece
constexpr double proof_ulp = std::numeric_limits<double>::epsilon();

/// Points of a piece at which separations are evaluated: every second node.
constexpr std::array watched_at{node_at[0], node_at[2],  node_at[4], node_at[6],
                                node_at[8], node_at[10], node_at[12]};
constexpr std::size_t watched = watched_at.size();

/// Bounds of errors: of the position, and of both headings.
using Errors = Eigen::Vector3d;

Eigen::Map<const Errors> errors(const double (&numbers)[3]) { return Eigen::Map<const Errors>(numbers); }

auto block(const double (&numbers)[3][3]) {
    return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(&numbers[0][0]);
}

/// Bounds of the change of the error over a piece: the numbers of pair_pieces.hpp as matrices.
struct StepBounds {
    const Piece& piece;
    const PieceReach<double>& reach;
    const PieceExpansion<double>& seen;

    /// Bound of the part of a rate that is of first order in the error.
    double linear(std::size_t rod, const Errors& e) const { return errors(seen.by[rod]).dot(e); }
    /// Fraction of the room that an error takes up.
    double reached(const Errors& e) const {
        return (std::numbers::sqrt2 * e[0] / reach.distance + e[1] + e[2]) / reach.room;
    }
    /// Bound of the part that is of second order in the error.
    Errors curvature(const Errors& e) const {
        const double x = reached(e);
        const double share = x < 1.0 ? x * x / (1.0 - x) : HUGE_VAL;
        return {0.5 * (e[1] * e[1] + e[2] * e[2]), reach.rate[0] * share, reach.rate[1] * share};
    }
    /// Bound of |rate of turn| of the polynomial.
    double rate(std::size_t rod) const { return piece.p[2 + rod].steepest() * 2.0 / piece.length; }
};

class Prover {
public:
    Prover(const PairProblem& pair, const StepTrack& track, const EndingCriteria& criteria, ProofSpace& space,
           const PairSpread& spread)
        : pair_(pair), track_(track), couplings_{pair.couplings, pair.couplings, spread.couplings},
          space_(space), late_from_((1.0 - criteria.steady_fraction) * pair.t_end) {
        // Bounds of the couplings of all pairs. If a single one acts, rates differ by the same share as it
        // does.
        std::size_t acting = 0;
        for (const Coupling& coupling : coupling_list) {
            const double value = pair.couplings.*coupling.number,
                         change = std::abs(spread.couplings.*coupling.number);
            couplings_.largest.*coupling.number = std::abs(value) + change;
            if (value == 0.0 && change == 0.0)
                continue;
            share_ = ++acting == 1 && value != 0.0 ? std::optional(change / std::abs(value)) : std::nullopt;
        }
        if (share_)
            couplings_.change = {0.0, 0.0, 0.0};
        for (int k = 0; k < 4; ++k)
            spread_[k] = spread.start[static_cast<std::size_t>(k)];
        now_ = Errors(length_of(spread_[0], spread_[1]), spread_[2], spread_[3]);
        encounter_.late_least = {HUGE_VAL, HUGE_VAL};
        encounter_.late_most = {0.0, 0.0};
    }

    std::optional<EncounterBounds> run(bool contact);

private:
    std::array<double, 3> end_of(std::size_t state, int coordinate, double half) const;
    Piece& add(int depth);
    void halve(std::size_t k);
    bool prepare(std::size_t first);
    bool advance(std::size_t k);
    Errors changed(const StepBounds& bounds, const Errors& e) const;
    bool propagate(const StepBounds& bounds);
    bool stays_apart(const Piece& piece, double low, double high, double r_low, double r_high, double speed,
                     int depth) const;
    bool watch(const StepBounds& bounds);
    void finish(bool contact);

    const PairProblem& pair_;
    const StepTrack& track_;
    PieceCouplings couplings_;
    std::optional<double> share_; ///< of the rate, where that is one
    ProofSpace& space_;
    double late_from_;
    bool watched_ = true;
    Vector middle_ = Vector::Zero(); ///< the error is middle_ + frame_ c, |c_i| <= spread_i
    Matrix frame_ = Matrix::Identity();
    Vector spread_ = Vector::Zero();
    Errors most_ = Errors::Zero(), now_ = Errors::Zero(); ///< over the step, and at its end
    EncounterBounds encounter_;
};

/// Value, first and second derivative by v at the end of a step; `half`: half the length of the step.
std::array<double, 3> Prover::end_of(std::size_t state, int coordinate, double half) const {
    const PairJets& e = space_.ends;
    const double c[2] = {e(PairJets::cosine0, state), e(PairJets::cosine1, state)},
                 s[2] = {e(PairJets::sine0, state), e(PairJets::sine1, state)};
    const double rate[2] = {e(PairJets::rate0, state), e(PairJets::rate1, state)};
    const double v[4] = {c[0] - c[1], s[0] - s[1], rate[0], rate[1]};
    double second = 0.0;
    if (coordinate == 0)
        second = s[1] * rate[1] - s[0] * rate[0];
    else if (coordinate == 1)
        second = c[0] * rate[0] - c[1] * rate[1];
    else
        for (std::size_t k = 0; k < 4; ++k)
            second += v[k] * e((coordinate == 2 ? PairJets::rate0 : PairJets::rate1) + 1 + k, state);
    return {e(static_cast<std::size_t>(coordinate), state), half * v[coordinate], half * half * second};
}

/// Appends a piece. Its bounds are not initialised, since pieces are many.
Piece& Prover::add(int depth) {
    if (space_.used == space_.pieces.size())
        space_.pieces.resize(2 * space_.used + 64);
    ProofPiece& piece = space_.pieces[space_.used++];
    piece.depth = depth;
    piece.halves = 0;
    return piece.piece;
}

/// Computes the bounds of the pieces from `first` on. Pieces without bounds, or over which errors grow much,
/// are halved. Returns false if even the smallest piece has none.
bool Prover::prepare(std::size_t first) {
    constexpr double well = 1e-8, much = 0.5; // an error too small for halving to pay; growth
    std::vector<ProofPiece>& pieces = space_.pieces;
    std::vector<std::size_t>& which = space_.which;
    while (first < space_.used) {
        find_reach(pair_.medium, couplings_, std::span(pieces).subspan(first, space_.used - first));
        const std::size_t end = space_.used;
        which.clear();
        for (std::size_t k = first; k < end; ++k)
            if (pieces[k].reach.room > 0.0 && (pieces[k].reach.missed < well || pieces[k].depth == 0))
                which.push_back(k);
            else if (pieces[k].depth > 0)
                halve(k);
            else
                return false;
        if (!expand(pair_.medium, pair_.couplings, pieces, which))
            return false;
        for (const std::size_t k : which)
            if (!(pieces[k].seen.growth < much) && pieces[k].depth > 0)
                halve(k);
        first = end;
    }
    return true;
}

void Prover::halve(std::size_t k) {
    const int depth = space_.pieces[k].depth - 1;
    space_.pieces[k].halves = space_.used;
    for (const bool upper : {false, true}) {
        Piece& half = add(depth);
        half = space_.pieces[k].piece.half(upper);
    }
}

/// Bound of the change of the rates by other couplings.
Errors Prover::changed(const StepBounds& b, const Errors& e) const {
    Errors change = Errors::Zero();
    if (!couplings_.change.any() && share_.value_or(0.0) == 0.0)
        return change;
    const Errors curvature = b.curvature(e);
    for (std::size_t rod = 0; rod < 2; ++rod) {
        const auto row = static_cast<int>(rod) + 1;
        change[row] = b.reach.change[rod] + share_.value_or(0.0) * (b.rate(rod) + b.seen.defect[1 + rod] +
                                                                    b.linear(rod, e) + curvature[row]);
    }
    return change;
}

bool Prover::propagate(const StepBounds& b) {
    const PieceExpansion<double>& seen = b.seen;
    if (!(seen.growth < HUGE_VAL))
        return false;
    const double h = b.reach.length;
    const auto mean = errors(seen.mean), known = errors(seen.known);
    const auto grown = block(seen.grown), inverse = block(seen.inverse);
    const Errors first = grown * (now_ + h * (mean + known));

    // Iterate for the smallest bound d that maps into itself. The error is e = E + (1 + W) d.
    Errors d, curved = Errors::Zero(), next = first;
    for (int k = 0; k == 0 || !(next.array() <= d.array()).all(); ++k) {
        if (k == most_tries || !next.allFinite())
            return false;
        d = 1.01 * next;
        most_ = errors(seen.swing) + d + block(seen.turned) * d;
        curved = inverse * (b.curvature(most_) + changed(b, most_));
        next = first + h * (grown * curved);
    }

    // The error moves with the propagator; its parallelepiped gets orthogonal edges and grows by what is
    // added.
    const double size = std::max(d[0] / seen.scale, std::max(d[1], d[2]));
    const Errors added = h * (grown * (known + block(seen.wobble) * d + curved)) +
                         2.0 * seen.truncation * size * Errors(seen.scale, 1.0, 1.0);
    const Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>> propagator(&seen.propagator[0][0]);
    const Matrix moved = propagator * frame_;
    Matrix frame = moved; // the Gram-Schmidt process, in the order of the columns
    for (int k = 0; k < 4; ++k) {
        for (int repeat = 0; repeat < 2; ++repeat) // twice, since columns may be nearly parallel
            for (int j = 0; j < k; ++j)
                frame.col(k) -= frame.col(j).dot(frame.col(k)) * frame.col(j);
        frame.col(k).normalize();
    }
    const Vector g(added[0], added[0], added[1], added[2]);
    spread_ = ((frame.transpose() * moved).cwiseAbs() * spread_ + frame.cwiseAbs().transpose() * g).eval();
    spread_ *= 1.0 + 64.0 * proof_ulp;
    frame_ = frame;
    middle_ = (propagator * middle_ - Eigen::Map<const Vector>(seen.drift)).eval();
    const Vector end = middle_.cwiseAbs() + frame_.cwiseAbs() * spread_;
    now_ = Errors(length_of(end[0], end[1]), end[2], end[3]);
    return now_.allFinite();
}

/// Whether the rods stay out of contact from v = low to high. They approach at most at `speed`, by v.
bool Prover::stays_apart(const Piece& piece, double low, double high, double r_low, double r_high,
                         double speed, int depth) const {
    const double limit = pair_.contact_distance + most_[0];
    if (0.5 * (r_low + r_high - speed * (high - low)) > limit)
        return true;
    if (depth == 0 || std::min(r_low, r_high) <= limit)
        return false;
    const double middle = 0.5 * (low + high), r = piece.separation(middle);
    return stays_apart(piece, low, middle, r_low, r, speed, depth - 1) &&
           stays_apart(piece, middle, high, r, r_high, speed, depth - 1);
}

/// Excludes contact on a piece, and records its part of the tail window. Returns false if contact cannot be
/// excluded.
bool Prover::watch(const StepBounds& b) {
    constexpr int most_halvings = 40;
    const Piece& piece = b.piece;
    const bool late = piece.start + piece.length >= late_from_;
    if (!late && b.reach.distance - piece.place_excursion(1.0) > pair_.contact_distance + most_[0])
        return true;
    const double angle = piece.p[2].c[0] - piece.p[3].c[0], turn = b.reach.turn[0] + b.reach.turn[1];
    const double speed =
        0.5 * piece.length * (std::min(2.0, 2.0 * std::abs(std::sin(0.5 * angle)) + turn) + b.seen.defect[0]);
    std::array<double, watched> r;
    for (std::size_t j = 0; j < watched; ++j)
        r[j] = piece.separation(watched_at[j]);
    for (std::size_t j = 0; j + 1 < watched; ++j)
        if (!stays_apart(piece, watched_at[j], watched_at[j + 1], r[j], r[j + 1], speed, most_halvings))
            return false;
    if (!late)
        return true;

    // Separations in the tail window: sampled at the points, and bounded between them by the speed.
    const double from = (late_from_ - piece.start) / (0.5 * piece.length) - 1.0, error = most_[0];
    Enclosure &least = encounter_.late_least, &most = encounter_.late_most,
              &turning = encounter_.late_turning;
    const auto add_value = [&](double separation) {
        least.high = std::min(least.high, separation + error);
        most.low = std::max(most.low, separation - error);
    };
    for (std::size_t j = 0; j < watched; ++j) {
        if (watched_at[j] >= from)
            add_value(r[j]);
        if (j + 1 < watched && watched_at[j + 1] >= from) {
            const double path = speed * (watched_at[j + 1] - watched_at[j]);
            least.low = std::min(least.low, 0.5 * (r[j] + r[j + 1] - path) - error);
            most.high = std::max(most.high, 0.5 * (r[j] + r[j + 1] + path) + error);
        }
    }
    if (from > -1.0)
        add_value(piece.separation(std::min(from, 1.0)));

    // The turning in the tail window, of the polynomial and by its error.
    const Errors off = changed(b, most_) + b.curvature(most_);
    for (std::size_t rod = 0; rod < 2; ++rod) {
        const double further = b.seen.defect[1 + rod] + b.linear(rod, most_) + off[static_cast<int>(rod) + 1];
        turning.high = std::max(turning.high, b.rate(rod) + further);
        if (from <= -1.0)
            for (const double v : {-1.0, 0.0, 1.0})
                turning.low =
                    std::max(turning.low, std::abs(piece.p[2 + rod].slope(v)) * 2.0 / piece.length - further);
    }
    return true;
}

/// Propagates the error over a piece, or over its halves if the error does not stay small over the whole.
bool Prover::advance(std::size_t k) {
    if (const std::size_t halves = space_.pieces[k].halves)
        return advance(halves) && advance(halves + 1);
    const ProofPiece& piece = space_.pieces[k];
    const StepBounds b{piece.piece, piece.reach, piece.seen};
    if (propagate(b))
        return !watched_ || watch(b);
    if (space_.pieces[k].depth == 0 || b.reached(now_) > 0.5) // else halves would do no better
        return false;
    halve(k);
    return prepare(space_.pieces[k].halves) && advance(k);
}

std::optional<EncounterBounds> Prover::run(bool contact) {
    // Evaluate rates and derivatives at the ends of all steps.
    const std::size_t states = track_.states.size();
    PairJets& ends = space_.ends;
    ends.resize(states);
    for (std::size_t k = 0; k < states; ++k) {
        const std::array<double, 6>& y = track_.states[k];
        ends.at[PairJets::x][k] = y[0] - y[3];
        ends.at[PairJets::y][k] = y[1] - y[4];
        ends.at[PairJets::heading0][k] = y[2];
        ends.at[PairJets::heading1][k] = y[5];
    }
    if (states < 2 || !fill_jets(pair_.medium, pair_.couplings, ends))
        return std::nullopt;

    // Prepare some steps at once, and propagate the error over them.
    watched_ = !contact;                // rods in contact at the end may have been in contact before
    constexpr std::size_t at_once = 32; // a proof that fails early does not prepare the rest
    for (std::size_t from = 0; from + 1 < states; from += at_once) {
        const std::size_t count = std::min(at_once, states - 1 - from);
        space_.used = 0;
        for (std::size_t k = from; k < from + count; ++k) {
            Piece& piece = add(most_splits);
            piece.start = track_.times[k];
            piece.length = track_.times[k + 1] - track_.times[k];
            for (int i = 0; i < 4; ++i)
                piece.p[static_cast<std::size_t>(i)] =
                    Quintic::through(end_of(k, i, 0.5 * piece.length), end_of(k + 1, i, 0.5 * piece.length));
        }
        if (!prepare(0))
            return std::nullopt;
        for (std::size_t k = 0; k < count; ++k)
            if (!advance(k))
                return std::nullopt;
    }
    finish(contact);
    return encounter_;
}

/// Fills in the end. Contact is certain if the rods are within the contact distance a little later for any
/// rates.
void Prover::finish(bool contact) {
    const std::size_t last = track_.states.size() - 1;
    const PairJets& e = space_.ends;
    encounter_.x = e(PairJets::x, last);
    encounter_.y = e(PairJets::y, last);
    encounter_.heading[0] = e(PairJets::heading0, last);
    encounter_.heading[1] = e(PairJets::heading1, last);
    encounter_.place_error = now_[0];
    encounter_.heading_error[0] = now_[1];
    encounter_.heading_error[1] = now_[2];
    encounter_.contact = EncounterBounds::Contact::none;
    if (!contact)
        return;
    encounter_.contact = EncounterBounds::Contact::unknown;
    constexpr double width = 0.35, nearby = 0.1;
    const double vx = std::cos(encounter_.heading[0]) - std::cos(encounter_.heading[1]),
                 vy = std::sin(encounter_.heading[0]) - std::sin(encounter_.heading[1]);
    const double r = length_of(encounter_.x, encounter_.y), v = length_of(vx, vy), turn = now_[1] + now_[2];
    const double rate = (encounter_.x * vx + encounter_.y * vy) / r + turn + 2.0 * v * now_[0] / r;
    if (!(rate < 0.0) || now_[0] > 0.5 * nearby * r)
        return;
    // d2r/dt2 <= v^2/r + both rates of turn, here for any direction of the other
    const double bend = 4.0 / ((1.0 - 3.0 * nearby) * r) +
                        TurningBound(pair_.medium, couplings_.largest).at(r, 0.0, width).rate * 2.0;
    const double left = pair_.t_end - track_.times[last];
    const double time = std::min({-rate / bend, left, nearby * r});
    if (r + now_[0] + time * (rate + 0.5 * bend * time) <
        pair_.contact_distance - 1e-9 * pair_.contact_distance)
        encounter_.contact = EncounterBounds::Contact::certain;
}

} // namespace

void StepTrack::add(double time, integrate::State y) {
    if (!times.empty() && !(time > times.back()))
        return;
    times.push_back(time);
    states.push_back({y[0], y[1], y[2], y[3], y[4], y[5]});
}

std::optional<EncounterBounds> proved_bounds(const PairProblem& pair, const StepTrack& track, bool contact,
                                             const EndingCriteria& criteria, ProofSpace& space,
                                             const PairSpread& spread) {
    return Prover(pair, track, criteria, space, spread).run(contact);
}

} // namespace rodwake::rods
