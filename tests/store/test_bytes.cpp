// Values come back bit by bit; reading something else than was written is an error.

#include "rodwake/store/bytes.hpp"

#include "kept_structs.hpp"
#include "rodwake/core/error.hpp"
#include "scratch.hpp"

#include <catch2/catch.hpp>

#include <bit>
#include <cmath>
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
    CHECK(in.get_array<double>() == numbers);
    in.finish();
}

TEST_CASE("What was not written cannot be read") {
    store::ByteWriter out;
    out.put_array(std::vector<double>{1.0, 2.0});
    const auto bytes = out.take();
    const auto refusal = [&](auto read) {
        store::ByteReader in(bytes, "run.rwc");
        return error_of<InputError>([&] { read(in); });
    };
    CHECK(refusal([](auto& in) { in.template get_array<float>(); }) ==
          "run.rwc: values of 8 bytes, expected 4");
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

TEST_CASE("A struct whose parts are listed comes back") {
    const Kept kept{"a", {1.0, -0.0, 3.0}, {0.5, 0.1, 0.2, 0.3}, {{{0.1, 0.2}, 3.0F, true}, {}}, {0.1, 0.2}};
    const Kept back = store::from_bytes<Kept>(store::to_bytes(kept), "file");
    CHECK(back.name == "a");
    CHECK(back.push == kept.push);
    CHECK(std::signbit(back.push.y()));
    CHECK(back.turn.coeffs() == kept.turn.coeffs());
    CHECK(back.poses == kept.poses);
    CHECK(back.times == kept.times);
}

TEST_CASE("A struct that ends early is refused") {
    std::vector<std::byte> bytes = store::to_bytes(Pose{{1.0, 2.0}, 3.0F, true});
    bytes.pop_back();
    CHECK(has(error_of<InputError>([&] { store::from_bytes<Pose>(bytes, "file"); }), "file: ends early"));
}
