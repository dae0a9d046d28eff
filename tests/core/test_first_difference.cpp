#include "rodwake/core/spelling.hpp"

#include <catch2/catch.hpp>

using rodwake::first_difference;

TEST_CASE("The first line that differs is told with both its forms") {
    CHECK(first_difference("a = 1\nb = 2\nc = 3\n", "a = 1\nb = 4\nc = 5\n") == "b = 2 there, b = 4 here");
    CHECK(first_difference("a = 1\n", "a = 1\nb = 2\n") == "nothing there, b = 2 here");
    CHECK(first_difference("a = 1\n\nb = 2", "a = 1\n") == "b = 2 there, nothing here");
    CHECK(first_difference("", "a") == "nothing there, a here");
    CHECK(first_difference("a\n", "a") == "no line");
}
