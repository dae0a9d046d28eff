// Files nobody meant to write: never a crash, never anything but SceneError, never slow.

#include "rodwake/scene/read.hpp"
#include "scene/diagnostics.hpp"
#include "support.hpp"

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <random>
#include <unistd.h>

using namespace scene_test;

namespace {

namespace fs = std::filesystem;

/// A directory that goes with the test.
struct Scratch {
    fs::path path = fs::temp_directory_path() / ("rodwake_scene_" + std::to_string(::getpid()));
    Scratch() { fs::create_directories(path); }
    ~Scratch() { fs::remove_all(path); }
};

std::string read_error(const fs::path& path) {
    try {
        rodwake::scene::read_scene(path);
    } catch (const rodwake::scene::SceneError& error) {
        return error.what();
    }
    return "";
}

std::string repeated(const std::string& text, std::size_t times) {
    std::string out;
    out.reserve(text.size() * times);
    for (std::size_t i = 0; i < times; ++i)
        out += text;
    return out;
}

/// One random change: a byte replaced, removed, inserted, a line copied or removed, a piece of the text
/// moved.
std::string mutated(std::string text, std::mt19937_64& random) {
    static const std::string alphabet = "0123456789.-+e\"'[]{}=,#\n \\_abxyz\xC3\xA9\x01";
    const auto at = [&] { return random() % (text.size() + 1); };
    const std::size_t i = at();
    switch (random() % 5) {
    case 0:
        return text.replace(i, 1, 1, alphabet[random() % alphabet.size()]);
    case 1:
        return text.erase(i, 1 + random() % 8);
    case 2:
        return text.insert(i, 1, static_cast<char>(random()));
    case 3:
        return text.insert(i, text.substr(at(), random() % 40));
    default:
        return text.insert(i, 1, alphabet[random() % alphabet.size()]);
    }
}

} // namespace

TEST_CASE("files that cannot be read") {
    const Scratch scratch;
    CHECK(read_error(scratch.path / "none.toml") == (scratch.path / "none.toml").string() + ": no such file");
    CHECK(read_error(scratch.path).find("is a directory, not a scene file") != std::string::npos);
    const fs::path locked = scratch.path / "locked.toml";
    std::ofstream(locked) << complete;
    CHECK(read_error(locked) == "");
    fs::permissions(locked, fs::perms::none);
    if (::geteuid() != 0) // root reads everything
        CHECK(read_error(locked).find("cannot be read") != std::string::npos);
}

TEST_CASE("a file that is too large") {
    const Scratch scratch;
    const fs::path large = scratch.path / "large.toml";
    std::ofstream(large) << repeated("[[rods]]\nposition = [0.0, 1.0]\n", 1'000'000);
    CHECK(read_error(large) == large.string() + ": larger than 16 MiB; a scene may have at most 1000 rods");
}

TEST_CASE("empty and binary files") {
    CHECK(error_text("").find("the scene needs the key schema") != std::string::npos);
    CHECK(error_text("\n# nothing\n").find("nothing to do") != std::string::npos);
    CHECK(error_text(std::string(1000, '\0')).find("not valid TOML") != std::string::npos);
    CHECK(error_text("\x7F"
                     "ELF\x02\x01\x01")
              .find("not valid TOML") != std::string::npos);
    CHECK(error_text("a = \"\xFF\xFE\"").find("not valid TOML") != std::string::npos);
    std::mt19937_64 random(3);
    for (int i = 0; i < 100; ++i) {
        std::string noise(200, ' ');
        for (char& c : noise)
            c = static_cast<char>(random());
        CHECK_FALSE(error_text(noise).empty());
    }
}

TEST_CASE("a million rods are one error") {
    const auto problems =
        problems_of("schema = 1\nrods = [" + repeated("{},", 1'000'000) + "]\n[rods_run]\nt_end = 1\n");
    REQUIRE(problems.size() == 1);
    CHECK(problems[0].message == "rods: 1000000 entries; at most 1000");
    std::string most = "schema = 1\n[rods_run]\nt_end = 1\n";
    for (int i = 0; i < 1000; ++i)
        most += "[[rods]]\nposition = [" + std::to_string(i) + ", 0]\n";
    CHECK(parse(most).rods.size() == 1000);
    CHECK(error_text(most + "[[rods]]\nposition = [-1, 0]\n").find("rods: 1001 entries; at most 1000") !=
          std::string::npos);
}

