#include "catch2/catch.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/measure/state_io.hpp"

#include <cmath>
#include <limits>
#include <span>

using namespace rodwake;
using measure::StateReader;
using measure::StateWriter;

TEST_CASE("what is saved comes back to the bit", "[packing]") {
    const std::vector<double> values = {0.1, -0.0, 1e-320, 1e308};
    StateWriter out;
    out.put(std::size_t{1} << 40);
    out.put(values);
    out.put(std::vector<double>{});
    out.put(1.0 / 3.0);
    const std::vector<double> row = out.take();
    StateReader in(row, "test");
    CHECK(in.count() == std::size_t{1} << 40);
    const auto back = in.array(values.size());
    CHECK(back == values);
    CHECK(std::signbit(back[1]));
    CHECK(in.array().empty());
    CHECK(in.get() == 1.0 / 3.0);
    in.finish();
}

TEST_CASE("a row that is not what it should be is refused", "[packing]") {
    const std::vector<double> row = {3.0, 1.0, 2.0, 3.0, 7.0};
    StateReader all(row, "test");
    CHECK(all.array() == std::vector<double>{1.0, 2.0, 3.0});
    CHECK_THROWS_AS(all.finish(), RunError);
    StateReader wrong_length(row, "test");
    CHECK_THROWS_AS(wrong_length.array(4), RunError);
    StateReader too_short(std::span<const double>(row).first(2), "test");
    CHECK_THROWS_AS(too_short.array(), RunError);
    for (const double none : {0.5, -1.0, 1e300, std::numeric_limits<double>::quiet_NaN()}) {
        const std::vector<double> bad = {none};
        StateReader in(bad, "test");
        CHECK_THROWS_AS(in.count(), RunError);
    }
}
