// g(r), g_B(r) and the accumulator of a run against direct sums and beds whose order is known.

#include "order_beds.hpp"
#include "rodwake/core/error.hpp"
#include "synthetic.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <limits>

using namespace rodwake;
using namespace rodwake::measure;
using namespace order_beds;
using synthetic::reduced;
using synthetic::saved;

namespace {

OrderAccumulator accumulator_of(const std::vector<Bed>& beds, const OrderOptions& k, double interval = 0.5) {
    OrderAccumulator accumulator(layout_of(beds.front()), k);
    for (std::size_t f = 0; f < beds.size(); ++f)
        accumulator.add(frame_of(beds[f], interval * static_cast<double>(f)));
    return accumulator;
}

OrderAccumulator copy_of(const OrderAccumulator& accumulator) {
    return synthetic::through_packing(accumulator,
                                      OrderAccumulator(accumulator.layout(), accumulator.options()));
}

/// g, g_B and psi_6 by definition.
struct Plain {
    std::vector<double> g, order, order_pairs;
    double psi6 = 0.0;
};

Plain plain(const std::vector<Bed>& beds, const OrderOptions& k, double cutoff) {
    const double box = beds.front().box, n = static_cast<double>(beds.front().x.size());
    const auto bins = static_cast<std::size_t>(box / 2.0 / k.bin + 1e-9),
               order_bins = static_cast<std::size_t>(box / 2.0 / k.order_bin + 1e-9);
    Plain p{std::vector<double>(bins), std::vector<double>(order_bins), std::vector<double>(order_bins)};
    for (const Bed& bed : beds) {
        const auto psi = plain_psi6(bed, cutoff);
        std::complex<double> sum = 0.0;
        for (std::size_t i = 0; i < psi.size(); ++i) {
            sum += psi[i];
            for (std::size_t j = 0; j < i; ++j) {
                const double r = std::hypot(std::remainder(bed.x[i] - bed.x[j], box),
                                            std::remainder(bed.y[i] - bed.y[j], box));
                if (r < static_cast<double>(bins) * k.bin)
                    p.g[static_cast<std::size_t>(r / k.bin)] += 1.0;
                if (r < static_cast<double>(order_bins) * k.order_bin) {
                    p.order_pairs[static_cast<std::size_t>(r / k.order_bin)] += 1.0;
                    p.order[static_cast<std::size_t>(r / k.order_bin)] +=
                        std::real(std::conj(psi[i]) * psi[j]);
                }
            }
        }
        p.psi6 += std::abs(sum) / n / static_cast<double>(beds.size());
    }
    for (std::size_t b = 0; b < bins; ++b) {
        const double inner = static_cast<double>(b) * k.bin, outer = inner + k.bin;
        p.g[b] /= static_cast<double>(beds.size()) * n * (n - 1.0) / 2.0 * M_PI *
                  (outer * outer - inner * inner) / (box * box);
    }
    return p;
}

double largest_difference(const OrderResult& result, const Plain& p) {
    REQUIRE(result.g.size() == p.g.size());
    double largest = std::abs(result.psi6.value - p.psi6);
    for (std::size_t b = 0; b < p.g.size(); ++b)
        largest = std::max(largest, std::abs(result.g[b] - p.g[b]) / std::max(1.0, p.g[b]));
    std::size_t shown = 0;
    for (std::size_t b = 0; b < p.order.size(); ++b)
        if (p.order_pairs[b] > 0.0) {
            largest = std::max(largest, std::abs(result.order_pairs.at(shown) - p.order_pairs[b]));
            largest = std::max(largest, std::abs(result.g_B[shown] - p.order[b] / p.order_pairs[b]));
            ++shown;
        }
    REQUIRE(result.g_B.size() == shown);
    return largest;
}

/// Values are finite, errors finite or unknown.
bool finite(const OrderResult& result) {
    const auto all = [](const std::vector<double>& v) {
        return std::ranges::all_of(v, [](double x) { return std::isfinite(x); });
    };
    const auto errors = [](const std::vector<double>& v) {
        return std::ranges::all_of(v, [](double x) { return std::isnan(x) || (x >= 0.0 && !std::isinf(x)); });
    };
    const DecayClass& d = result.decay;
    return all(result.r) && all(result.g) && all(result.order_r) && all(result.g_B) &&
           all(result.order_pairs) && errors(result.g_error) && errors(result.g_B_error) &&
           errors({result.psi6.error, d.exponent.error, d.length.error, d.plateau.error}) &&
           all({result.psi6.value, result.local_psi6.value, result.neighbours.value, result.cutoff,
                d.exponent.value, d.length.value, d.plateau.value, d.chi2_algebraic, d.chi2_exponential,
                d.chi2_constant});
}

std::vector<Bed> gas(std::size_t frames, std::size_t beads, double box, std::uint64_t seed) {
    std::vector<Bed> beds;
    for (std::size_t f = 0; f < frames; ++f)
        beds.push_back(random_bed(beads, box, seed + f));
    return beds;
}

std::vector<Bed> crystals(std::size_t frames) {
    std::vector<Bed> beds;
    for (std::size_t f = 0; f < frames; ++f)
        beds.push_back(crystal(12, 14, 27.0 * radius, 0.25 * radius, 40 + f));
    return beds;
}

} // namespace

