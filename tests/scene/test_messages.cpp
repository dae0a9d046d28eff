// What a person sees: place, found, legal, nearest name.

#include "support.hpp"

#include "rodwake/scene/read.hpp"
#include "scene/diagnostics.hpp"
#include "store/scratch.hpp"

#include <catch2/catch.hpp>
#include <unistd.h>

#include <random>

using namespace scene_test;
using store_test::Scratch;

TEST_CASE("all problems of a file are listed at once, in order, with places") {
    const std::string text = "schema = 1\n"
                             "[medium]\n"
                             "eta = -2\n"
                             "  alpha = \"much\"\n"
                             "[coupling]\n"
                             "kapa = 1\n"
                             "[[rods]]\n"
                             "heading = true\n"
                             "[[rods]]\n"
                             "position = [0.0, \"abc\"]\n"
                             "[[rods]]\n"
                             "position = \"abc\"\n"
                             "[rods_run]\n"
                             "t_end = inf\n";
    CHECK(error_text(text) ==
          "x.toml:3:7: medium.eta = -2: must be > -1 and <= 1e+12: the longitudinal modulus 1 + eta must be "
          "positive\n"
          "x.toml:4:11: medium.alpha: expected a number, found \"much\" (string)\n"
          "x.toml:6:1: [coupling] unknown key \"kapa\" (did you mean \"kappa\"?). Known keys: kappa, gamma1, "
          "gamma2, polar_basis, gamma_flow, gamma_rows, rows_direction\n"
          "x.toml:7:1: rods[0] needs the key position, for example position = [0.0, 2.5]\n"
          "x.toml:8:11: rods[0].heading: expected an angle (a number, or a string such as \"30 deg\"), found "
          "true (boolean)\n"
          "x.toml:10:18: rods[1].position[1]: expected a length, found \"abc\" (string): a string must be a "
          "finite number and a unit: m, cm, mm, um, a, f/mu\n"
          "x.toml:12:12: rods[2].position: expected 2 numbers, found \"abc\" (string)\n"
          "x.toml:14:9: rods_run.t_end = inf: must be a finite number");
}

TEST_CASE("problems carry file, line, column and key") {
    const auto problems = problems_of("schema = 1\n[field]\nnx = 1\n[medium]\neta = 1\nxi = 1\n");
    REQUIRE(problems.size() == 1);
    CHECK(problems[0].file == "x.toml");
    CHECK(problems[0].line == 3);
    CHECK(problems[0].column == 6);
    CHECK(problems[0].key == "field.nx");
}

TEST_CASE("TOML errors have the same form") {
    const auto duplicate = error_text("schema = 1\nschema = 1\n");
    CHECK(duplicate.starts_with("x.toml:2:"));
    CHECK_THAT(duplicate, Catch::Contains(": not valid TOML: "));
    CHECK_THAT(duplicate, Catch::Contains("redefine"));
    CHECK(error_text("schema = \n").starts_with("x.toml:1:10: not valid TOML: "));
    CHECK(error_text("a = \"open\n").starts_with("x.toml:1:"));
}

TEST_CASE("conflicting and missing forms name all places") {
    const std::string start = "schema = 1\n[field]\nx = [0, 1]\ny = [0, 1]\n[medium]\n";
    CHECK(error_text(start + "eta = 1\nxi = 1\npoisson_ratio = 0.1\n") ==
          "x.toml:8:1: medium gives eta (line 6) and poisson_ratio (line 8): give one of eta | poisson_ratio "
          "| lame_lambda + mu | bulk_modulus + mu");
    CHECK(error_text(start + "eta = 1\nxi = 1\nalpha = 1\n") ==
          "x.toml:8:1: medium gives xi (line 7) and alpha (line 8): give one of xi | alpha");
    CHECK(error_text(start + "eta = 1\n") == "x.toml:5:1: medium needs one of xi | alpha");
    says(start + "xi = 1\nmu = 1\n", "medium gives mu (line 7): give one of");
    says(two_rods("output_interval = 0.1\noutput_times = [1.0]\n"),
         "gives t_end (line 7) and output_interval (line 8) and output_times (line 9): give one of ");
}

TEST_CASE("elastic forms that give an impossible eta are refused") {
    const std::string start = "schema = 1\n[field]\nx = [0, 1]\ny = [0, 1]\n[medium]\nxi = 1\n";
    CHECK(error_text(start + "lame_lambda = -2.0\nmu = 1.0\n") ==
          "x.toml:7:15: medium.lame_lambda is not usable: lame_lambda = -2: must be > -2 mu");
    says(start + "bulk_modulus = 1e12\nmu = 1e-12\n", "eta = 1e+24: must be > -1");
    CHECK(error_text(start + "bulk_modulus = -1.0\nmu = 1.0\n") ==
          "x.toml:7:16: medium.bulk_modulus is not usable: bulk_modulus = -1: must be > -mu");
    CHECK(error_text(start + "lame_lambda = -1.9\nmu = 1.0\n") == "");
    CHECK(parse(start + "bulk_modulus = -0.5\nmu = 1.0\n").medium->eta == -0.5);
}

