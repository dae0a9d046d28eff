// Where points lie: axes, grids, lists, Latin hypercubes and Sobol' points.

#include "maps.hpp"
#include "rodwake/core/error.hpp"

#include <catch2/catch.hpp>

using namespace scan_test;

namespace {

Design sampled(Kind kind, long samples, std::size_t axes) {
    Design design;
    design.kind = kind;
    design.samples = samples;
    for (std::size_t k = 0; k < axes; ++k)
        design.axes.push_back(axis("u" + std::to_string(k), 0.0, 1.0, 2));
    return design;
}

std::vector<Point> all(const Design& design) {
    const PointList list(design);
    std::vector<Point> points;
    for (std::int64_t id = 0; id < list.size(); ++id)
        points.push_back(list[id]);
    return points;
}

/// How many of `slices` equal slices of an axis hold exactly `each` points.
long even_slices(const std::vector<Point>& points, std::size_t axis, long slices, long each) {
    std::vector<long> held(static_cast<std::size_t>(slices), 0);
    for (const Point& point : points)
        ++held[static_cast<std::size_t>(point.at[axis] * static_cast<double>(slices))];
    return std::ranges::count(held, each);
}

Axis log_axis(double from, double to) {
    Axis made = axis("k", from, to, 5);
    made.spacing = Spacing::log;
    return made;
}

} // namespace

TEST_CASE("Ends of axes are exact, and nothing lies beyond them") {
    for (const Axis& one : {axis("k", 0.1, 0.7, 2), axis("k", 0.7, 0.1, 2), axis("k", -1e308, 1e308, 2),
                            log_axis(0.1, 100.0), log_axis(100.0, 0.1), log_axis(-1e-3, -1e6),
                            log_axis(1e-300, 1e300), log_axis(0.1, 0.1000000000000001)}) {
        INFO(one.from << " to " << one.to);
        CHECK(one.at(0.0) == one.from);
        CHECK(one.at(1.0) == one.to);
        double last = one.from;
        const double sign = one.to > one.from ? 1.0 : -1.0;
        bool ordered = true;
        for (int i = 0; i <= 1000; ++i) {
            const double value = one.at(i == 1000 ? std::nextafter(1.0, 0.0) : i / 1000.0);
            ordered = ordered && (value - last) * sign >= 0.0 && (one.to - value) * sign >= 0.0;
            last = value;
        }
        CHECK(ordered);
    }
}

TEST_CASE("Logarithmic axes have equal ratios, for both signs") {
    // three roundings of log and exp at |log| <= 7: 1e-14 is 20 of them
    for (const double sign : {1.0, -1.0})
        for (int i = 0; i <= 4; ++i)
            CHECK(log_axis(0.1 * sign, 1000.0 * sign).at(i / 4.0) ==
                  Approx(sign * std::pow(10.0, i - 1)).epsilon(1e-14));
}

TEST_CASE("Axes of whole numbers have whole values") {
    Axis whole = axis("granular.runs", 1.0, 9.0, 6);
    whole.whole = true;
    for (int i = 0; i <= 40; ++i) {
        const double value = whole.at(i / 40.0);
        CHECK(value == std::round(value));
    }
}

TEST_CASE("A listed axis has its values and no others") {
    Axis listed = axis("k", 0.0, 1.0, 3);
    listed.spacing = Spacing::listed;
    listed.values = {5.0, -1.0, 2.5};
    CHECK(listed.at(0.0) == 5.0);
    CHECK(listed.at(0.5) == -1.0);
    CHECK(listed.at(1.0) == 2.5);
    Design design;
    for (long count : {1, 2, 3, 7, 1000}) { // each value once, whatever i/(n - 1) rounds to
        listed.values.clear();
        for (long i = 0; i < count; ++i)
            listed.values.push_back(static_cast<double>(i * i));
        listed.count = count;
        design.axes = {listed};
        const auto points = all(design);
        REQUIRE(points.size() == listed.values.size());
        for (std::size_t i = 0; i < points.size(); ++i)
            CHECK(points[i].at[0] == listed.values[i]);
    }
}

TEST_CASE("A grid has every pair of values once, the last axis fastest") {
    Design design;
    design.axes = {axis("x", 0.0, 2.0, 3), axis("y", 10.0, 20.0, 2)};
    const auto points = all(design);
    REQUIRE(points.size() == 6);
    for (std::size_t i = 0; i < 6; ++i) {
        CHECK(points[i].id == static_cast<std::int64_t>(i));
        CHECK(points[i].at[0] == static_cast<double>(i / 2));
        CHECK(points[i].at[1] == (i % 2 == 0 ? 10.0 : 20.0));
    }
}