TEST_CASE("g, g_B and psi_6 equal direct sums", "[order]") {
    OrderOptions k = options();
    for (const double box : {78.0 * radius, 30.3 * radius}) { // bins that fit the box and bins that do not
        std::vector<Bed> beds = gas(3, 150, box, 8);
        k.cutoff = 4.0 * radius;
        // sums of 1e4 terms of size 1, roundings 1e-16 each: 1e-14 of g_B; the definition's angles cost more
        const OrderResult result = reduced(accumulator_of(beds, k));
        CHECK(largest_difference(result, plain(beds, k, *k.cutoff)) < 1e-12);
        beds[1].x[7] = into_box(beds[1].x[7] + 2.0 * radius, box);
        CHECK(largest_difference(result, plain(beds, k, *k.cutoff)) > 1e-6);
    }
}

TEST_CASE("g by kinds equals direct sums, and all kinds together g", "[order]") {
    const double box = 30.3 * radius;
    const std::vector<Bed> beds = gas(3, 150, box, 8);
    for (const std::size_t kinds : {2U, 3U}) {
        OrderOptions k = options();
        k.bin = 0.5 * radius;
        Layout layout = layout_of(beds[0]);
        for (std::size_t p = 0; p < kinds; ++p)
            layout.kind_radii.push_back(radius * (1.0 + static_cast<double>(p)));
        OrderAccumulator accumulator(layout, k);
        std::vector<double> of_kind(kinds);
        std::vector<std::uint8_t> kind;
        for (std::size_t i = 0; i < 150; ++i) {
            kind.push_back(static_cast<std::uint8_t>(i % 5 % kinds));
            ++of_kind[kind.back()];
        }
        for (std::size_t f = 0; f < beds.size(); ++f) {
            Frame frame = frame_of(beds[f], 0.5 * static_cast<double>(f));
            frame.kind = kind;
            accumulator.add(frame);
            accumulator = copy_of(accumulator); // frames that wait for a cut-off keep their kinds
        }
        const OrderResult result = reduced(accumulator);
        REQUIRE(result.kinds.size() == kinds * (kinds + 1) / 2);
        std::vector<double> sum(result.g.size());
        for (const KindCorrelation& pair : result.kinds) {
            const double p = of_kind[pair.kind], q = of_kind[pair.other],
                         in_all = pair.kind == pair.other ? 0.5 * p * (p - 1.0) : p * q;
            std::vector<double> counted(result.g.size());
            for (const Bed& bed : beds)
                for (std::size_t i = 0; i < 150; ++i)
                    for (std::size_t j = 0; j < i; ++j) {
                        const double r = std::hypot(std::remainder(bed.x[i] - bed.x[j], box),
                                                    std::remainder(bed.y[i] - bed.y[j], box));
                        const auto [low, high] = std::minmax(kind[i], kind[j]);
                        const bool is_it = low == pair.kind && high == pair.other;
                        if (const auto bin = static_cast<std::size_t>(r / k.bin);
                            is_it && bin < counted.size())
                            counted[bin] += 1.0;
                    }
            for (std::size_t b = 0; b < counted.size(); ++b) {
                const double ring = M_PI * k.bin * k.bin * (2.0 * static_cast<double>(b) + 1.0);
                REQUIRE(pair.g[b] == Approx(counted[b] * box * box / (3.0 * in_all * ring)).epsilon(1e-12));
                REQUIRE((pair.g_error[b] > 0.0 || pair.g[b] > 0.0));
                sum[b] += pair.g[b] * in_all / (0.5 * 150.0 * 149.0);
            }
        }
        for (std::size_t b = 0; b < sum.size(); ++b)
            REQUIRE(sum[b] == Approx(result.g[b]).epsilon(1e-12));
        Frame nameless = frame_of(beds[0], 9.0);
        CHECK_THROWS_WITH(accumulator.add(nameless), Catch::Contains("names the kinds of 0"));
    }
}