TEST_CASE("a key in the wrong table is sent to the right one") {
    says("schema = 1\n[medium]\neta = 1\nxi = 1\nkappa = 1\n[field]\nx = [0, 1]\ny = [0, 1]\n",
         "[medium] unknown key \"kappa\" ([coupling] has it). Known keys: eta, ");
}

TEST_CASE("tables and lists of the wrong kind") {
    says("schema = 1\nmedium = 3\n", "x.toml:2:10: medium: expected a table [medium], found 3 (integer)");
    says("schema = 1\n[rods]\nposition = [0, 0]\n", "rods: expected entries [[rods]], found a table");
    says("schema = 1\nrods = [1]\n", "rods[0]: expected a table [[rods]], found 1 (integer)");
    says("schema = 1\n[fieldd]\n", "unknown table or key \"fieldd\" (did you mean \"field\"?)");
}

TEST_CASE("a missing schema is asked for") {
    says("[field]\n", "the scene needs the key schema, for example schema = 1");
}

TEST_CASE("a long list of problems is cut") {
    std::string text = two_rods();
    for (int i = 0; i < 60; ++i)
        text += "wrong" + std::to_string(i) + " = 1\n";
    const std::string message = error_text(text);
    CHECK(std::count(message.begin(), message.end(), '\n') == 50); // 50 problems and the count of the rest
    CHECK(message.ends_with("\n... and 10 more"));
    CHECK(problems_of(text).size() == 60);
}

TEST_CASE("long values are shortened") {
    const auto message = error_text(two_rods(), {"rods_run.method=" + std::string(1000, 'x')});
    CHECK_THAT(message, !Catch::Contains("rods_run.method: "));
    CHECK_THAT(message, Catch::Contains(std::string(30, 'x').append("...")));
}

// --- The helpers of these tests must be able to fail

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

// --- Files nobody meant to write: never a crash, never anything but SceneError, never slow

namespace fs = std::filesystem;

namespace {

std::string read_error(const fs::path& path) {
    return store_test::error_of<rodwake::scene::SceneError>([&] { rodwake::scene::read_scene(path); });
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
    CHECK(read_error(scratch / "none.toml") == (scratch / "none.toml").string() + ": no such file");
    CHECK_THAT(read_error(scratch.path()), Catch::Contains("is a directory, not a scene file"));
    const fs::path locked = scratch.file("locked.toml", complete);
    CHECK_NOTHROW(rodwake::scene::read_scene(locked));
    fs::permissions(locked, fs::perms::none);
    if (::geteuid() != 0) // root reads everything
        CHECK_THAT(read_error(locked), Catch::Contains("cannot be read"));
}

TEST_CASE("a file that is too large") {
    const Scratch scratch;
    const fs::path large =
        scratch.file("large.toml", repeated("[[rods]]\nposition = [0.0, 1.0]\n", 1'000'000));
    CHECK(read_error(large) == large.string() + ": larger than 16 MiB; a scene may have at most 1000 rods");
}

TEST_CASE("empty and binary files") {
    says("", "the scene needs the key schema");
    says("\n# nothing\n", "nothing to do");
    says(std::string(1000, '\0'), "not valid TOML");
    says("\x7F"
         "ELF\x02\x01\x01",
         "not valid TOML");
    says("a = \"\xFF\xFE\"", "not valid TOML");
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
    says(most + "[[rods]]\nposition = [-1, 0]\n", "rods: 1001 entries; at most 1000");
}

TEST_CASE("two hundred thousand wrong numbers are counted, not listed") {
    const std::string text = error_text(two_rods("output_times = [" + repeated("true,", 200'000) + "]\n"));
    CHECK(text.ends_with("... and 199950 more"));
    CHECK(text.size() < 20'000);
}

TEST_CASE("deep nesting") {
    const std::string deep = repeated("a.", 1'000'000) + "a";
    CHECK(error_text(deep + " = 1\n") == "x.toml:1:34: key nested too deeply");
    says("[" + deep + "]\n", "nested too deeply");
    says("x = { " + deep + " = 1 }\n", "nested too deeply");
    says("\"a\"." + repeated("'b,='.", 100) + "c = 1\n", "nested too deeply");
    says("a = " + repeated("[", 1'000'000), "not valid TOML");
    says("a = " + repeated("{a=", 1'000'000), "not valid TOML");
    CHECK_FALSE(error_text(complete, {deep + "=1"}).empty());
    CHECK_FALSE(error_text(complete, {"title=" + repeated("[", 100'000)}).empty());
    CHECK_FALSE(error_text(complete, {"title={ " + deep + " = 1 }"}).empty());
    says(two_rods("[[variants]]\nname = \"v\"\nset = { \"" + deep + "\" = 1 }\n"), "is not a key");
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
