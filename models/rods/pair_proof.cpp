#include "pair_proof.hpp"

#include "step_polynomial.hpp"
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
constexpr double proof_ulp = std::numeric_limits<double>::epsilon();

/// Columns that are expanded in Chebyshev polynomials over a step.
enum Column {
    defect_x,
    defect_y,
    defect_0,
    defect_1,
    rate_0,
    by_0 = rate_0 + 2, ///< of rate 0 by x, y, theta_0 and theta_1
    by_1 = by_0 + 4,
    column_count = by_1 + 4
};
using Samples = Eigen::Matrix<double, nodes, column_count>;

/// Bounds of errors: of the place, and of both headings.
using Errors = Eigen::Vector3d;

/// What a step does to the error, at most.
struct StepBounds {
    Matrix mean;        ///< Jacobian, of which over the step
    double by_place[2]; ///< |d rate/d place|,
    double by_heading[2][2];
    double place_wobble[2], heading_wobble[2][2]; ///< no more than that differs
    double turn[2];                               ///< how far a heading turns from its middle
    Errors defect;
    double change[2];     ///< of the rate by what the couplings differ by, if it is no share of it
    double rate[2], room; ///< |rate| over the neighbourhood, whose size in the sense of wandering is left
    double distance;      ///< in the middle
    double rate_most[2], rate_least[2]; ///< of the polynomial: at most, and somewhere at least

    /// Of a rate: what is of first order in the error.
    double linear(int rod, const Errors& e) const {
        return (by_place[rod] + place_wobble[rod]) * e[0] +
               (by_heading[rod][0] + heading_wobble[rod][0]) * e[1] +
               (by_heading[rod][1] + heading_wobble[rod][1]) * e[2];
    }
    /// Of a rate: what is of second order in the error.
    double curvature(int rod, const Errors& e) const {
        const double x = (std::numbers::sqrt2 * e[0] / distance + e[1] + e[2]) / room;
        return x < 1.0 ? rate[rod] * x * x / (1.0 - x) : HUGE_VAL;
    }
};

/// Couplings that bound those of all pairs.
Couplings largest(Couplings couplings, const Couplings& spread) {
    for (const Coupling& one : coupling_list)
        couplings.*one.number = std::abs(couplings.*one.number) + std::abs(spread.*one.number);
    return couplings;
}

/// If a single coupling acts, the share of it, and so of the rate, that it may differ by.
std::optional<double> share_of(const Couplings& couplings, const Couplings& spread) {
    std::optional<double> share;
    for (const Coupling& one : coupling_list) {
        const double value = couplings.*one.number, change = std::abs(spread.*one.number);
        if (value == 0.0 && change == 0.0)
            continue;
        if (share || value == 0.0)
            return std::nullopt;
        share = change / std::abs(value);
    }
    return share;
}

class Prover {
public:
    Prover(const PairProblem& pair, const PairTrack& track, const EndingCriteria& criteria, ProofSpace& space,
           const PairSpread& spread)
        : pair_(pair), track_(track), bound_(pair.medium, largest(pair.couplings, spread.couplings)),
          change_(pair.medium, spread.couplings), share_(share_of(pair.couplings, spread.couplings)),
          space_(space), late_from_((1.0 - criteria.steady_fraction) * pair.t_end) {
        for (int k = 0; k < 4; ++k)
            spread_[k] = spread.start[static_cast<std::size_t>(k)];
        now_ = Errors(length_of(spread_[0], spread_[1]), spread_[2], spread_[3]);
        encounter_.late_least = {HUGE_VAL, HUGE_VAL};
        encounter_.late_most = {0.0, 0.0};
    }

    std::optional<EncounterBounds> run(bool contact) {
        if (!sample())
            return std::nullopt;
        watched_ = !contact; // whoever is in contact at the end may have been before
        encounter_.contact = EncounterBounds::Contact::none;
        for (std::size_t k = 0; k < pieces_.size(); ++k)
            if (!advance(pieces_[k], space_.inner, k * nodes, most_splits))
                return std::nullopt;
        finish(contact);
        return encounter_;
    }

private:
    std::array<double, 3> end_of(std::size_t state, int coordinate, double half) const;
    bool sample();
    void put_nodes(const Piece& piece, PairJets& jets, std::size_t row) const;
    StepBounds bounds_of(const Piece& piece, const PairJets& jets, std::size_t row) const;
    bool advance(const Piece& piece, const PairJets& jets, std::size_t row, int depth);
    bool advance_halves(const Piece& piece, int depth);
    double varied(const StepBounds& bounds, int rod, const Errors& e) const;
    bool propagate(const StepBounds& bounds, double length);
    bool stays_apart(const Piece& piece, double low, double high, double r_low, double r_high, double speed,
                     int depth) const;
    bool watch(const Piece& piece, const StepBounds& bounds);
    void finish(bool contact);