TEST_CASE("two hundred thousand wrong numbers are counted, not listed") {
    const std::string text = error_text(two_rods("output_times = [" + repeated("true,", 200'000) + "]\n"));
    CHECK(text.ends_with("... and 199950 more"));
    CHECK(text.size() < 20'000);
}

TEST_CASE("deep nesting") {
    const std::string deep = repeated("a.", 1'000'000) + "a";
    CHECK(error_text(deep + " = 1\n") == "x.toml:1:34: key nested too deeply");
    CHECK(error_text("[" + deep + "]\n").find("nested too deeply") != std::string::npos);
    CHECK(error_text("x = { " + deep + " = 1 }\n").find("nested too deeply") != std::string::npos);
    CHECK(error_text("\"a\"." + repeated("'b,='.", 100) + "c = 1\n").find("nested too deeply") !=
          std::string::npos);
    CHECK(error_text("a = " + repeated("[", 1'000'000)).find("not valid TOML") != std::string::npos);
    CHECK(error_text("a = " + repeated("{a=", 1'000'000)).find("not valid TOML") != std::string::npos);
    CHECK_FALSE(error_text(complete, {deep + "=1"}).empty());
    CHECK_FALSE(error_text(complete, {"title=" + repeated("[", 100'000)}).empty());
    CHECK_FALSE(error_text(complete, {"title={ " + deep + " = 1 }"}).empty());
    CHECK(error_text(two_rods("[[variants]]\nname = \"v\"\nset = { \"" + deep + "\" = 1 }\n"))
              .find("is not a key") != std::string::npos);
}

TEST_CASE("dots in strings, comments and numbers are not keys") {
    const std::string dots = repeated("a. ", 100);
    using rodwake::scene::find_deep_key;
    CHECK_FALSE(find_deep_key("# " + dots + "\n"));
    CHECK_FALSE(find_deep_key("a = \"" + dots + " \\\" " + dots + "\"\n"));
    CHECK_FALSE(find_deep_key("a = '" + dots + "'\n"));
    CHECK_FALSE(find_deep_key("a = \"\"\"" + dots + "\n\"\" " + dots + "\"\"\"\n"));
    CHECK_FALSE(find_deep_key("a = [" + repeated("1.5, ", 1000) + "]"));
    CHECK_FALSE(find_deep_key("a = \"open\n" + std::string("b.c = 1")));
    CHECK_FALSE(find_deep_key(repeated("a.", 16) + "a = 1"));
    CHECK(find_deep_key(repeated("a.", 17) + "a = 1"));
    const auto at = find_deep_key("x = 1\n" + repeated("a.", 17) + "a = 1");
    REQUIRE(at);
    CHECK(at->line == 2);
    CHECK(at->column == 34);
}

TEST_CASE("random changes never crash, and what is accepted can be written and read") {
    std::mt19937_64 random(4);
    int accepted = 0;
    for (int i = 0; i < 2000; ++i) {
        std::string text = complete;
        for (std::size_t changes = 1 + random() % 2; changes > 0; --changes)
            text = mutated(std::move(text), random);
        INFO(text);
        try {
            const Scene scene = parse(text);
            ++accepted;
            CHECK(rodwake::scene::parse_scene(rodwake::scene::to_toml(scene), "x.toml") == scene);
        } catch (const rodwake::scene::SceneError& error) {
            CHECK_FALSE(error.diagnostics().empty());
        }
    }
    CHECK(accepted > 50); // else the changes are too rough to test anything but the parser
    CHECK(accepted < 1500);
}

TEST_CASE("random overrides never crash") {
    std::mt19937_64 random(5);
    const auto keys = rodwake::scene::scene_keys();
    for (int i = 0; i < 1000; ++i) {
        const auto& info = keys[random() % keys.size()];
        const std::string text = mutated(mutated(override_path(info) + "=" + info.example, random), random);
        INFO(text);
        try {
            parse(complete, {text});
        } catch (const rodwake::scene::SceneError& error) {
            CHECK_FALSE(error.diagnostics().empty());
        }
    }
}
