#include "rodwake/core/spelling.hpp"

#include <catch2/catch.hpp>

#include <vector>

using rodwake::first_difference;

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

TEST_CASE("words of others are shown without what a terminal would obey, and cut") {
    using namespace rodwake;
    CHECK(printable("plain, zwei Stäbe\n\tand a tab") == "plain, zwei Stäbe\n\tand a tab");
    CHECK(printable("\x1b[2J\x07\x7f") == "\\x1b[2J\\x07\\x7f");
    CHECK(printable("\xc2\x9b"
                    "31m") == "\\x9b31m"); // the same in one character
    for (const char* wrong :
         {"\xE9", "\xC0\xAF", "\xED\xA0\x80", "\xF4\x90\x80\x80", "\xE2\x82"}) { // Latin-1, too long, ...
        CHECK(first_not_utf8("a\xC3\xA9\xF0\x9F\x90\x9C" + std::string(wrong)) == 7);
        CHECK(first_not_utf8(printable(wrong)) == std::string::npos);
    }
    CHECK(printable("caf\xE9 \xC3\xA9") == "caf\\xe9 \xC3\xA9");
    CHECK(shown("a\nb") == "a\\x0ab");
    CHECK(shown(std::string(5'000'000, '9')) == std::string(60, '9') + "...");
    CHECK(shown(std::string(59, 'x') + "ä") == std::string(59, 'x') + "..."); // not within a character
}

TEST_CASE("The first line that differs is reported with both its forms") {
    CHECK(first_difference("a = 1\nb = 2\nc = 3\n", "a = 1\nb = 4\nc = 5\n") == "b = 2 there, b = 4 here");
    CHECK(first_difference("a = 1\n", "a = 1\nb = 2\n") == "nothing there, b = 2 here");
    CHECK(first_difference("a = 1\n\nb = 2", "a = 1\n") == "b = 2 there, nothing here");
    CHECK(first_difference("", "a") == "nothing there, a here");
    CHECK(first_difference("a\n", "a") == "no line");
}