    const PairProblem& pair_;
    const PairTrack& track_;
    TurningBound bound_, change_; ///< of all pairs, and of what their couplings differ by
    std::optional<double> share_; ///< of the rate, where that is one
    ProofSpace& space_;
    double late_from_;
    bool watched_ = true;
    std::vector<Piece> pieces_;
    Matrix frame_ = Matrix::Identity(); ///< the error is frame_ c, |c_i| <= spread_i
    Vector spread_ = Vector::Zero();
    Errors most_ = Errors::Zero(), now_ = Errors::Zero(); ///< over the step, and at its end
    EncounterBounds encounter_;
};

/// Value, rate and second derivative by v, `half` the step.
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

/// Rates and derivatives at step ends, the pieces, and rates at the nodes inside.
bool Prover::sample() {
    const std::size_t states = track_.states.size();
    PairJets &ends = space_.ends, &inner = space_.inner;
    ends.resize(states);
    for (std::size_t k = 0; k < states; ++k) {
        const std::array<double, 6>& y = track_.states[k];
        ends.at[PairJets::x][k] = y[0] - y[3];
        ends.at[PairJets::y][k] = y[1] - y[4];
        ends.at[PairJets::heading0][k] = y[2];
        ends.at[PairJets::heading1][k] = y[5];
    }
    if (states < 2 || !fill_jets(pair_.medium, pair_.couplings, ends))
        return false;
    inner.resize((states - 1) * nodes);
    pieces_.resize(states - 1);
    for (std::size_t k = 0; k + 1 < states; ++k) {
        Piece& piece = pieces_[k];
        piece.start = track_.times[k];
        piece.length = track_.times[k + 1] - track_.times[k];
        for (int i = 0; i < 4; ++i) {
            const auto coordinate = static_cast<std::size_t>(i);
            piece.p[coordinate] =
                Quintic::through(end_of(k, i, 0.5 * piece.length), end_of(k + 1, i, 0.5 * piece.length));
        }
        put_nodes(piece, inner, k * nodes);
    }
    return fill_jets(pair_.medium, pair_.couplings, inner);
}

void Prover::put_nodes(const Piece& piece, PairJets& jets, std::size_t row) const {
    for (std::size_t k = 0; k < 4; ++k)
        for (std::size_t j = 0; j < nodes; ++j)
            jets.at[k][row + j] = piece.p[k].at(node_at[j]);
}

/// From the jets at its nodes, which begin at this row.
Samples samples_of(const Piece& piece, const PairJets& jets, std::size_t row) {
    Samples samples;
    const double speed = 2.0 / piece.length;
    for (int j = 0; j < nodes; ++j, ++row) {
        const double v = node_at[static_cast<std::size_t>(j)];
        const double velocity[4] = {jets(PairJets::cosine0, row) - jets(PairJets::cosine1, row),
                                    jets(PairJets::sine0, row) - jets(PairJets::sine1, row),
                                    jets(PairJets::rate0, row), jets(PairJets::rate1, row)};
        for (int i = 0; i < 4; ++i) {
            const auto k = static_cast<std::size_t>(i);
            samples(j, defect_x + i) = speed * piece.p[k].slope(v) - velocity[i];
            samples(j, by_0 + i) = jets(PairJets::rate0 + 1 + k, row);
            samples(j, by_1 + i) = jets(PairJets::rate1 + 1 + k, row);
        }
        samples(j, rate_0) = velocity[2];
        samples(j, rate_0 + 1) = velocity[3];
    }
    return samples;
}