TEST_CASE("An axis of one point is its first end") {
    Design design;
    design.axes = {axis("x", 3.0, 4.0, 1)};
    REQUIRE(all(design).size() == 1);
    CHECK(all(design)[0].at[0] == 3.0);
}

TEST_CASE("A list is its rows") {
    Design design;
    design.kind = Kind::list;
    design.axes = {axis("x", 0.0, 1.0, 1), axis("y", 0.0, 1.0, 1)};
    design.rows = {{1.0, 2.0}, {0.1, -3.0}};
    const auto points = all(design);
    REQUIRE(points.size() == 2);
    CHECK(points[1].at[0] == 0.1);
    CHECK(points[1].at[1] == -3.0);
}

TEST_CASE("A Latin hypercube has one point in each slice of every axis") {
    for (const long samples : {1, 2, 17, 1000}) {
        const auto points = all(sampled(Kind::lhs, samples, 4));
        for (std::size_t k = 0; k < 4; ++k)
            CHECK(even_slices(points, k, samples, 1) == samples);
    }
}

TEST_CASE("The search for uneven slices can fail") {
    auto points = all(sampled(Kind::lhs, 16, 1));
    points[0].at[0] = points[1].at[0];
    CHECK(even_slices(points, 0, 16, 1) == 14);
}

TEST_CASE("Latin hypercubes follow their seed, and axes are not alike") {
    Design design = sampled(Kind::lhs, 50, 2);
    const auto first = all(design), again = all(design);
    design.seed = 2;
    const auto other = all(design);
    int same = 0, alike = 0;
    for (std::size_t i = 0; i < first.size(); ++i) {
        CHECK(first[i].at == again[i].at);
        same += first[i].at[0] == other[i].at[0];
        alike += first[i].at[0] == first[i].at[1];
    }
    CHECK(same == 0);
    CHECK(alike == 0);
}

TEST_CASE("Sobol' points with the corner fill every dyadic slice evenly") {
    // The first 2^m points are the corner and ours; each axis alone is then a (0, m, 1)-net.
    for (const std::size_t axes : {1, 2, 6}) {
        auto points = all(sampled(Kind::sobol, 255, axes));
        points.push_back({}); // the corner, which is left out: it is an end of every axis
        for (std::size_t k = 0; k < axes; ++k)
            for (long slices = 2; slices <= 256; slices *= 2)
                CHECK(even_slices(points, k, slices, 256 / slices) == slices);
    }
}

TEST_CASE("The first two axes of Sobol' points are a net: one point in each box of an area") {
    auto points = all(sampled(Kind::sobol, 255, 2));
    points.push_back({});
    for (long across = 1; across <= 256; across *= 2) { // boxes across x 256/across, area 1/256
        std::set<std::pair<long, long>> boxes;
        for (const Point& point : points)
            boxes.insert({static_cast<long>(point.at[0] * static_cast<double>(across)),
                          static_cast<long>(point.at[1] * static_cast<double>(256 / across))});
        CHECK(boxes.size() == 256);
    }
}

TEST_CASE("More Sobol' points begin with the fewer") {
    const auto few = all(sampled(Kind::sobol, 10, 3)), many = all(sampled(Kind::sobol, 1000, 3));
    for (std::size_t i = 0; i < few.size(); ++i)
        CHECK(few[i].at == many[i].at);
    CHECK(few[0].at[0] == 0.5); // the first point is the centre
}

TEST_CASE("Sizes are counted, and refused beyond 62 bits") {
    Design design;
    design.axes = std::vector(6, axis("x", 0.0, 1.0, 1000));
    CHECK(size(design) == 1'000'000'000'000'000'000); // 2^59.8
    design.axes[0].count = 10'000;
    CHECK_THROWS_AS(size(design), rodwake::InputError);
    CHECK(size(adaptive(2, 64, 1024)) == 1025L * 1025);
    CHECK(size(adaptive(3, 64, 1 << 20)) == ((1L << 20) + 1) * ((1L << 20) + 1) * ((1L << 20) + 1));
    CHECK(size(sampled(Kind::lhs, 7, 2)) == 7);
}

TEST_CASE("Causes are cut to what fits") {
    Result result;
    CHECK(result.cause_text().empty());
    result.set_cause("short");
    CHECK(result.cause_text() == "short");
    result.set_cause(std::string(1000, 'x'));
    CHECK(result.cause_text() == std::string(max_cause - 1, 'x'));
    result.set_cause("");
    CHECK(result.cause_text().empty());
}
