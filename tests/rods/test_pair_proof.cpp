// What proves the outcome of a pair: the parts of the bound against what they bound, the bound against runs
// at the tightest tolerance, cells of pairs against pairs within.

#include "random_pairs.hpp"

#include "rods/pair_jets.hpp"
#include "rods/pair_pieces.hpp"
#include "rods/pair_proof.hpp"
#include "rods/turning_bound.hpp"
#include "rodwake/rods/certificate.hpp"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>

using namespace rodwake;
using namespace rodwake::rods;

namespace {

constexpr double step = 1e-5; // of central differences: their error is step^2, and rounding over step

std::vector<double> state_of(const PairProblem& pair) { return to_state(pair.rods); }

/// Jets of one state, by the kernels.
PairJets jets_of(const PairProblem& pair) {
    PairJets jets;
    jets.resize(1);
    const std::vector<double> y = state_of(pair);
    const double columns[4] = {y[0] - y[3], y[1] - y[4], y[2], y[5]};
    for (std::size_t k = 0; k < 4; ++k)
        jets.at[k][0] = columns[k];
    REQUIRE(fill_jets(pair.medium, pair.couplings, jets));
    return jets;
}

double rate_of(const PairProblem& pair, std::size_t rod) {
    std::vector<double> rate(6);
    model_of(to_rod_problem(pair)).rhs(state_of(pair), rate);
    return rate[3 * rod + 2];
}

/// The pair with x, y of R_0 - R_1 or a heading moved.
PairProblem moved(PairProblem pair, std::size_t coordinate, double by) {
    double* const where[4] = {&pair.rods[0].x, &pair.rods[0].y, &pair.rods[0].heading, &pair.rods[1].heading};
    *where[coordinate] += by;
    return pair;
}

double difference_quotient(const PairProblem& pair, std::size_t rod, std::size_t coordinate) {
    return (rate_of(moved(pair, coordinate, step), rod) - rate_of(moved(pair, coordinate, -step), rod)) /
           (2.0 * step);
}

/// Of rod 0 in the wake of rod 1: where r + x is.
double ahead_of(const PairProblem& pair) {
    const double x = pair.rods[0].x - pair.rods[1].x, y = pair.rods[0].y - pair.rods[1].y;
    return std::hypot(x, y) + x * std::cos(pair.rods[1].heading) + y * std::sin(pair.rods[1].heading);
}

double distance_of(const PairProblem& pair) {
    return std::hypot(pair.rods[0].x - pair.rods[1].x, pair.rods[0].y - pair.rods[1].y);
}

/// Largest rate of rod 0, over `share` of the bound, at places within half the width.
double worst_share(const PairProblem& pair, RandomStream& random, double share) {
    const TurningBound bound(pair.medium, pair.couplings);
    const double r = distance_of(pair), width = bound.suitable_width(r, ahead_of(pair));
    const double most = share * bound.at(r, ahead_of(pair), width).rate;
    double worst = 0.0;
    for (int k = 0; k < 20; ++k) {
        const double way = 0.5 * width * r / std::numbers::sqrt2 * random.uniform(),
                     where = random.uniform(-std::numbers::pi, std::numbers::pi);
        worst = std::max(
            worst,
            std::abs(rate_of(moved(moved(pair, 0, way * std::cos(where)), 1, way * std::sin(where)), 0)) /
                most);
    }
    return worst;
}

/// The steps of a run.
StepTrack track_of(const PairProblem& pair, const PairOptions& options, PairResult& result) {
    StepTrack track;
    track.add(0.0, state_of(pair));
    PairOptions followed = options;
    followed.on_step = [&](std::size_t, const PairStep& one) { track.add(one.time, one.state); };
    std::vector<PairResult> results(1);
    simulate_pairs(std::span(&pair, 1), followed, results);
    result = results[0];
    return track;
}

/// Largest error of a final state over its bound; 0 where there is no bound, or the run ended early.
double share_of_bound(const PairProblem& pair, double shrunk, int& bounded) {
    PairResult run, exact;
    ProofSpace space;
    PairOptions options{3e-10, 3e-12};
    const StepTrack track = track_of(pair, options, run);
    track_of(pair, {1e-13, 1e-15, {}, 1'000'000}, exact);
    if (run.handed_over() || exact.handed_over() || run.ending == Ending::contact)
        return 0.0;
    const auto bounds = proved_bounds(pair, track, false, options.criteria, space);
    if (!bounds)
        return 0.0;
    ++bounded;
    const double rounding = 1e-11; // of the exact run: 1000 steps, coordinates up to 40
    const double x = run.state[0] - run.state[3] - exact.state[0] + exact.state[3],
                 y = run.state[1] - run.state[4] - exact.state[1] + exact.state[4];
    return std::max(
        {std::hypot(x, y) / (shrunk * bounds->place_error + rounding),
         std::abs(run.state[2] - exact.state[2]) / (shrunk * bounds->heading_error[0] + rounding),
         std::abs(run.state[5] - exact.state[5]) / (shrunk * bounds->heading_error[1] + rounding)});
}

} // namespace