TEST_CASE("an ideal gas has g = 1 within three sigma in each bin", "[order]") {
    const double box = 80.0 * radius;
    OrderOptions k = options();
    k.bin = k.order_bin = 2.0 * radius; // 20 bins: all of them within three sigma 19 times of 20
    k.cutoff = 3.0 * radius;
    k.block = 1.0;
    const std::size_t frames = 40, beads = 300;
    const OrderResult result = reduced(accumulator_of(gas(frames, beads, box, 1000), k));
    double chi2 = 0.0, error_ratio = 0.0;
    for (std::size_t b = 0; b < result.g.size(); ++b) {
        // distances of different pairs are independent two by two, so the number of pairs is as if binomial
        const double share = M_PI * k.bin * k.bin * (2.0 * static_cast<double>(b) + 1.0) / (box * box);
        const double pairs = static_cast<double>(frames * beads * (beads - 1)) / 2.0 * share;
        const double sigma = std::sqrt((1.0 - share) / pairs);
        CHECK(std::abs(result.g[b] - 1.0) < 3.0 * sigma);
        chi2 += std::pow((result.g[b] - 1.0) / sigma, 2);
        error_ratio += result.g_error[b] / sigma / 20.0;
    }
    REQUIRE(result.g.size() == 20);
    CHECK(chi2_probability(chi2, 20) > 0.001); // neither too much scatter
    CHECK(chi2_probability(chi2, 20) < 0.999); // nor too little
    // 20 blocks: errors are known to 1/sqrt(40) = 16 % each, the mean of 20 to 4 %; a factor for correlation
    // of noise adds a few percent
    CHECK(error_ratio > 0.85);
    CHECK(error_ratio < 1.25);
}

TEST_CASE("beads that repel are no ideal gas", "[order]") {
    const OrderResult result = reduced(accumulator_of(crystals(4), options()));
    CHECK(result.g[20] == 0.0);      // 1 a apart
    CHECK(result.g_error[20] > 0.0); // as much as one pair
    CHECK(*std::ranges::max_element(result.g) > 3.0);
    CHECK(result.psi6.value > 0.7);
    CHECK(finite(result));
}

TEST_CASE("g_B of a perfect lattice is 1 at all distances", "[order]") {
    const Bed bed = hexagon(6, 2.2 * radius, 0.2, 78.0 * radius);
    OrderOptions k = options();
    k.cutoff = 3.0 * radius;
    const OrderResult result = reduced(accumulator_of({bed, bed}, k));
    CHECK(result.g_B.size() > 15);
    for (const double g_B : result.g_B)
        CHECK(std::abs(g_B - 1.0) < 1e-12); // angles of single bonds, 6 * 1e-14
    CHECK(std::abs(result.psi6.value - 1.0) < 1e-14);
    CHECK(std::abs(result.local_psi6.value - 1.0) < 1e-14);
}

TEST_CASE("moving all beads together changes nothing beyond rounding", "[order]") {
    std::vector<Bed> beds = crystals(3), there;
    for (const Bed& bed : beds)
        there.push_back(shifted(bed, 0.37 * bed.box, -0.81 * bed.box));
    for (const Neighbours rule : {Neighbours::cutoff, Neighbours::delaunay}) {
        OrderOptions k = options();
        k.neighbours = rule;
        const OrderResult first = reduced(accumulator_of(beds, k)),
                          second = reduced(accumulator_of(there, k));
        CHECK(first.g == second.g); // no pair of these lies within rounding of a bin's edge
        CHECK(first.cutoff == second.cutoff);
        CHECK(std::abs(first.psi6.value - second.psi6.value) < 1e-12);
        for (std::size_t i = 0; i < first.g_B.size(); ++i)
            CHECK(std::abs(first.g_B[i] - second.g_B[i]) < 1e-12);
    }
}

TEST_CASE("order in a dish: beads at the wall are left out of psi6, and sums go on from their saved state",
          "[order]") {
    const Bed bed = hexagon(13, 2.1 * radius, 0.3, 60.0 * radius);
    Layout layout = layout_of(bed);
    layout.window = room_within(true, 60.0 * radius, radius);
    CHECK(layout.window->radius == Approx(29.1 * radius));
    OrderOptions k = options();
    k.cutoff = 2.9 * radius;
    OrderAccumulator accumulator(layout, k);
    accumulator.add(frame_of(bed, 0.0));
    accumulator.add(frame_of(bed, 0.5));
    CHECK(saved(copy_of(accumulator)) == saved(accumulator));
    const OrderResult result = reduced(accumulator);
    CHECK(result.at_border.value() > 0.0); // the hexagon's corners
    const OrderResult again = reduced(copy_of(accumulator));
    CHECK(again.g == result.g);
    CHECK(again.at_border == result.at_border);
}

