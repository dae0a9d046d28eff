// Every key of the field lists that holds one value: the setter gives what writing the scene, overriding the
// key and reading it again gives, to the last bit, and refuses what that refuses.

#include "support.hpp"

#include "rodwake/scene/read.hpp"
#include "rodwake/scene/set.hpp"
#include "scene/node.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <random>

using namespace scene_test;
using namespace rodwake::scene;

namespace {

/// Nothing: refused.
using Result = std::optional<Scene>;

/// To the last bit and the sign of zero: the text has as many digits as it takes.
bool same(const Result& a, const Result& b) {
    return a.has_value() == b.has_value() && (!a || (*a == *b && to_toml(*a) == to_toml(*b)));
}

std::string as_toml(const Value& value) {
    return to_inline(std::visit([](const auto& v) { return Node{{}, v}; }, value));
}

Result by_text(const std::string& toml, const std::string& key, const Value& value) try {
    return parse(toml, {key + "=" + as_toml(value)});
} catch (const SceneError&) {
    return std::nullopt;
}

Result by_setter(Scene scene, const ValueSetter& setter, const Value& value) {
    if (setter.set(scene, setter.held(value)) || !validate(scene).empty())
        return std::nullopt;
    return scene;
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// Bounds from "> -1 and <= 0.999", "within +-1e+12", "0".
std::pair<double, double> bounds(const KeyInfo& info) {
    if (has(info.legal, "within"))
        return {-std::stod(info.legal.substr(9)), std::stod(info.legal.substr(9))};
    if (!has(info.legal, "<="))
        return {std::stod(info.legal), std::stod(info.legal)};
    return {std::stod(info.legal.substr(info.legal.find(' '))),
            std::stod(info.legal.substr(info.legal.find("<=") + 2))};
}

/// Values at, beyond and between the bounds, where most of them are small, as in scenes.
std::vector<Value> numbers(const KeyInfo& info, std::mt19937& random) {
    const auto [low, high] = bounds(info);
    std::vector<Value> values{low, high, -HUGE_VAL, std::nan(""), std::nextafter(high, HUGE_VAL), 2.5, 1e-4};
    for (int i = 0; i < 6; ++i) {
        const double part = std::pow(10.0, std::uniform_real_distribution(-6.0, 0.0)(random));
        values.push_back(low + (std::min(high, low + 50.0) - low) * part);
    }
    return values;
}

std::vector<Value> integers(const KeyInfo& info) {
    const auto [low, high] = bounds(info);
    std::vector<Value> values{2.0, "2"};
    for (const std::int64_t value : {-2, -1, 0, 1, 2, 3, 7, 40, 5000})
        values.push_back(value);
    values.push_back(static_cast<std::int64_t>(std::min(high, 9e18)));
    return values;
}

std::vector<Value> names(const KeyInfo& info) {
    std::vector<Value> values{"abc", "x y", std::int64_t{1}, true, "a\tb"};
    for (std::size_t at = 0; at < info.legal.size();) {
        const std::size_t end = std::min(info.legal.find_first_of(",;", at), info.legal.size());
        values.push_back(info.legal.substr(at, end - at));
        at = std::min(info.legal.find_first_not_of(",; ", end), info.legal.size());
    }
    return values;
}

struct Single {
    std::string key; ///< path of one value
    std::vector<Value> values;
};

/// The single values that a key stands for: itself, or entries of its list or table.
std::vector<Single> singles(const KeyInfo& info, std::mt19937& random) {
    const std::string key = override_path(info);
    if (info.type == "string" || info.type == "boolean")
        return {{key, info.type == "string" ? names(info)
                                            : std::vector<Value>{true, false, std::int64_t{1}, "true"}}};
    if (info.type == "integer")
        return {{key, integers(info)}};
    if (info.type == "1 to 100 integers")
        return {{key + ".0", integers(info)}};
    if (info.type == "table of numbers")
        return {{key + ".eta", {0.5, 3.25, -2.0, std::nan("")}}, {key + ".kappa", {0.5, 1e13}}};
    if (has(info.type, "word")) // of another key
        return {{key + (has(info.type, "words") ? ".0" : ""),
                 {1.5, -2.0, std::int64_t{3}, "10 deg", "abc", true, std::nan(""), HUGE_VAL}}};
    if (has(info.type, "table of") || has(info.type, "names") || has(info.type, "pairs"))
        return {};
    if (has(info.type, "numbers"))
        return {{key + ".0", numbers(info, random)}, {key + ".1", numbers(info, random)}};
    return {{key, numbers(info, random)}};
}

/// Scenes in which together every key can be set.
const std::vector<std::string> bases{
    complete,
    replaced(complete, "schema = 1\n", "schema = 1\nunits = \"si\"\n"),
    replaced(replaced(complete, "phi_b = 0.78", "beads = 500"), "t_end = 30.0",
             "output_times = [1.0, 2.5, 30.0]\nrtol = 1e-6\natol = 1e-9"),
    replaced(complete, "kind = \"cut\"", "kind = \"movie\"\nx = [0.0, 0.01]\ny = [0.0, 0.01]"),
    bed("restart_from = \"a.rwc\"\nstart = \"restart\"\n[granular.contacts.bead_bead]\nfriction = 0.1\n"
        "[granular.contacts.bead_rod]\nfriction = 0.1\n[granular.contacts.rod_rod]\nfriction = 0.1\n"
        "[[granular.rods]]\nposition = [0.0, 0.0]\nkind = \"apolar\"\n"
        "[measure]\nmicrorheology = true\norder = true\n[[figures]]\nname = \"s\"\nkind = \"series\"\n"
        "quantity = \"psi6\"\n[[variants]]\nname = \"v\"\nset = { \"granular.runs\" = 2 }\n"),
    two_rods("[medium]\nfitted = true\n[medium.table]\ntolerance = 1e-6\n[medium.measured]\nfile = "
             "\"m.h5\"\n[medium.dynamic]\nbox = 30.0\n[noise]\nrotational_diffusion = 0.0\ntime_step = 0.1\n"
             "[fit]\nparameters = [\"f_over_mu\", \"eta\", \"xi\", \"x0\"]\nloss = \"huber\"\nstarts = 3\n"
             "likelihood = [\"eta\"]\n[[fit.profiles]]\nfile = \"u.csv\"\nrange = [1.0, 9.0]\n"
             "[[figures]]\nname = \"f\"\nkind = \"fit\"\nprofiles = [0]\n"),
    replaced(complete, "kind = \"cut\"", "kind = \"fit_likelihood\""),
    replaced(complete, "[[fit.trajectories]]\n", "[[fit.trajectories]]\nrods = [0, 1]\n"),
    scanned,
    scanned_critical,
    crowded,
    replaced(crowded, "schema = 1\n", "schema = 1\nunits = \"si\"\n"),
    replaced(scanned_grid, "key = \"coupling.kappa\"\nfrom = 0.1\nto = 100.0\n",
             "keys = [\"coupling.gamma1\", \"coupling.gamma2\"]\nfactor = [1.0, -1.0]\nvalues = [1.0, "
             "\"2\"]\n"),
    replaced(scanned.substr(0, scanned.find("[[scan.axes]]")), "design = \"adaptive\"",
             "design = \"list\"\nfile = \"p.csv\""),
    replaced(scanned, "kind = \"cut\"", "kind = \"phase_diagram\"\nslices = [1.0, 2.0]"),
    replaced(scanned, "kind = \"cut\"", "kind = \"scan_curve\""),
    "schema = 1\n[fit]\nparameters = [\"force\", \"p_yy\"]\n"
    "fixed = { c11 = 3.0, c22 = 3.0, c12 = 1.0, c66 = 1.0 }\nfixed_errors = { c66 = 0.1 }\n"
    "rod_length = 4.0\n[[fit.maps]]\nfiles = [\"m.h5\"]\nspeed = 2.0\nbox = [78.0, 77.0]\nname = \"m\"\n"
    "[[fit.masks]]\nstrip = 8.0\nradius = 10.0\nsector = [0.1, 1.0]\n",
    "schema = 1\n[fit]\nparameters = [\"f_over_mu\", \"eta\"]\nfixed = { xi = 500.0 }\nbounds = { f_over_mu "
    "= [0.0, 9.0] "
    "}\n[fit.posterior]\nsamples = 400\n[[fit.maps]]\nfiles = "
    "[\"m.h5\"]\n"
    "[[fit.profiles]]\nfile = \"u.csv\"\nrole = \"predict\"\n[[fit.compare]]\nname = \"l\"\nline = 0\n",
    in_container("radius = \"20 a\"\nfriction = 0.1\nrestitution = 0.5\n"),
    in_container("kind = \"rectangle\"\nsides = [0.01, 0.02]\n"),
    bed("[granular.rods_random]\ncount = 4\n"),
    "schema = 1\n[granular]\nbox = \"30 a\"\nduration = 1\nstart = \"file\"\nstart_file = \"b.csv\"\n",
    bed("[granular.body_force]\nkind = \"gaussian\"\nacceleration = 1.0\nwidth = \"1 a\"\n"
        "position = [0.001, 0.002]\n"),
    replaced(complete, "likelihood = ", "bounds = { f_over_mu = [0.1, 10.0] }\nlikelihood = ") +
        "[fit.posterior]\nchains = 4\n",
    filmed,
    replaced(filmed, "frames_per_second = 50.0\npixel = \"12.4 um\"\n",
             "time_column = \"t\"\nwindow = \"periodic\"\nbox = \"30 a\"\npixel = \"12.4 "
             "um\"\n[tracks.columns]\nid = \"n\"\n")};

/// What numbers mean is settled when the scene is read; a single modulus says nothing.
const std::vector<std::string> never{"units",
                                     "scales.bead_radius",
                                     "scales.f_over_mu",
                                     "scales.v0",
                                     "medium.lame_lambda",
                                     "medium.bulk_modulus",
                                     "medium.mu",
                                     "tracks.window",
                                     "fit.maps[].place_unit",
                                     "fit.maps[].value_unit",
                                     "fit.profiles[].place_unit",
                                     "fit.profiles[].value_unit"};

/// Every `stride`-th value is compared with the text, the others are set alone: reading takes longest.
void check_singles(std::size_t stride) {
    std::mt19937 random(11);
    std::size_t count = 0;
    std::map<std::string, int> accepted;
    for (std::size_t base = 0; base < bases.size(); ++base) {
        const Scene scene = parse(bases[base]);
        const std::string toml = to_toml(scene);
        for (const KeyInfo& info : scene_keys())
            for (const auto& [key, values] : singles(info, random)) {
                accepted[full_name(info)];
                std::optional<ValueSetter> setter;
                try {
                    setter = compile_setter(scene, key);
                } catch (const rodwake::InputError&) { // no such table here, or nothing that a setter sets
                    continue;
                }
                for (const Value& value : values) {
                    CAPTURE(base, key, as_toml(value));
                    const Result set = by_setter(scene, *setter, value);
                    if (count++ % stride == 0)
                        CHECK(same(set, by_text(toml, key, value)));
                    accepted[full_name(info)] += set.has_value();
                }
            }
    }
    for (const auto& [key, times] : accepted) {
        CAPTURE(key);
        CHECK((times > 0) != (std::ranges::count(never, key) > 0));
    }
}

} // namespace

TEST_CASE("single values are set as by writing and reading the scene, or refused as there") {
    check_singles(5); // prime to how many values most keys have, so all kinds come up
}

TEST_CASE("every single value is set as by writing and reading the scene, or refused as there", "[.long]") {
    check_singles(1);
}

TEST_CASE("keys that are refused for good are refused as text or said to be impossible") {
    for (const std::string& key : never)
        CHECK_THROWS_AS(compile_setter(parse(complete), key), rodwake::InputError);
    const std::string toml = to_toml(parse(complete));
    for (const std::string key : {"medium.lame_lambda", "medium.bulk_modulus", "medium.mu"})
        CHECK_FALSE(by_text(toml, key, 1.0));
}

TEST_CASE("the comparison sees the last bit, the sign of zero and a refusal") {
    const Scene scene = parse(complete);
    Scene other = scene;
    CHECK(same(scene, other));
    other.coupling->kappa = std::nextafter(scene.coupling->kappa, 1.0);
    CHECK_FALSE(same(scene, other));
    Scene plus = scene, minus = scene;
    plus.rods[0].heading = 0.0;
    minus.rods[0].heading = -0.0;
    CHECK_FALSE(same(plus, minus));
    CHECK_FALSE(same(scene, std::nullopt));
    CHECK(same(std::nullopt, std::nullopt));
    CHECK_FALSE(by_text(to_toml(scene), "coupling.kapa", 1.0));
}