TEST_CASE("Jets are the rates and their derivatives") {
    for (const bool polar : {false, true})
        for (const PairProblem& pair : random_pairs(20, 3, polar)) {
            const PairJets jets = jets_of(pair);
            for (const std::size_t rod : {0, 1}) {
                const std::size_t first = rod == 0 ? PairJets::rate0 : PairJets::rate1;
                const double size = TurningBound(pair.medium, pair.couplings)
                                        .at(distance_of(pair), 0.0, 0.1)
                                        .rate; // of the parts, and of derivatives over the distance
                CHECK(jets(first, 0) == Approx(rate_of(pair, rod)).margin(1e-12 * size));
                for (std::size_t k = 0; k < 4; ++k)
                    CHECK(jets(first + 1 + k, 0) ==
                          Approx(difference_quotient(pair, rod, k)).epsilon(1e-6).margin(1e-7 * size));
            }
        }
}

TEST_CASE("The bound of the turning rate holds about a place, and a fiftieth of it would not") {
    RandomStream random(5);
    double worst = 0.0, worst_of_part = 0.0;
    for (const bool polar : {false, true})
        for (const PairProblem& pair : random_pairs(100, 4, polar)) {
            worst = std::max(worst, worst_share(pair, random, 1.0));
            worst_of_part = std::max(worst_of_part, worst_share(pair, random, 0.02));
        }
    CHECK(worst < 1.0);
    CHECK(worst_of_part > 1.0);
}

TEST_CASE("The error of a run is below its bound, and above a millionth of it") {
    int bounded = 0, again = 0;
    double worst = 0.0, worst_of_little = 0.0;
    for (const bool polar : {false, true})
        for (const PairProblem& pair : random_pairs(40, 6, polar)) {
            worst = std::max(worst, share_of_bound(pair, 1.0, bounded));
            worst_of_little = std::max(worst_of_little, share_of_bound(pair, 1e-6, again));
        }
    CHECK(bounded >= 60);
    CHECK(worst < 1.0);
    CHECK(worst_of_little > 1.0);
}

