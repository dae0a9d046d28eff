#pragma once
// Scenes for the tests of stages: a pair of rods with a field, and a small bed.

#include "rodwake/scene/read.hpp"

#include <string>

namespace app_test {

inline rodwake::scene::Scene pair(double strength = 0.5, double t_end = 2.0) {
    return rodwake::scene::parse_scene(
        "schema = 1\n[medium]\neta = 1.0\nalpha = 1.0\n[coupling]\nkappa = " + std::to_string(strength) +
            "\n[field]\nx = [-2.0, 2.0]\ny = [-2.0, 2.0]\nnx = 5\nny = 5\n"
            "[[field.cuts]]\nfrom = -2.0\nto = 2.0\ncount = 5\n"
            "[rods_run]\nt_end = " +
            std::to_string(t_end) +
            "\noutput_interval = 0.5\n[[rods]]\nposition = [0.0, 1.0]\n"
            "[[rods]]\nposition = [0.0, -1.0]\n",
        "pair.toml");
}

inline rodwake::scene::Scene bed(double phi_b = 0.5, long runs = 1) {
    return rodwake::scene::parse_scene(
        "schema = 1\n[granular]\nphi_b = " + std::to_string(phi_b) +
            "\nbox = \"20 a\"\nduration = \"0.01 s\"\nequilibrate = \"0 s\"\nruns = " + std::to_string(runs) +
            "\n",
        "bed.toml");
}

} // namespace app_test
