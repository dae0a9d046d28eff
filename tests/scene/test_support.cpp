// The helpers of these tests must be able to fail.

#include "support.hpp"

#include <catch2/catch.hpp>

using namespace scene_test;

TEST_CASE("the complete scene is right and a wrong one is not") {
    CHECK(error_text(complete) == "");
    CHECK(problems_of(complete).empty());
    CHECK(problems_of(complete + "oops").size() == 1);
    CHECK(error_text(complete + "oops") != "");
    CHECK(error_text(two_rods()) == "");
}

TEST_CASE("mentions needs the key and the text") {
    const std::vector<Diagnostic> problems{{"x.toml", 2, 3, "medium.eta", "must be > -1"}};
    CHECK(mentions(problems, "medium.eta", "must be"));
    CHECK(mentions(problems, "medium.eta", "x.toml:2:3"));
    CHECK_FALSE(mentions(problems, "medium.xi", "must be"));
    CHECK_FALSE(mentions(problems, "medium.eta", "unknown"));
    CHECK_FALSE(mentions({}, "medium.eta", ""));
}

TEST_CASE("key paths") {
    const KeyInfo at{"field.cuts[]", "at", "", "", "", "", "", ""},
        schema{"", "schema", "", "", "", "", "", ""};
    CHECK(override_path(at) == "field.cuts.0.at");
    CHECK(message_path(at) == "field.cuts[0].at");
    CHECK(override_path(schema) == "schema");
    CHECK(replaced("aba", "a", "aa") == "aabaa");
}