TEST_CASE("what a camera's errors take from psi6 and g_B is given back", "[order]") {
    const double sigma = 0.08 * radius;
    Bed bed = hexagon(20, 2.15 * radius, 0.3, 90.0 * radius);
    Layout layout = layout_of(bed);
    layout.window = Window::circle(45.0 * radius, 45.0 * radius, 37.0 * radius);
    for (std::size_t i = bed.x.size(); i-- > 0;)
        if (layout.window->inside_by(bed.x[i], bed.y[i]) < sigma * 6.0) {
            bed.x.erase(bed.x.begin() + static_cast<std::ptrdiff_t>(i));
            bed.y.erase(bed.y.begin() + static_cast<std::ptrdiff_t>(i));
        }
    layout.beads = bed.x.size();
    RandomStream random(4);
    for (auto* row : {&bed.x, &bed.y})
        for (double& place : *row)
            place += sigma * normal(random);
    OrderOptions k = options();
    k.cutoff = 2.9 * radius;
    const auto result_of = [&](double localisation) {
        k.localisation = localisation;
        OrderAccumulator accumulator(layout, k);
        accumulator.add(frame_of(bed, 0.0));
        return reduced(accumulator);
    };
    const OrderResult seen = result_of(0.0), given_back = result_of(sigma);
    CHECK(seen.psi6.value < 0.96); // exp(-36 sigma^2/r^2) = 0.951
    // About 1000 beads with 6 bonds of scatter 6 sqrt(2) sigma/r = 0.32 in the phase each.
    CHECK(given_back.psi6.value == Approx(1.0).margin(0.01));
    CHECK(given_back.g_B.back() == Approx(1.0).margin(0.02));
    CHECK(given_back.local_psi6.value == seen.local_psi6.value);
}

TEST_CASE("a accumulator goes on from its saved state to the bit, also while frames wait", "[order]") {
    const std::vector<Bed> beds = crystals(12);
    for (const Neighbours rule : {Neighbours::cutoff, Neighbours::delaunay}) {
        OrderOptions k = options();
        k.neighbours = rule;
        k.cutoff_frames = 5;
        k.block = 1.5;
        const std::vector<double> whole = saved(accumulator_of(beds, k));
        for (const std::size_t stop : {0, 3, 5, 8}) {
            OrderAccumulator accumulator(layout_of(beds.front()), k);
            for (std::size_t f = 0; f < beds.size(); ++f) {
                if (f == stop)
                    accumulator = copy_of(accumulator);
                accumulator.add(frame_of(beds[f], 0.5 * static_cast<double>(f)));
            }
            CHECK(saved(accumulator) == whole);
        }
        OrderAccumulator other = accumulator_of(beds, k); // the comparison can tell
        other.add(frame_of(beds[0], 6.0));
        CHECK(saved(other) != whole);
    }
}

TEST_CASE("a state that belongs to something else is refused", "[order]") {
    const OrderAccumulator accumulator = accumulator_of(crystals(3), options());
    std::vector<double> row = saved(accumulator);
    OrderAccumulator other(layout_of(random_bed(100, 27.0 * radius, 1)), options());
    StateReader foreign(row, "test");
    CHECK_THROWS_AS(other.load(foreign), RunError);
    row.pop_back();
    OrderAccumulator same(accumulator.layout(), options());
    StateReader truncated(row, "test");
    CHECK_THROWS_AS((same.load(truncated), truncated.finish()), RunError);
}

TEST_CASE("the cut-off is settled by the first frames, or by all if they are fewer", "[order]") {
    const std::vector<Bed> beds = crystals(6);
    OrderOptions k = options();
    k.cutoff_frames = 4;
    const OrderAccumulator settled = accumulator_of(beds, k);
    const std::vector<Bed> first(beds.begin(), beds.begin() + 4), three(beds.begin(), beds.begin() + 3);
    CHECK(settled.cutoff() == accumulator_of(first, k).cutoff());
    // between the first two shells, 2.25 a and 3.9 a
    CHECK(settled.cutoff() > 2.7 * radius);
    CHECK(settled.cutoff() < 3.5 * radius);
    const OrderAccumulator waiting = accumulator_of(three, k);
    CHECK(waiting.cutoff() == 0.0);
    OrderOptions fixed = k;
    fixed.cutoff = waiting.settled_cutoff().value;
    const auto a = waiting.blocks(), b = accumulator_of(three, fixed).blocks();
    REQUIRE(a.size() == b.size());
    CHECK(a[0].order == b[0].order);
    CHECK(a[0].frames == 3.0);
    CHECK(waiting.cutoff() == 0.0); // asking settles nothing
    const std::vector<OrderAccumulator> runs = {settled, waiting};
    CHECK(reduce(runs).cutoff == 0.5 * (settled.cutoff() + *fixed.cutoff));
    CHECK(reduce(runs).cutoffs_by_spacing == 0);
}