StepBounds Prover::bounds_of(const Piece& piece, const PairJets& jets, std::size_t row) const {
    const Samples samples = samples_of(piece, jets, row);
    const std::size_t middle = row + degree / 2;
    const double cosine[2] = {jets(PairJets::cosine0, middle), jets(PairJets::cosine1, middle)},
                 sine[2] = {jets(PairJets::sine0, middle), jets(PairJets::sine1, middle)};
    Eigen::Matrix<double, 1, column_count> mean, beyond;
    for (int k = 0; k < column_count; ++k) {
        const Spread spread = spread_of(samples.col(k).data());
        mean[k] = spread.mean;
        beyond[k] = spread.beyond;
    }
    StepBounds b;
    const double x = piece.p[0].c[0], y = piece.p[1].c[0];
    const double h[2] = {piece.p[2].c[0], piece.p[3].c[0]};
    b.distance = length_of(x, y);
    double ahead[2], width = 1.0;
    for (int rod = 0; rod < 2; ++rod) {
        const double sign = rod == 0 ? 1.0 : -1.0;
        ahead[rod] = b.distance + sign * (x * cosine[1 - rod] + y * sine[1 - rod]);
        if (ahead[rod] < 1e-3 * b.distance) { // without the cancellation
            const double across = y * cosine[1 - rod] - x * sine[1 - rod];
            ahead[rod] = across * across / (2.0 * b.distance - ahead[rod]);
        }
        width = std::min(width, bound_.suitable_width(b.distance, ahead[rod]));
    }
    const double all = std::log1p(width), half = 0.7 * all;
    const double whole = piece.wandering(1.0, b.distance);
    const double rho = ellipse_of(piece, b.distance, whole, all),
                 rho_slope = ellipse_of(piece, b.distance, whole, half);
    b.room = all - whole;
    b.mean.setZero();
    for (int rod = 0; rod < 2; ++rod) {
        const double sign = rod == 0 ? 1.0 : -1.0;
        b.mean(0, 2 + rod) = -sign * sine[rod];
        b.mean(1, 2 + rod) = sign * cosine[rod];
        b.turn[rod] = piece.p[2 + static_cast<std::size_t>(rod)].excursion(1.0);
    }
    const double reach = 0.5 * (rho + 1.0 / rho);
    double place_rest = 0.0;
    for (int rod = 0; rod < 2; ++rod) {
        const int by = rod == 0 ? by_0 : by_1;
        const TurningBound::Value most = bound_.at(b.distance, ahead[rod], width);
        b.rate[rod] = most.rate;
        b.change[rod] = share_ ? 0.0 : change_.at(b.distance, ahead[rod], width).rate;
        // where nothing is known of the ellipse the bound itself must do, on both sides of the expansion
        const double rest = most.rate * std::min(remainder_factor(rho), 4.0);
        const double slope_rest =
            most.rate * std::min(remainder_factor(rho_slope) / (all - half), 4.0 / b.room);
        const double rounding = 32.0 * proof_ulp * (most.parts + (std::abs(h[rod]) + 1.0) / piece.length);
        b.defect[1 + rod] = std::abs(mean[defect_0 + rod]) + beyond[defect_0 + rod] + rest + rounding;
        b.mean.row(2 + rod) = mean.segment<4>(by);
        b.by_place[rod] = b.mean.row(2 + rod).head<2>().norm();
        b.place_wobble[rod] = beyond.segment<2>(by).norm() + std::numbers::sqrt2 / b.distance * slope_rest;
        for (int k = 0; k < 2; ++k) {
            b.by_heading[rod][k] = std::abs(b.mean(2 + rod, 2 + k));
            b.heading_wobble[rod][k] = beyond[by + 2 + k] + slope_rest;
        }
        b.rate_most[rod] = std::abs(mean[rate_0 + rod]) + beyond[rate_0 + rod] + rest;
        b.rate_least[rod] = samples.col(rate_0 + rod).cwiseAbs().maxCoeff();
        place_rest += std::expm1(piece.p[2 + static_cast<std::size_t>(rod)].excursion(reach));
    }
    const auto of_place = [&](int k) {
        return std::abs(mean[k]) + beyond[k] + place_rest * remainder_factor(rho);
    };
    const double rounding = 32.0 * proof_ulp * (1.0 + b.distance / piece.length);
    b.defect[0] = length_of(of_place(defect_x), of_place(defect_y)) + rounding;
    return b;
}

/// The smallest g found with g >= f(g), f rising; nothing if it grows without end.
template<class Map>
std::optional<Errors> enclose(const Map& f) {
    Errors g = f(Errors::Zero());
    for (int k = 0; k < 40; ++k) {
        const Errors larger = 1.01 * g, next = f(larger);
        if ((next.array() <= larger.array()).all())
            return larger;
        if (!next.allFinite())
            return std::nullopt;
        g = next;
    }
    return std::nullopt;
}

