// Figures of scans: their keys, what they need, how they are written.

#include "support.hpp"

#include "rodwake/scene/read.hpp"

#include <catch2/catch.hpp>

using namespace scene_test;

namespace {

/// A scan of two rods with a figure of the kind.
std::string figure(const std::string& kind, const std::string& more = "") {
    return two_rods("[medium]\neta = 1.0\nxi = 1.0\n[coupling]\nkappa = 1.0\n[scan]\ndesign = \"grid\"\n"
                    "[[scan.axes]]\nkey = \"coupling.kappa\"\nfrom = 0.1\nto = 10.0\ncount = 3\n"
                    "[[figures]]\nname = \"f\"\nkind = \"" +
                    kind + "\"\n" + more);
}

void says(const std::string& text, const std::string& part) {
    const std::string error = error_text(text);
    CAPTURE(error);
    CHECK(error.find(part) != std::string::npos);
}

void check_round_trip(const Scene& scene) {
    CHECK(rodwake::scene::parse_scene(rodwake::scene::to_toml(scene), scene.path) == scene);
}

} // namespace

TEST_CASE("figures of scans have their own keys") {
    const Scene plain = parse(figure("phase_diagram"));
    CHECK(plain.figures[0].colour == "outcome");
    CHECK(plain.figures[0].boundary);
    CHECK_FALSE(plain.figures[0].cells);
    check_round_trip(plain);
    const Scene asked = parse(figure("phase_diagram", "colour = \"steps\"\ncells = true\nboundary = false\n"
                                                      "slices = [1.0, -2.5]\nx = [0.1, 3.0]\n"));
    CHECK(asked.figures[0].colour == "steps");
    CHECK(asked.figures[0].slices == std::vector{1.0, -2.5});
    check_round_trip(asked);
    const Scene curve = parse(figure("scan_curve", "column = \"time\"\n"));
    CHECK(curve.figures[0].column == "time");
    check_round_trip(curve);
}

TEST_CASE("keys of scans' figures belong to their kinds") {
    says(figure("trajectories", "cells = true\n"), "cells belongs to kind phase_diagram only");
    says(figure("trajectories", "boundary = false\n"), "boundary belongs to kind phase_diagram only");
    says(figure("scan_curve", "slices = [1.0]\n"), "slices belongs to kind phase_diagram only");
    says(figure("scan_curve", "colour = \"time\"\n"),
         "colour belongs to kinds snapshot, movie and phase_diagram only");
    says(figure("phase_diagram", "column = \"time\"\n"), "column belongs to kind scan_curve only");
}

TEST_CASE("the window of a scan's figure is in the numbers of its axes, whatever the units") {
    const std::string si = "units = \"si\"\n[scales]\nf_over_mu = \"0.88 mm\"\nv0 = \"2.8 mm/s\"\n";
    const Scene scene = parse(replaced(replaced(figure("phase_diagram", "x = [0.1, 3.0]\ny = [-2.0, 2.0]\n"),
                                                "schema = 1\n", "schema = 1\n" + si),
                                       "[medium]\neta = 1.0\nxi = 1.0", "[medium]\neta = 1.0\nalpha = 1.0"));
    CHECK(scene.figures[0].x == std::vector{0.1, 3.0});
    CHECK(scene.figures[0].y == std::vector{-2.0, 2.0});
    check_round_trip(scene);
}
