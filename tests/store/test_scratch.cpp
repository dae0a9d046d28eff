// The helpers of these tests must be able to fail.

#include "scratch.hpp"

#include "rodwake/core/error.hpp"

#include <catch2/catch.hpp>

using namespace store_test;

TEST_CASE("A scratch folder lists what is in it and goes") {
    fs::path path;
    {
        const Scratch scratch;
        path = scratch.path();
        CHECK(scratch.entries().empty());
        scratch.file("a/b.txt", "text");
        CHECK(scratch.entries() == std::set<std::string>{"a", "a/b.txt"});
        CHECK(content(scratch / "a/b.txt") == "text");
        CHECK_THROWS(content(scratch / "none"));
        CHECK(Scratch().path() != path);
    }
    CHECK_FALSE(fs::exists(path));
}

TEST_CASE("error_of wants an error of the kind") {
    using rodwake::InputError;
    using rodwake::RunError;
    CHECK(error_of<RunError>([] { throw RunError("why"); }) == "why");
    CHECK_THROWS_AS(error_of<RunError>([] {}), std::logic_error);
    CHECK_THROWS_AS(error_of<RunError>([] { throw InputError("other"); }), InputError);
    CHECK(has("abc", "bc"));
    CHECK_FALSE(has("abc", "cb"));
}
