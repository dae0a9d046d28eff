#include "rodwake/core/spelling.hpp"

#include <catch2/catch.hpp>
#include <vector>

TEST_CASE("edit distance and the nearest name") {
    using namespace rodwake;
    CHECK(edit_distance("", "abc") == 3);
    CHECK(edit_distance("kappa", "kappa") == 0);
    CHECK(edit_distance("kapa", "kappa") == 1);
    CHECK(edit_distance("kpapa", "kappa") == 1); // neighbours swapped
    CHECK(edit_distance("kitten", "sitting") == 3);
    const std::vector<std::string_view> known{"kappa", "gamma1", "gamma2"};
    CHECK(nearest_word("KAPPA", known) == "kappa");
    CHECK(nearest_word("gama2", known) == "gamma2");
    CHECK(nearest_word("temperature", known) == "");
    CHECK(nearest_word("x", known) == "");
    CHECK(nearest_word(std::string(100000, 'k'), known) == "");
}