TEST_CASE("without a minimum of g(r) the cut-off comes from the density, and the result says so", "[order]") {
    const OrderResult result = reduced(accumulator_of(gas(20, 500, 78.0 * radius, 4), options()));
    CHECK(result.cutoffs_by_spacing == 1);
    CHECK_FALSE(result.g_minimum.has_value());
    const double phi = 500.0 * M_PI / (78.0 * 78.0);
    CHECK(result.cutoff ==
          Approx(1.4 * 2.0 * radius * std::sqrt(M_PI / std::sqrt(12.0) / phi)).epsilon(1e-12));
    CHECK(result.decay.decay == Decay::exponential);
}

TEST_CASE("one frame, two beads and empty bins give numbers with unknown errors", "[order]") {
    const OrderResult single = reduced(accumulator_of(crystals(1), options()));
    CHECK(finite(single));
    CHECK(single.blocks == 1);
    CHECK_FALSE(single.psi6.known());
    CHECK(single.decay.decay == Decay::undetermined);
    CHECK(std::ranges::all_of(single.g_B_error, [](double e) { return std::isnan(e); }));
    CHECK(finite(reduced(accumulator_of(gas(5, 2, 30.0 * radius, 6), options()))));
    CHECK(finite(reduced(accumulator_of(gas(5, 9, 8.0 * radius, 6), options()))));
}

TEST_CASE("blocks are counted by time and distinguished", "[order]") {
    OrderOptions k = options();
    k.cutoff = 3.0 * radius;
    k.block = 2.0;
    const auto blocks = accumulator_of(crystals(9), k).blocks(); // every 0.5 s
    REQUIRE(blocks.size() == 3);
    CHECK(blocks[0].frames == 4.0);
    CHECK(blocks[2].frames == 1.0);
    const OrderResult result =
        reduce(std::vector{accumulator_of(crystals(9), k), accumulator_of(crystals(4), k)});
    CHECK(result.frames == 13);
    CHECK(result.blocks == 4);
    CHECK(result.psi6.known());
}

TEST_CASE("what cannot be measured is refused", "[order]") {
    const Layout layout = layout_of(random_bed(10, 30.0 * radius, 1));
    const auto refused = [&](auto change) {
        OrderOptions k = options();
        change(k);
        CHECK_THROWS_AS(OrderAccumulator(layout, k), InputError);
    };
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const double bad : {0.0, -1.0, nan, 1e300, 1e-12}) {
        refused([bad](OrderOptions& k) { k.bin = bad; });
        if (bad != 1e300 && bad != 1e-12)
            refused([bad](OrderOptions& k) { k.block = bad; });
        if (bad != 1e-12)
            refused([bad](OrderOptions& k) { k.cutoff = bad; });
    }
    refused([](OrderOptions& k) { k.order_bin = 1.5 * k.bin; });
    refused([](OrderOptions& k) { k.order_bin = 0.0; });
    refused([](OrderOptions& k) { k.cutoff_frames = 0; });
    CHECK_THROWS_AS(OrderAccumulator(layout_of(random_bed(1, 30.0 * radius, 1)), options()), InputError);

    CHECK_THROWS_AS(reduce(std::vector<OrderAccumulator>{}), InputError);
    CHECK_THROWS_AS(reduce(std::vector<OrderAccumulator>{{layout, options()}}), InputError);
    OrderOptions other = options();
    other.block = 3.0;
    const std::vector<OrderAccumulator> mixed = {accumulator_of(crystals(2), options()),
                                                 accumulator_of(crystals(2), other)};
    CHECK_THROWS_AS(reduce(mixed), InputError);
    OrderAccumulator accumulator(layout, options());
    CHECK_THROWS_AS(accumulator.add(frame_of(random_bed(11, 30.0 * radius, 1), 0.0)), RunError);
    CHECK_THROWS_AS(accumulator.add(frame_of(random_bed(10, 90.0 * radius, 1), 0.0)), RunError); // wrong box
}
