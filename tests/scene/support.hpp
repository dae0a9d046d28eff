#pragma once
// Shared by the scene tests: a scene that uses every table, and ways to look at what is wrong with a changed
// one.

#include "rodwake/scene/document.hpp"
#include "rodwake/scene/read.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <string>
#include <vector>

namespace scene_test {

using rodwake::scene::Diagnostic;
using rodwake::scene::KeyInfo;
using rodwake::scene::Scene;

inline const std::string complete = R"(schema = 1
title = "complete"
[scales]
f_over_mu = "2.2 a"
v0 = "2.8 mm/s"
[medium]
eta = 1.0
alpha = 0.5
[coupling]
kappa = 0.5
[[rods]]
position = [0.0, 2.5]
[[rods]]
position = [0.0, -2.5]
heading = 0.25
[rods_run]
t_end = 30.0
contact_distance = 0.1
[rods_order]
link = 1.0
[field]
x = [-5.0, 5.0]
y = [-4.0, 4.0]
[[field.cuts]]
from = -20.0
to = 5.0
[granular]
phi_b = 0.78
box = "78 a"
duration = "10 s"
[granular.output]
formats = ["h5md", "xyz"]
[[granular.bead_kinds]]
radius = "0.4 mm"
[[granular.rods]]
position = ["20 a", "46.5 a"]
taper = "stepwise"
[[granular.rods]]
position = ["20 a", "31.5 a"]
[measure]
bead_drag = 13.9
inertia_factor = 1.27
order = true
displacement = "phase"
[fit]
parameters = ["f_over_mu", "eta", "alpha"]
fixed = { kappa = 0.75, force = 1.0, c11 = 3.0, c22 = 3.0, c12 = 1.0, c66 = 1.0 }
box = "78 a"
likelihood = ["eta"]
[[fit.profiles]]
file = "profile_Ux_x.csv"
[[fit.profiles]]
file = "profile_Uy_x.csv"
component = "Uy"
at = "4 a"
[[fit.trajectories]]
file = "rods.csv"
sigma_position = 0.1
sigma_heading = 0.05
contact_distance = 0.1
contact_time = 40.6
[[fit.maps]]
files = ["measure.h5"]
[[fit.masks]]
strip = "8 a"
[[fit.compare]]
name = "paper"
values = { f_over_mu = 2.2 }
[[fit.models]]
name = "shifted"
set = { "fit.fixed.offset" = 0.1 }
[[figures]]
name = "wake"
kind = "cut"
[[figures]]
name = "streams"
kind = "polar_streamlines"
gammas = [[1.0, 0.0]]
[[figures]]
name = "bed"
kind = "snapshot"
x = [0.0, "30 a"]
[[variants]]
name = "repelled"
set = { "coupling.kappa" = -100.0 }
)";

/// The complete scene with a scan in place of the variants: the two do not go together.
inline const std::string scanned = complete.substr(0, complete.find("[[variants]]")) + R"([scan]
design = "adaptive"
resolution = 256
[[scan.axes]]
key = "coupling.kappa"
from = 0.1
to = 100.0
[[scan.refine]]
observable = "min_separation"
step = 0.5
)";

/// The same with the design that takes listed values and no [[scan.refine]].
inline const std::string scanned_grid = [] {
    std::string text = scanned.substr(0, scanned.find("[[scan.refine]]"));
    return text.replace(text.find("adaptive"), 8, "grid");
}();

/// The same with critical values of eta for each kappa.
inline const std::string scanned_critical = [] {
    std::string text = scanned_grid;
    return text.replace(text.find("design = \"grid\"\nresolution = 256\n"), 33,
                        "design = \"critical\"\nsolve_for = \"medium.eta\"\nfrom = 0.5\nto = 2.0\n");
}();

/// The complete scene with rods at random in place of those.
inline const std::string crowded = complete.substr(0, complete.find("[[rods]]")) +
                                   "[rods_random]\ncount = 10\nextent = 40.0\nmin_separation = 0.5\n" +
                                   complete.substr(complete.find("[rods_run]"));