namespace {

/// Numbers of a pair that the polynomials are of, with their first two derivatives by v, `half` a step.
std::array<std::array<double, 3>, 4> ends_of(const PairProblem& pair, double half) {
    const PairJets jets = jets_of(pair);
    const auto at = [&](std::size_t column) { return jets(column, 0); };
    const double rate[2] = {at(PairJets::rate0), at(PairJets::rate1)};
    const double c[2] = {at(PairJets::cosine0), at(PairJets::cosine1)},
                 s[2] = {at(PairJets::sine0), at(PairJets::sine1)};
    const double velocity[4] = {c[0] - c[1], s[0] - s[1], rate[0], rate[1]};
    double second[4] = {s[1] * rate[1] - s[0] * rate[0], c[0] * rate[0] - c[1] * rate[1], 0.0, 0.0};
    for (std::size_t k = 0; k < 4; ++k) {
        second[2] += velocity[k] * at(PairJets::rate0 + 1 + k);
        second[3] += velocity[k] * at(PairJets::rate1 + 1 + k);
    }
    std::array<std::array<double, 3>, 4> ends;
    for (std::size_t i = 0; i < 4; ++i)
        ends[i] = {at(i), half * velocity[i], half * half * second[i]};
    return ends;
}

/// The pair's piece of this length, one that ends with its first heading wrong by `wrong`, and where the
/// exact solution is then.
struct WrongPiece {
    ProofPiece of;
    std::array<double, 4> error; ///< at the end
};

WrongPiece wrong_piece(PairProblem pair, double length, double wrong) {
    PairProblem later = pair;
    later.t_end = length;
    later.contact_distance = 0.0;
    const PairResult exact = results_of({later}, {1e-13, 1e-15, {}, 1'000'000})[0];
    for (std::size_t rod = 0; rod < 2; ++rod)
        later.rods[rod] = {exact.state[3 * rod], exact.state[3 * rod + 1], exact.state[3 * rod + 2]};
    const auto low = ends_of(pair, 0.5 * length);
    auto high = ends_of(later, 0.5 * length);
    high[2][0] += wrong;
    WrongPiece piece{};
    piece.of.piece.length = length;
    for (std::size_t i = 0; i < 4; ++i)
        piece.of.piece.p[i] = Quintic::through(low[i], high[i]);
    piece.error = {0.0, 0.0, -wrong, 0.0};
    find_reach(pair.medium, {pair.couplings, pair.couplings, {0.0, 0.0, 0.0}}, std::span(&piece.of, 1));
    const std::array<std::size_t, 1> which{0};
    REQUIRE(expand(pair.medium, pair.couplings, std::span(&piece.of, 1), which));
    return piece;
}

/// Of |error + drift|, the largest over the bound; the curvature of an error of 1e-6 is below `rounding`.
double share_of_known(const WrongPiece& piece) {
    constexpr double rounding = 1e-11;
    const PieceExpansion<double>& seen = piece.of.seen;
    double worst = 0.0;
    for (std::size_t i = 0; i < 4; ++i) {
        const std::size_t row = i < 2 ? 0 : i - 1;
        double bound = rounding;
        for (std::size_t k = 0; k < 3; ++k)
            bound += piece.of.piece.length * seen.grown[row][k] * seen.known[k];
        worst = std::max(worst, std::abs(piece.error[i] + seen.drift[i]) / bound);
    }
    return worst;
}

/// |p' - f(p)| of the headings between the nodes, the largest over the bound.
double share_of_defect(const PairProblem& pair, const WrongPiece& piece) {
    double worst = 0.0;
    for (int k = 0; k <= 50; ++k) {
        const auto& p = piece.of.piece.p;
        const double v = -1.0 + k / 25.0;
        PairProblem there = pair;
        there.rods = {Pose{p[0].at(v), p[1].at(v), p[2].at(v)}, Pose{0.0, 0.0, p[3].at(v)}};
        for (const std::size_t rod : {0, 1}) {
            const double defect = p[2 + rod].slope(v) * 2.0 / piece.of.piece.length - rate_of(there, rod);
            worst = std::max(worst, std::abs(defect) / piece.of.seen.defect[1 + rod]);
        }
    }
    return worst;
}

} // namespace

TEST_CASE("A piece that ends wrong by 1e-6 is known to, and what is not known is bounded, by a hundred times "
          "less") {
    double known = 0.0, defect = 0.0, of_less = 0.0;
    int pieces = 0;
    for (const bool polar : {false, true})
        for (const PairProblem& pair : random_pairs(60, 21, polar)) {
            const WrongPiece piece =
                wrong_piece(pair, 0.1 / std::sqrt(1.0 + std::abs(pair.couplings.kappa)), 1e-6);
            if (!(piece.of.reach.missed < 1e-9 && piece.of.seen.growth < 0.5))
                continue;
            ++pieces;
            known = std::max(known, share_of_known(piece));
            defect = std::max(defect, share_of_defect(pair, piece));
            of_less = std::max(of_less, piece.of.piece.length * piece.of.seen.known[1]);
        }
    CHECK(pieces > 60);
    CHECK(known < 1.0);
    CHECK(known > 1e-3);
    CHECK(defect < 1.0);
    CHECK(defect > 0.3);
    CHECK(of_less < 1e-8);
}

