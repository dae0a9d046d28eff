// Values come back bit by bit; reading something else than was written is an error.

#include "rodwake/store/bytes.hpp"

#include "rodwake/core/error.hpp"
#include "scratch.hpp"

#include <catch2/catch.hpp>

#include <array>
#include <bit>
#include <limits>

using namespace rodwake;
using namespace store_test;

TEST_CASE("Values, arrays and texts come back") {
    const std::vector<double> numbers = {0.1, -0.0, std::numeric_limits<double>::denorm_min()};
    store::ByteWriter out;
    out.put(std::int64_t{-5});
    out.put_array(numbers);
    out.put_array(std::vector<std::int32_t>{});
    out.put_text("zwei Stäbe");
    out.put_array(numbers);
    const auto bytes = out.take();
    CHECK(out.take().empty());

    store::ByteReader in(bytes, "c");
    CHECK(in.get<std::int64_t>() == -5);
    const auto back = in.get_array<double>();
    CHECK(back == numbers);
    CHECK(std::bit_cast<std::uint64_t>(back[1]) == std::bit_cast<std::uint64_t>(-0.0));
    CHECK(in.get_array<std::int32_t>().empty());
    CHECK(in.get_text() == "zwei Stäbe");
    std::array<double, 3> fixed{};
    in.get_array(std::span<double>(fixed));
    CHECK(std::vector<double>(fixed.begin(), fixed.end()) == numbers);
    in.finish();
}

TEST_CASE("What was not written cannot be read") {
    store::ByteWriter out;
    out.put_array(std::vector<double>{1.0, 2.0});
    const auto bytes = out.take();
    const auto refusal = [&](auto read) {
        store::ByteReader in(bytes, "run.rwc: block \"beads\"");
        return error_of<InputError>([&] { read(in); });
    };
    std::array<double, 3> three{};
    CHECK(refusal([](auto& in) { in.template get_array<float>(); }) ==
          "run.rwc: block \"beads\": values of 8 bytes, expected 4");
    CHECK(has(refusal([&](auto& in) { in.get_array(std::span<double>(three)); }), "2 values, expected 3"));
    CHECK(has(refusal([](auto& in) { in.finish(); }), "32 bytes are left over"));
    CHECK(has(refusal([](auto& in) {
                  in.template get_array<double>();
                  in.template get<char>();
              }),
              "ends early: 0 bytes are left, 1 expected"));
}

TEST_CASE("An array that claims more than is there is refused before it is made room for") {
    store::ByteWriter out;
    out.put(std::uint64_t{8});
    out.put(std::uint64_t{1} << 61); // times 8: wraps around to 0
    const auto bytes = out.take();
    store::ByteReader in(bytes, "c");
    CHECK(has(error_of<InputError>([&] { in.get_array<double>(); }), "ends early: 0 bytes are left"));
}
