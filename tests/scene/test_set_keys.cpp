// Every key of the field lists that holds one value: the setter gives what writing the scene, overriding the
// key and reading it again gives, to the last bit, and refuses what that refuses.

#include "support.hpp"

#include "rodwake/scene/read.hpp"
#include "rodwake/scene/set.hpp"
#include "scene/node.hpp"
#include "store/scratch.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
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
    "schema = 1\n[body]\nspheres = 100\nlength = 40.0\nthick_diameter = 2.6\nthin_diameter = "
    "0.5\n[[rods]]\nposition = "
    "[0.0, 0.0]\nbody = { spheres = 100, length = 40.0, thick_diameter = 2.6, thin_diameter = 0.5 "
    "}\n[[rods]]\nposition "
    "= [0.0, 100.0]\n[rods_run]\nt_end = 2.0\n",
    replaced(crowded, "schema = 1\n", "schema = 1\nunits = \"si\"\n"),
    replaced(
        scanned_grid, "key = \"coupling.kappa\"\nfrom = 0.1\nto = 100.0\n",
        "keys = [\"coupling.gamma1\", \"coupling.gamma2\"]\nfactor = [1.0, -1.0]\nvalues = [1.0, \"2\"]\n"),
    replaced(scanned.substr(0, scanned.find("[[scan.axes]]")), "design = \"adaptive\"",
             "design = \"list\"\nfile = \"p.csv\""),
    replaced(scanned, "kind = \"cut\"", "kind = \"phase_diagram\"\nslices = [1.0, 2.0]"),
    replaced(scanned, "kind = \"cut\"", "kind = \"scan_curve\""),
    "schema = 1\n[fit]\nparameters = [\"force\", \"p_yy\"]\n"
    "fixed = { c11 = 3.0, c22 = 3.0, c12 = 1.0, c66 = 1.0 }\nfixed_errors = { c66 = 0.1 }\n"
    "rod_length = 4.0\n[[fit.maps]]\nfiles = [\"m.h5\"]\nspeed = 2.0\nbox = [78.0, 77.0]\nname = \"m\"\n"
    "[[fit.masks]]\nstrip = 8.0\nradius = 10.0\nsector = [0.1, 1.0]\n",
    "schema = 1\n[fit]\nparameters = [\"f_over_mu\", \"eta\"]\nfixed = { xi = 500.0 }\nbounds = { f_over_mu "
    "= [0.0, 9.0] }\n[fit.posterior]\nsamples = 400\n[[fit.maps]]\nfiles = [\"m.h5\"]\n"
    "[[fit.profiles]]\nfile = \"u.csv\"\nrole = \"predict\"\n[[fit.compare]]\nname = \"l\"\nline = 0\n",
    in_container("radius = \"20 a\"\nfriction = 0.1\nrestitution = 0.5\n"),
    in_container("kind = \"rectangle\"\nsides = [0.01, 0.02]\n"),
    bed("[granular.rods_random]\ncount = 4\n"),
    "schema = 1\n[granular]\nbox = \"30 a\"\nduration = 1\nstart = \"file\"\nstart_file = \"b.csv\"\n"
    "start_frame = 3\n",
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

/// Every `stride`-th value is compared with the text, since reading takes longest; others are set until one
/// of their key is accepted.
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
                    const bool compared = count++ % stride == 0;
                    if (!compared && accepted[full_name(info)] > 0)
                        continue;
                    CAPTURE(base, key, as_toml(value));
                    const Result set = by_setter(scene, *setter, value);
                    if (compared)
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
    check_singles(17); // prime to how many values most keys have, so all kinds come up
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

namespace {

/// The message of compile_setter.
std::string why_not(const Scene& scene, const std::vector<std::string>& keys) {
    return store_test::error_of<rodwake::InputError>([&] { (void)compile_setter(scene, keys); });
}

std::string wrong(Scene scene, const std::string& key, const Value& value) {
    return compile_setter(scene, key).set(scene, value).value_or("");
}

} // namespace

