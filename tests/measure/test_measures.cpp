// Accumulators of any kind behind one face: each sees the frames it asked for, and the state of all comes
// back.

#include "rodwake/core/error.hpp"
#include "rodwake/measure/measures.hpp"
#include "rodwake/measure/microrheology.hpp"
#include "synthetic.hpp"

#include <catch2/catch.hpp>

using namespace rodwake;
using namespace rodwake::measure;

namespace {

/// The times it saw.
struct Times {
    std::vector<double> seen;

    void add(const Frame& frame) { seen.push_back(frame.time); }
    void save(StateWriter& out) const { out.put(seen); }
    void load(StateReader& in) { seen = in.array(); }
};

const Layout layout = synthetic::layout(4);

Frame frame_at(double time) {
    const double a = layout.bead_radius;
    return synthetic::frame_of(layout, time, {5 * a, 10 * a, 15 * a, 20 * a}, {5 * a, 9 * a, 12 * a, 30 * a});
}

Measures two_measures() {
    Measures measures(layout, 1.0);
    measures.include("every", Accumulator(Times{}));
    measures.include("third", Accumulator(Times{}), 3);
    return measures;
}

} // namespace

TEST_CASE("each measure sees every so many frames from the first time on", "[measures]") {
    CHECK_FALSE(Measures(layout, 0.0).any());
    Measures measures = two_measures();
    CHECK(measures.any());
    for (int k = 0; k < 8; ++k)
        measures.add(frame_at(0.5 * k));
    CHECK(measures.frames() == 6);
    CHECK(measures.find("every")->as<Times>().seen == std::vector<double>{1.0, 1.5, 2.0, 2.5, 3.0, 3.5});
    CHECK(measures.find("third")->as<Times>().seen == std::vector<double>{1.0, 2.5});
    CHECK(measures.find("other") == nullptr);
    CHECK(measures.stride("third") == 3);
    CHECK(measures.stride("other") == 0);
    CHECK_THROWS_AS(measures.find("every")->as<MicrorheologyAccumulator>(), std::bad_any_cast);
}

TEST_CASE("a copy starts anew and a saved state goes on where it was", "[measures]") {
    const Measures fresh = two_measures();
    Measures whole = fresh, first = fresh, second = fresh;
    for (int k = 0; k < 8; ++k)
        whole.add(frame_at(k));
    for (int k = 0; k < 5; ++k)
        first.add(frame_at(k));
    CHECK(fresh.frames() == 0);
    second.load(first.save(), "test");
    for (int k = 5; k < 8; ++k)
        second.add(frame_at(k));
    CHECK(second.save() == whole.save());
    CHECK(second.save() != first.save());
    std::vector<double> numbers = whole.save();
    numbers.push_back(0.0);
    CHECK_THROWS_AS(second.load(numbers, "test"), RunError);
}

TEST_CASE("a distance of a rod from its first place is waited for, and remembered", "[measures]") {
    const double a = layout.bead_radius;
    Layout with_rod = layout;
    with_rod.rods = 1;
    const auto fresh = [&] {
        Measures measures(with_rod, 1.5, {0, 2.0 * a});
        measures.include("every", Accumulator(Times{}));
        return measures;
    };
    Measures whole = fresh(), parts = fresh();
    for (const double time : {0.0, 1.0, 2.0, 3.0, 4.0}) {
        Frame frame = frame_at(time);
        const double way = std::min(time, 4.0 - 0.5 * time); // 0, 1, 2, 2.5, 2 a: stays once it was there
        frame.rods = {{(70.0 + way) * a, 3.0 * a, 0.0}};
        whole.add(frame);
        parts.add(frame);
        Measures next = fresh();
        next.load(parts.save(), "test");
        parts = next;
    }
    CHECK(whole.find("every")->as<Times>().seen == std::vector<double>{2.0, 3.0, 4.0});
    CHECK(parts.save() == whole.save());
    CHECK_THROWS_AS(Measures(layout, 0.0, {0, a}), InputError); // there is no rod
}

TEST_CASE("the sums of all runs are taken out by name", "[measures]") {
    std::vector<Measures> runs = {two_measures(), two_measures()};
    runs[1].add(frame_at(2.0));
    const std::vector<Times> times = take<Times>(runs, "every");
    REQUIRE(times.size() == 2);
    CHECK(times[0].seen.empty());
    CHECK(times[1].seen == std::vector<double>{2.0});
    CHECK(take<Times>(runs, "other").empty());
}

TEST_CASE("frames of another bed are refused", "[measures]") {
    Measures measures = two_measures();
    Frame frame = frame_at(2.0);
    frame.x.pop_back();
    CHECK_THROWS_AS(measures.add(frame), RunError);
    CHECK_THROWS_AS(Measures(Layout{}, 0.0), InputError);
}