/// exp(h J) by its series, scaled; what it leaves out is below `rest` of a unit error.
Matrix propagator(const Matrix& jacobian, double length, double& rest) {
    Matrix a = length * jacobian;
    double norm = a.cwiseAbs().rowwise().sum().maxCoeff();
    int squarings = 0;
    for (; norm > 0.25 && squarings < 20; ++squarings, norm *= 0.5)
        a *= 0.5;
    Matrix p = Matrix::Identity() + a / 6.0;
    for (int k = 5; k > 0; --k)
        p = (Matrix::Identity() + a * p / k).eval();
    rest = std::pow(norm, 7) / 5040.0 * std::exp(norm);
    for (; squarings > 0; --squarings) {
        rest = 2.0 * rest * p.cwiseAbs().rowwise().sum().maxCoeff() + rest * rest;
        p = (p * p).eval();
    }
    return p;
}

/// q r = a by Gram and Schmidt, columns as they come.
void orthogonalise(const Matrix& a, Matrix& q) {
    q = a;
    for (int k = 0; k < 4; ++k) {
        for (int j = 0; j < k; ++j)
            q.col(k) -= q.col(j).dot(q.col(k)) * q.col(j);
        for (int j = 0; j < k; ++j) // once more: columns may be nearly parallel
            q.col(k) -= q.col(j).dot(q.col(k)) * q.col(j);
        q.col(k).normalize();
    }
}

/// What other couplings change of a rate, at most.
double Prover::varied(const StepBounds& b, int rod, const Errors& e) const {
    return b.change[rod] + share_.value_or(0.0) * (b.rate_most[rod] + b.linear(rod, e) + b.curvature(rod, e));
}

bool Prover::propagate(const StepBounds& b, double length) {
    const auto coupled = [&](const Errors& e, int rod) { return b.linear(rod, e) + varied(b, rod, e); };
    const auto most = enclose([&](const Errors& e) {
        return Errors(now_ + length * (b.defect + Errors(e[1] + e[2], coupled(e, 0) + b.curvature(0, e),
                                                         coupled(e, 1) + b.curvature(1, e))));
    });
    if (!most)
        return false;
    most_ = *most;
    const Errors& e = most_;
    Errors source = b.defect;
    source[0] += b.turn[0] * e[1] + b.turn[1] * e[2] + 0.5 * (e[1] * e[1] + e[2] * e[2]);
    for (int rod = 0; rod < 2; ++rod)
        source[1 + rod] += b.place_wobble[rod] * e[0] + b.heading_wobble[rod][0] * e[1] +
                           b.heading_wobble[rod][1] * e[2] + b.curvature(rod, e) + varied(b, rod, e);
    const auto plain = [&](const Errors& g, int rod) {
        return b.by_place[rod] * g[0] + b.by_heading[rod][0] * g[1] + b.by_heading[rod][1] * g[2];
    };
    const auto added = enclose([&](const Errors& g) {
        return Errors(length * (source + Errors(g[1] + g[2], plain(g, 0), plain(g, 1))));
    });
    if (!added)
        return false;
    double rest = 0.0;
    const Matrix moved = propagator(b.mean, length, rest) * frame_;
    rest *= e.sum();
    Matrix next;
    orthogonalise(moved, next);
    const Vector g((*added)[0] + rest, (*added)[0] + rest, (*added)[1] + rest, (*added)[2] + rest);
    spread_ = ((next.transpose() * moved).cwiseAbs() * spread_ + next.cwiseAbs().transpose() * g).eval();
    spread_ *= 1.0 + 64.0 * proof_ulp;
    frame_ = next;
    const Vector end = frame_.cwiseAbs() * spread_;
    now_ = Errors(length_of(end[0], end[1]), end[2], end[3]).cwiseMin(most_);
    return now_.allFinite();
}

/// Whether the rods stay out of contact from v = low to high: they close in at `speed` (by v) at most.
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