TEST_CASE("what follows from a key is kept right") {
    Scene scene = parse(complete);
    CHECK(wrong(scene, "medium.alpha", 0.25) == "");
    REQUIRE_FALSE(compile_setter(scene, "medium.alpha").set(scene, 0.25));
    CHECK(scene.medium->xi == 4.0);
    REQUIRE_FALSE(compile_setter(scene, "rods_run.rtol").set(scene, 1e-6));
    CHECK(scene.rods_run->atol == 1e-6 / 100.0);
    REQUIRE_FALSE(compile_setter(scene, "rods_run.atol").set(scene, 1e-7));
    REQUIRE_FALSE(compile_setter(scene, "rods_run.rtol").set(scene, 1e-5));
    CHECK(scene.rods_run->atol == 1e-7); // given now
    REQUIRE_FALSE(compile_setter(scene, "rods_run.t_end").set(scene, 10.0));
    CHECK(scene.rods_run->output_times.size() == 200);
    CHECK(scene.rods_run->output_times.back() == 10.0);
    REQUIRE_FALSE(compile_setter(scene, "granular.beads").set(scene, std::int64_t{40}));
    CHECK_FALSE(scene.granular->phi_b);
    REQUIRE_FALSE(compile_setter(scene, "granular.rods.1.kind").set(scene, "apolar"));
    CHECK(scene.granular->rods[1].shape.spheres == 13);
}

TEST_CASE("several keys are set at once, alternatives among them together") {
    Scene scene = parse(complete);
    const std::vector<std::string> keys{"medium.mu", "rods.1.position.1", "medium.lame_lambda",
                                        "rods.0.heading"};
    const ValueSetter setter = compile_setter(scene, keys);
    const std::vector<Value> values{0.5, 7.0, 1.0, 2.0};
    REQUIRE_FALSE(setter.set(scene, values));
    CHECK(scene.medium->eta == 3.0);
    CHECK(scene.rods[1].position == std::vector{0.0, 7.0});
    CHECK(scene.rods[0].heading == 2.0);
    CHECK(setter.set(scene, 1.0) == "1 values for 4 keys");
    CHECK(why_not(scene, {"granular.phi_b", "granular.beads"}) ==
          "granular gives phi_b and beads: give one of phi_b | beads | start_file");
    CHECK(why_not(scene, {"medium.mu"}).starts_with("medium gives mu: give one of eta"));
    CHECK(why_not(scene, {"medium.xi", "medium.xi"}) != "");
}

TEST_CASE("keys that cannot be set say why") {
    const Scene scene = parse(complete);
    CHECK(why_not(scene, {"coupling.kapa"})
              .starts_with("[coupling] unknown key \"kapa\" (did you mean \"kappa\"?). Known keys: kappa, "));
    CHECK(why_not(scene, {"rods.1.headin"})
              .starts_with("[[rods]] unknown key \"headin\" (did you mean \"heading\"?)"));
    CHECK(why_not(scene, {"copling.kappa"})
              .starts_with("unknown table or key \"copling\" (did you mean \"coupling\"?)"));
    CHECK(why_not(scene, {"rods.2.heading"}) == "no entry 2: rods has 2 (numbered from 0)");
    CHECK(why_not(scene, {"rods.heading"}).starts_with("rods is a list"));
    CHECK(why_not(scene, {"rods.1"}).starts_with("rods is a list"));
    CHECK(why_not(scene, {"rods.1.position"}).starts_with("rods[1].position has several values"));
    CHECK(why_not(scene, {"rods.1.position.2"}) == "no entry 2: rods[1].position has 2 (numbered from 0)");
    CHECK(why_not(scene, {"coupling"}) == "coupling is a table: give a key in it");
    CHECK(why_not(scene, {"coupling.kappa.0"}) == "coupling.kappa is not a table");
    CHECK(why_not(scene, {"noise.rotational_diffusion"}) == "the scene has no [noise]");
    CHECK(why_not(scene, {"scan.seed"}) == "the scene has no [scan]");
    CHECK(why_not(scene, {"fit.start.etta"}).find("did you mean \"eta\"?") != std::string::npos);
    CHECK(why_not(scene, {"units"}).find("defines the units of the scene") != std::string::npos);
}