/// The complete scene with rods at random in the bed in place of those.
inline const std::string crowded_bed = complete.substr(0, complete.find("[[granular.rods]]")) +
                                       "[granular.rods_random]\ncount = 4\n" +
                                       complete.substr(complete.find("[measure]"));

/// The complete scene with rods that have bodies.
inline const std::string with_bodies =
    complete.substr(0, complete.find("[[rods]]")) + "[body]\n" + complete.substr(complete.find("[[rods]]"));

/// Tracks of a camera in place of a bed.
inline const std::string filmed = R"(schema = 1
[tracks]
file = "tracks.csv"
frames_per_second = 50.0
pixel = "12.4 um"
[[tracks.bead_kinds]]
radius = "0.4 mm"
[measure]
order = true
)";

/// The scene in which the key may stand.
inline const std::string& complete_for(const KeyInfo& info) {
    if (info.table.starts_with("tracks"))
        return filmed;
    if (info.table == "rods[].body")
        return with_bodies;
    if (info.table == "rods_random")
        return crowded;
    if (info.table == "granular.rods_random")
        return crowded_bed;
    return info.table.starts_with("scan") ? scanned : complete;
}

/// Smallest granular scene; lines are appended to [granular].
inline std::string bed(const std::string& more = "") {
    return "schema = 1\n[granular]\nphi_b = 0.7\nbox = \"30 a\"\nduration = 1.0\n" + more;
}

/// Smallest scene of a bed with a wall; keys of the container.
inline std::string in_container(const std::string& keys) {
    return "schema = 1\n[granular]\nphi_b = 0.7\nduration = 1.0\n[granular.container]\n" + keys;
}

/// Smallest scene with two rods; lines are appended.
inline std::string two_rods(const std::string& more = "") {
    return "schema = 1\n[[rods]]\nposition = [0.0, 0.0]\n[[rods]]\nposition = [0.0, 1.0]\n[rods_run]\nt_end "
           "= 2.0\n" +
           more;
}

inline Scene parse(const std::string& text, const std::vector<std::string>& overrides = {}) {
    return rodwake::scene::parse_scene(text, "x.toml", overrides);
}

/// What is wrong with the scene; empty if it is right.
inline std::vector<Diagnostic> problems_of(const std::string& text,
                                           const std::vector<std::string>& overrides = {}) {
    try {
        parse(text, overrides);
    } catch (const rodwake::scene::SceneError& error) {
        return error.diagnostics();
    }
    return {};
}

/// The text of the error; empty if the scene is right.
inline std::string error_text(const std::string& text, const std::vector<std::string>& overrides = {}) {
    try {
        parse(text, overrides);
    } catch (const rodwake::scene::SceneError& error) {
        return error.what();
    }
    return "";
}

/// Checks that the error of the scene has this part.
inline void says(const std::string& text, const std::string& part,
                 const std::vector<std::string>& overrides = {}) {
    CHECK_THAT(error_text(text, overrides), Catch::Contains(part));
}

/// Checks that the scene survives being written and read, and is written the same again.
inline void check_round_trip(const Scene& scene) {
    const std::string written = rodwake::scene::to_toml(scene);
    INFO(written);
    const Scene again = rodwake::scene::parse_scene(written, scene.path);
    CHECK(again == scene);
    CHECK(rodwake::scene::to_toml(again) == written);
}

/// Some problem at this key has this in its text.
inline bool mentions(const std::vector<Diagnostic>& problems, const std::string& key,
                     const std::string& part) {
    return std::any_of(problems.begin(), problems.end(), [&](const Diagnostic& p) {
        return p.key == key && p.text().find(part) != std::string::npos;
    });
}

inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
    for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
        text.replace(at, from.size(), to);
    return text;
}

/// "field.cuts[]" and "at": "field.cuts.0.at" for -s, "field.cuts[0].at" in messages.
inline std::string full_name(const KeyInfo& info) {
    return info.table.empty() ? info.name : info.table + "." + info.name;
}
inline std::string override_path(const KeyInfo& info) { return replaced(full_name(info), "[]", ".0"); }
inline std::string message_path(const KeyInfo& info) { return replaced(full_name(info), "[]", "[0]"); }

} // namespace scene_test
