// [tracks]: windows in all their forms, there and back, and what does not fit beside each other.

#include "support.hpp"

#include <catch2/catch.hpp>

using namespace scene_test;
using rodwake::scene::WindowKind;

TEST_CASE("a window is a word or a table of lengths, and is written as it is read") {
    CHECK(parse(filmed).tracks->window.kind == WindowKind::automatic);
    const struct {
        std::string text;
        WindowKind kind;
        std::vector<double> sizes;
    } cases[] = {
        {"\"hull\"", WindowKind::hull, {}},
        {"\"automatic\"", WindowKind::automatic, {}},
        {"{ circle = [\"20 mm\", 0.01, \"40 a\"] }", WindowKind::circle, {0.02, 0.01, 0.016}},
        {"{ rectangle = [0.0, 0.0, \"2 cm\", 0.03] }", WindowKind::rectangle, {0.0, 0.0, 0.02, 0.03}}};
    for (const auto& one : cases) {
        const Scene scene = parse(filmed, {"tracks.window=" + one.text});
        CHECK(scene.tracks->window.kind == one.kind);
        CHECK(scene.tracks->window.sizes == one.sizes);
        CHECK(parse(rodwake::scene::to_toml(scene)).tracks == scene.tracks);
    }
}

TEST_CASE("a wrong window is told with what is expected") {
    const struct {
        std::string window, said;
    } cases[] = {{"{ ring = [1.0, 2.0] }", "expected a string such as \"hull\", { circle = [x, y, radius] }"},
                 {"\"hul\"", "must be one of automatic, hull, periodic (did you mean \"hull\"?)"},
                 {"{ circle = [1.0, 2.0] }", "expected 3 numbers, found 2"},
                 {"{ circle = [1.0, 2.0, 0.0] }", "the radius of the circle must be above 0"},
                 {"{ circle = [1.0, 2.0, \"3 s\"] }", "expected a length"},
                 {"{ rectangle = [1.0, 0.0, 1.0, 1.0] }", "x0 below x1"},
                 {"\"periodic\"", "needs box, for example box = \"78 a\""}};
    for (const auto& one : cases) {
        const std::string text = error_text(filmed, {"tracks.window=" + one.window});
        INFO(text);
        CHECK(text.find(one.said) != std::string::npos);
    }
}

TEST_CASE("what tracks do not go with is refused") {
    const std::string alone = filmed.substr(0, filmed.find("[measure]"));
    CHECK(mentions(problems_of(alone), "tracks", "needs [measure]"));
    CHECK(mentions(problems_of(filmed + "[granular]\nphi_b = 0.7\nbox = \"30 a\"\nduration = 1.0\n"),
                   "tracks", "tracks replace a simulated bed"));
    CHECK(
        mentions(problems_of(filmed, {"tracks.time_column=t"}), "tracks.frames_per_second", "leave one out"));
    CHECK(mentions(problems_of(filmed, {"tracks.frames_per_second="}), "tracks.frames_per_second",
                   "time_column where the file has times"));
    // Files that may have times and a box of their own are looked at first.
    for (const char* of : {"tracks.file=film.dump", "tracks.format=xyz"})
        for (const char* without : {"tracks.frames_per_second=", "tracks.window=periodic"})
            CHECK(problems_of(filmed, {of, without}).empty());
    CHECK(mentions(
        problems_of(filmed, {"tracks.format=gsd", "tracks.frames_per_second=", "tracks.time_column=t"}),
        "tracks.time_column", "only CSV and extended XYZ have such columns"));
    CHECK(mentions(problems_of(filmed, {"tracks.box=30 a"}), "tracks.box", "belongs to window"));
    CHECK(mentions(problems_of(filmed, {"measure.order=false"}), "measure",
                   "nothing that can be measured on tracks"));
    for (const char* key : {"force", "phonons", "mechanics"})
        CHECK(mentions(problems_of(filmed, {std::string("measure.") + key + "=true"}),
                       std::string("measure.") + key, "needs a bed"));
    CHECK(mentions(problems_of(filmed, {"measure.pairs=true"}), "measure.pairs", "needs contact_distance"));
    CHECK(mentions(problems_of(filmed, {"measure.displacement=density"}), "measure.displacement",
                   "give phase or lagrangian"));
    CHECK(mentions(problems_of(filmed, {"tracks.angle=0"}), "tracks.angle", "must not be 0"));
    CHECK(parse(filmed, {"tracks.angle=-180 deg"}).tracks->angle == Approx(-3.14159265358979));
    CHECK(parse(filmed, {"tracks.bead_radius=1 mm", "measure.order_cutoff=3 a"}).measure->order_cutoff ==
          3e-3);
}