TEST_CASE("a wrong value is reported and leaves the scene as it was") {
    Scene scene = parse(complete);
    const Scene before = scene;
    const std::vector<std::tuple<std::string, Value, std::string>> cases{
        {"coupling.kappa", std::nan(""), "coupling.kappa = nan: must be a finite number"},
        {"coupling.kappa", HUGE_VAL, "coupling.kappa = inf: must be a finite number"},
        {"coupling.kappa", "5", "coupling.kappa: expected a number, found \"5\" (string)"},
        {"coupling.kappa", true, "coupling.kappa: expected a number, found true"},
        {"rods.1.position.0", 1e13, "rods[1].position[0] = 10000000000000.0: must be within +-1e+12"},
        {"medium.eta", -1.0,
         "medium.eta = -1.0: must be > -1 and <= 1e+12: the longitudinal modulus 1 + eta must"},
        {"medium.alpha", 0.0, "medium.alpha = 0.0: must be >= 1e-12 and <= 1e+12"},
        {"granular.beads", 40.0, "granular.beads: expected an integer, found 40.0"},
        {"granular.runs", std::int64_t{0}, "granular.runs = 0: must be >= 1 and <= 1000000"},
        {"granular.phi_b", 0.91, "granular.phi_b = 0.91: must be > 0 and <= 0.9069: a layer of equal discs"},
        {"rods_run.method", "rk4", "rods_run.method = \"rk4\": must be one of auto, bdf, adams, erk"},
        {"medium.field", "dynamics",
         "medium.field = \"dynamics\": must be one of exact, table, measured, dynamic (did you mean"},
        {"rods_run.output_interval", 31.0,
         "rods_run.output_interval is 31 f/(mu v0): must be between t_end/1000000"},
        {"medium.fitted", true, "medium.eta is given together with medium.fitted = true"},
        {"measure.order", std::int64_t{1}, "measure.order: expected true or false, found 1"},
        {"title", "two\nlines", "title = \"two\\u000Alines\": must be one line"}};
    for (const auto& [key, value, message] : cases) {
        CAPTURE(key, message);
        const auto error = compile_setter(scene, key).set(scene, value);
        CHECK(error.value_or("").starts_with(message));
        CHECK(scene == before);
    }
    scene.coupling.reset();
    CHECK(compile_setter(before, "coupling.kappa").set(scene, 1.0) == "the scene has no [coupling]");
}

TEST_CASE("values as a file has them become what the scene holds") {
    const Scene scene = parse(replaced(complete, "schema = 1\n", "schema = 1\nunits = \"si\"\n"));
    const auto held = [&](const std::string& key, const Value& value) {
        return std::get<double>(compile_setter(scene, key).held(value));
    };
    CHECK(held("medium.xi", 0.5) == 0.5 / scene.scales->f_over_mu);
    CHECK(held("medium.xi", std::int64_t{2}) == 2.0 / scene.scales->f_over_mu);
    CHECK(held("medium.xi", "3 f/mu") == 3.0);
    CHECK(held("medium.eta", 0.5) == 0.5);
    CHECK(held("granular.duration", 0.5) == 0.5);
    CHECK(held("granular.box", "2 a") == 2.0 * 0.4e-3);
    CHECK(held("fit.box", 78.0) == 78.0);
    CHECK(std::get<std::string>(compile_setter(scene, "rods_run.method").held("bdf")) == "bdf");
    CHECK_THROWS_AS(held("medium.xi", "3 s"), rodwake::InputError);
    CHECK_THROWS_AS(held("medium.eta", "3"), rodwake::InputError);
}

TEST_CASE("validate tells what values do to each other, without lines") {
    Scene scene = parse(complete);
    CHECK(validate(scene).empty());
    scene.rods_run->contact_distance.reset();
    REQUIRE_FALSE(compile_setter(scene, "rods.1.position.1").set(scene, 2.5));
    const auto problems = validate(scene);
    REQUIRE(problems.size() == 1);
    CHECK(problems[0].key == "rods.1.position");
    CHECK(problems[0].text() == "x.toml: rods[0] and rods[1] start at the same point");
    scene.medium.reset();
    CHECK(mentions(validate(scene), "field", "[field] needs [medium]"));
}