namespace {

/// Pairs between two corners of a box, the other corners and some more.
std::vector<PairProblem> within(const PairProblem& low, const PairProblem& high, RandomStream& random) {
    std::vector<PairProblem> pairs;
    for (int k = 0; k < 20; ++k) {
        const auto share = [&](double a, double b) {
            const double u = k < 10 ? static_cast<double>(random.uniform() < 0.5) : random.uniform();
            return a + u * (b - a);
        };
        PairProblem pair = low;
        pair.couplings.kappa = share(low.couplings.kappa, high.couplings.kappa);
        pair.rods[1].x = share(low.rods[1].x, high.rods[1].x);
        pair.rods[1].heading = share(low.rods[1].heading, high.rods[1].heading);
        pairs.push_back(pair);
    }
    return pairs;
}

} // namespace

TEST_CASE("Boxes of pairs that are proved to end alike do, and boxes across a boundary are not") {
    RandomStream random(17);
    const PairOptions options{1e-8, 1e-10};
    int boxes = 0, uniform = 0, mixed = 0;
    for (PairProblem low : random_pairs(40, 16, false)) {
        low.couplings.kappa = std::clamp(low.couplings.kappa, -3.0, 3.0);
        PairProblem high = low;
        const double size = random.log_uniform(1e-5, 0.3);
        high.couplings.kappa *= 1.0 + size;
        high.rods[1].x += size;
        high.rods[1].heading += size;
        const std::vector<PairProblem> pairs = within(low, high, random);
        const std::vector<PairResult> ends = results_of(pairs, options);
        const bool alike = std::ranges::all_of(
            ends, [&](const PairResult& one) { return !one.handed_over() && one.ending == ends[0].ending; });
        const std::array corners{low, high};
        const bool reported = all_end(corners, ends[0].ending, options);
        CHECK((alike || !reported));
        ++boxes;
        uniform += reported;
        mixed += !alike;
    }
    CHECK(uniform > boxes / 6);
    CHECK(mixed > 0);
}

TEST_CASE("A box of pairs of more than one kind, or of another ending, is not proved") {
    PairProblem low;
    low.medium = {1.0, 1.0};
    low.couplings.kappa = 0.3;
    low.rods = {Pose{0.0, 0.0, 0.0}, Pose{5.0, -4.0, -1.5}};
    low.t_end = 40.0;
    low.contact_distance = 0.1;
    PairProblem high = low;
    high.couplings.kappa = 0.31;
    high.rods[1].x += 0.05;
    const PairOptions options{1e-8, 1e-10};
    const Ending ending = results_of({low}, options)[0].ending;
    CHECK(all_end(std::array{low, high}, ending, options));
    CHECK(all_end(std::array{high, low}, ending, options));
    CHECK_FALSE(all_end(std::array{low, high}, Ending::contact, options));
    PairProblem far = low;
    far.rods[1].x -= 9.0; // across a collision course
    CHECK_FALSE(all_end(std::array{low, high, far}, ending, options));
    high.medium.eta = 1.1;
    CHECK_FALSE(all_end(std::array{low, high}, ending, options));
}

TEST_CASE("Derivatives are bounded by what is left of the width where a piece needs most of it") {
    int pieces = 0;
    for (const PairProblem& pair : random_pairs(12, 23, true)) {
        double low = 0.0, high = 20.0; // of the length at which the bounds end
        for (int k = 0; k < 24; ++k) { // to 1e-6
            const double middle = 0.5 * (low + high);
            (wrong_piece(pair, middle, 0.0).of.reach.room > 0.0 ? low : high) = middle;
        }
        const PieceReach<double> reach = wrong_piece(pair, low, 0.0).of.reach;
        if (!(reach.room > 0.0 && reach.room < 0.01))
            continue;
        ++pieces;
        for (const std::size_t rod : {0, 1}) // 4: Cauchy's estimate, and interpolation at the nodes
            CHECK(reach.phase_rest[rod] >= 3.99 * reach.rate[rod] / reach.room);
    }
    CHECK(pieces > 5);
}