/// Contact, and the last part of the run. False: contact cannot be excluded.
bool Prover::watch(const Piece& piece, const StepBounds& b) {
    constexpr int most_halvings = 40;
    const double angle = piece.p[2].c[0] - piece.p[3].c[0];
    const double half = 0.5 * piece.length,
                 speed =
                     half * (std::min(2.0, 2.0 * std::abs(std::sin(0.5 * angle)) + b.turn[0] + b.turn[1]) +
                             b.defect[0]);
    std::array<double, nodes> r;
    for (std::size_t j = 0; j < nodes; ++j)
        r[j] = piece.separation(node_at[j]);
    for (std::size_t j = 0; j + 1 < nodes; ++j)
        if (!stays_apart(piece, node_at[j], node_at[j + 1], r[j], r[j + 1], speed, most_halvings))
            return false;
    if (piece.start + piece.length < late_from_)
        return true;
    const double from = (late_from_ - piece.start) / half - 1.0, error = most_[0];
    Interval &least = encounter_.late_least, &most = encounter_.late_most, &turning = encounter_.late_turning;
    const auto seen = [&](double separation) {
        least.high = std::min(least.high, separation + error);
        most.low = std::max(most.low, separation - error);
    };
    for (std::size_t j = 0; j < nodes; ++j) {
        if (node_at[j] >= from)
            seen(r[j]);
        if (j + 1 < nodes && node_at[j + 1] >= from) {
            const double way = speed * (node_at[j + 1] - node_at[j]);
            least.low = std::min(least.low, 0.5 * (r[j] + r[j + 1] - way) - error);
            most.high = std::max(most.high, 0.5 * (r[j] + r[j + 1] + way) + error);
        }
    }
    if (from > -1.0)
        seen(piece.separation(std::min(from, 1.0)));
    for (int rod = 0; rod < 2; ++rod) {
        const double off = b.linear(rod, most_) + b.curvature(rod, most_) + varied(b, rod, most_);
        turning.high = std::max(turning.high, b.rate_most[rod] + off);
        if (from <= -1.0)
            turning.low = std::max(turning.low, b.rate_least[rod] - off);
    }
    return true;
}

/// A piece over which the error grows much, or that the bounds do not reach, is taken in halves.
bool Prover::advance(const Piece& piece, const PairJets& jets, std::size_t row, int depth) {
    constexpr double much = 0.5;
    const StepBounds b = bounds_of(piece, jets, row);
    double growth = 0.0;
    for (int rod = 0; rod < 2; ++rod)
        growth = std::max(growth, piece.length * (b.by_heading[rod][0] + b.by_heading[rod][1] +
                                                  b.heading_wobble[rod][0] + b.heading_wobble[rod][1] +
                                                  b.distance * (b.by_place[rod] + b.place_wobble[rod])));
    if (depth > 0 && !(b.room > 0.0 && growth < much))
        return advance_halves(piece, depth - 1);
    if (b.room > 0.0 && propagate(b, piece.length))
        return !watched_ || watch(piece, b);
    return depth > 0 && advance_halves(piece, depth - 1);
}

bool Prover::advance_halves(const Piece& piece, int depth) {
    for (const bool upper : {false, true}) {
        const Piece half = piece.half(upper);
        PairJets& few = space_.few;
        few.resize(nodes);
        put_nodes(half, few, 0);
        if (!fill_jets(pair_.medium, pair_.couplings, few) || !advance(half, few, 0, depth))
            return false;
    }
    return true;
}

/// Contact is certain if the rods, a little farther on, are nearer than that whatever they do.
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
    const double bend = 4.0 / ((1.0 - 3.0 * nearby) * r) + bound_.at(r, 0.0, width).rate * 2.0;
    const double left = pair_.t_end - track_.times[last];
    const double time = std::min({-rate / bend, left, nearby * r});
    if (r + now_[0] + time * (rate + 0.5 * bend * time) <
        pair_.contact_distance - 1e-9 * pair_.contact_distance)
        encounter_.contact = EncounterBounds::Contact::certain;
}

} // namespace

void PairTrack::add(double time, integrate::State y) {
    if (!times.empty() && !(time > times.back()))
        return;
    times.push_back(time);
    states.push_back({y[0], y[1], y[2], y[3], y[4], y[5]});
}

std::optional<EncounterBounds> proved_bounds(const PairProblem& pair, const PairTrack& track, bool contact,
                                             const EndingCriteria& criteria, ProofSpace& space,
                                             const PairSpread& spread) {
    return Prover(pair, track, criteria, space, spread).run(contact);
}

} // namespace rodwake::rods
