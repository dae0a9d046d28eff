// Every key of the scene, taken from the field lists: a new key without tests here fails.

#include "key_values.hpp"
#include "rodwake/core/record.hpp"

#include <catch2/catch.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <stdexcept>

using namespace scene_test;

namespace {

/// What no range and no list of names tells: the rule of a key that its description leaves to the words.
struct SpecialRule {
    std::string key, value, said, why;
};

const std::vector<SpecialRule> special_rules{
    {"rods_run.output_times", "[2.0, 1.0]", "times must increase strictly", "order of the entries"},
    {"rods_run.output_interval", "40.0", "must be between t_end/1000000 and t_end", "beside t_end"},
    {"field.x", "[5.0, -5.0]", "must be below max", "order of the two"},
    {"fit.bounds", "{ eta = [2.0, 1.0] }", "must be below", "order of the two"},
    {"fit.fixed", "{ kappa = 1e13 }", "within +-1e+12", "legal tells the names, not their values"},
    {"figures[].name", "\"../etc/passwd\"", "usable as a file name", "safe on every system"},
    {"variants[].name", "\"\"", "usable as a file name", "safe on every system"},
    {"fit.name", "\"\"", "usable as a file name", "safe on every system"},
    {"fit.models[].name", "\"\"", "usable as a file name", "safe on every system"},
};

KeyInfo key_named(const std::string& name) {
    const auto keys = rodwake::scene::scene_keys();
    const auto found = std::ranges::find(keys, name, full_name);
    if (found == keys.end())
        throw std::runtime_error("no key " + name);
    return *found;
}

/// What is wrong with the complete scene if the key has the rule's value.
std::vector<Diagnostic> problems_by(const SpecialRule& rule) {
    return scene_test::problems_of(placed(key_named(rule.key), rule.value).text);
}

/// Whether the description tells of the value already, so that no rule is needed.
bool reported_by_description(const SpecialRule& rule) {
    const KeyInfo info = key_named(rule.key);
    return std::ranges::any_of(problems_by(rule),
                               [&](const Diagnostic& p) { return scene_test::is_reported(info, p); });
}

bool are_refused(const KeyInfo& info, const std::vector<Refused>& values) {
    return std::ranges::all_of(values, [&](const Refused& value) { return is_refused(info, value); });
}

/// A scene in which the key's example is legal, as far as the scene itself decides it.
std::string scene_for_example(const KeyInfo& info) {
    const std::string range = "from = 0.1\nto = 100.0\n", one = "key = \"coupling.kappa\"\n";
    if (full_name(info) == "medium.fitted") // which gives eta and xi
        return replaced(complete, "eta = 1.0\nalpha = 0.5\n", "");
    if (full_name(info) == "granular.output.every_bead") // figures of the bed need all beads
        return complete.substr(0, complete.find("[[figures]]"));
    if (info.table == "granular.body_force")
        return complete +
               "\n[granular.body_force]\nkind = \"gaussian\"\nacceleration = 1.0\nwidth = \"1 a\"\n";
    if (info.table == "medium.measured" && info.name != "file") // without which there is no such table
        return complete + "\n[medium.measured]\nfile = \"measure.h5\"\n";
    if (info.table == "scan" && (info.name == "solve_for" || info.name == "from" || info.name == "to"))
        return replaced(scanned_critical, "coupling.kappa",
                        "coupling.gamma1"); // the example solves for kappa
    if (full_name(info) == "scan.axes[].keys" || full_name(info) == "scan.axes[].factor")
        return replaced(scanned, one, "keys = [\"coupling.gamma1\", \"coupling.gamma2\"]\n");
    if (full_name(info) == "scan.axes[].values")
        return replaced(scanned_grid, range, "");
    if (full_name(info) == "scan.file")
        return replaced(scanned.substr(0, scanned.find("[[scan.axes]]")), "adaptive", "list");
    if (full_name(info) == "tracks.time_column")
        return replaced(filmed, "frames_per_second = 50.0\n", "");
    if (full_name(info) == "tracks.box")
        return replaced(filmed, "pixel", "window = \"periodic\"\npixel");
    for (const char* name : {"cells", "boundary", "slices", "column"})
        if (full_name(info) == std::string("figures[].") + name)
            return scanned;
    return complete_for(info);
}

bool takes_units(const KeyInfo& info) { return !info.unit.empty(); }

} // namespace

TEST_CASE("every key refuses values of another type, with their place and what is expected") {
    for (const auto& info : rodwake::scene::scene_keys())
        for (const auto& refused : wrong_types(info)) {
            INFO(full_name(info) << " = " << refused.value.substr(0, 100) << ": " << refused.said);
            CHECK(is_refused(info, refused));
        }
}

TEST_CASE("every key refuses values that are not legal, with their place and what is") {
    for (const auto& info : rodwake::scene::scene_keys()) {
        const auto values = refused_values(info);
        for (const auto& refused : values) {
            INFO(full_name(info) << " = " << refused.value.substr(0, 100) << ": " << refused.said);
            CHECK(is_refused(info, refused));
        }
        INFO(full_name(info) << ": without an illegal value; give it a special rule");
        CHECK((!values.empty() ||
               std::ranges::find(special_rules, full_name(info), &SpecialRule::key) != special_rules.end()));
    }
}

TEST_CASE("no key refuses its bounds or choices as outside them") {
    for (const auto& info : rodwake::scene::scene_keys())
        for (const auto& value : accepted_values(info))
            for (const auto& problem : problems_of(placed(info, value).text)) {
                INFO(problem.text());
                CHECK_FALSE(is_reported(info, problem));
            }
}

TEST_CASE("the legal text of every key tells its choices") {
    for (const auto& info : rodwake::scene::scene_keys()) {
        if (info.choices.empty())
            continue;
        const auto list = [](const auto& names) { return fmt::format("{}", fmt::join(names, ", ")); };
        CHECK(info.legal == list(info.choices));
    }
}

TEST_CASE("special rules are refused, and only what no description tells is listed") {
    for (const auto& rule : special_rules) {
        INFO(rule.key << ": " << rule.why);
        const auto problems = problems_by(rule);
        CAPTURE(problems.empty() ? "no problem" : problems.front().text());
        CHECK(std::ranges::any_of(problems, [&](const Diagnostic& p) {
            return p.key.starts_with(message_path(key_named(rule.key))) && p.text().starts_with("x.toml:") &&
                   p.message.find(rule.said) != std::string::npos;
        }));
        CHECK_FALSE(reported_by_description(rule));
    }
}

TEST_CASE("a rule that the range, the choices or the type tells is found out") {
    CHECK(reported_by_description(SpecialRule{"medium.eta", "-2.0", "longitudinal modulus", ""}));
    CHECK(reported_by_description(SpecialRule{"rods_run.output_times", "[-1.0, 1.0]", "must be >= 0", ""}));
    CHECK(reported_by_description(SpecialRule{"coupling.polar_basis", "\"laplace\"", "one of", ""}));
    CHECK(reported_by_description(
        SpecialRule{"fit.tied", "{ f2d_over_mu = [\"eta\"] }", "[name, factor]", ""}));
    CHECK(reported_by_description(SpecialRule{"title", "1", "string", ""}));
}

namespace {

/// Changes the description of every `stride`-th key in each of its parts: the tests above must see that.
void check_descriptions(std::size_t stride) {
    const std::vector<KeyInfo> keys = rodwake::scene::scene_keys();
    for (std::size_t k = 0; k < keys.size(); k += stride) {
        const KeyInfo& info = keys[k];
        INFO(full_name(info));
        const auto wrong_in = [&](const auto& change) {
            KeyInfo wrong = info;
            change(wrong);
            return !are_refused(wrong, refused_values(wrong)) || !are_refused(wrong, wrong_types(wrong));
        };
        CHECK(wrong_in([](KeyInfo& i) { i.type = i.type == "string" ? "integer" : "string"; }));
        CHECK(wrong_in([](KeyInfo& i) { i.name += "x"; }));
        if (info.low)
            CHECK(wrong_in([](KeyInfo& i) { i.legal += "0"; }));
        if (info.low < info.high) {
            const double middle = *info.low + (*info.high - *info.low) / 2.0;
            CHECK(wrong_in([&](KeyInfo& i) { i.low = middle; }));
            CHECK(wrong_in([&](KeyInfo& i) { i.high = middle; }));
        }
        if (!info.choices.empty())
            CHECK(wrong_in([](KeyInfo& i) { i.choices.push_back("planted"); }));
    }
}

} // namespace

TEST_CASE("a description that is not the reader's is found out") { check_descriptions(11); }

TEST_CASE("a description that is not the reader's is found out, for every key", "[.long]") {
    check_descriptions(1);
}

TEST_CASE("a refusal needs the key, the place and the whole text") {
    const KeyInfo eta = key_named("medium.eta"), field = key_named("medium.field");
    const std::string legal = "must be > -1 and <= 1e+12";
    CHECK(is_refused(eta, {"-1", legal}));
    CHECK_FALSE(is_refused(eta, {"1", legal}));
    CHECK_FALSE(is_refused(eta, {"-1", legal, "[0]"}));
    CHECK_FALSE(is_refused(eta, {"-1", legal, "", 1}));
    CHECK_FALSE(is_refused(key_named("medium.mu"), {"-1", legal}));
    CHECK_FALSE(is_refused(eta, {"-1", "must be > -1"}));
    CHECK_FALSE(is_refused(eta, {"-1", "must be > -1 and <= 1"}));
    CHECK_FALSE(has_whole("must be one of x, y", "must be one of x"));
}

TEST_CASE("every misspelt key is refused with the right one named") {
    for (const auto& info : rodwake::scene::scene_keys()) {
        INFO(full_name(info));
        KeyInfo misspelt = info;
        misspelt.name = info.name.size() > 2 ? info.name + "q" : info.name + "_";
        const auto problems = problems_of(complete_for(info), {override_path(misspelt) + "=1"});
        CHECK(mentions(problems, message_path(misspelt), "unknown"));
        CHECK(mentions(problems, message_path(misspelt), "Known keys: "));
        CHECK(mentions(problems, message_path(misspelt), "did you mean \"" + info.name + "\"?"));
    }
}

TEST_CASE("every dimensional key refuses a unit of another dimension") {
    for (const auto& info : rodwake::scene::scene_keys()) {
        if (!takes_units(info))
            continue;
        INFO(full_name(info));
        const std::string wrong = info.unit.find("rad") == 0 ? "5 s" : "30 deg";
        const bool list = info.type.find("numbers") != std::string::npos;
        const bool pairs = info.type.find("pairs") != std::string::npos;
        const std::string value = pairs  ? "[[\"" + wrong + "\", 0]]"
                                  : list ? "[\"" + wrong + "\", 1]"
                                         : wrong;
        const std::string& scene = info.table.starts_with("tracks") ? filmed : complete;
        const auto text = error_text(scene, {override_path(info) + "=" + value});
        CHECK_THAT(text, Catch::Contains("found \"" + wrong + "\" (string)"));
    }
}

TEST_CASE("the example of every key is legal") {
    for (const auto& info : rodwake::scene::scene_keys()) {
        INFO(full_name(info));
        REQUIRE_FALSE(info.example.empty());
        REQUIRE_FALSE(info.meaning.empty());
        std::vector<std::string> overrides{override_path(info) + "=" + info.example};
        if (info.name == "lame_lambda" || info.name == "bulk_modulus")
            overrides.push_back("medium.mu=1.0");
        if (info.name == "mu")
            overrides.push_back("medium.lame_lambda=1.0");
        if (full_name(info) == "figures[].gammas")
            overrides.push_back("figures.0.kind=polar_streamlines");
        if (full_name(info) == "figures[].along")
            overrides.insert(overrides.end(), {"figures.0.kind=profile"});
        if (info.name == "quantity" || info.name == "against")
            overrides.insert(overrides.end(), {"figures.0.kind=series", "measure.microrheology=true"});
        if (info.name == "restart_from")
            overrides.push_back("granular.start=restart");
        if (info.name == "start_file" || info.name == "start_frame")
            overrides.push_back("granular.start=file");
        if (info.name == "start_frame")
            overrides.push_back("granular.start_file=trajectory.h5md");
        if (full_name(info) == "fit.measured_drag" || full_name(info) == "fit.compare[].line")
            overrides.insert(
                overrides.begin(),
                {"fit.trajectories=[]", info.name == "line" ? "fit.fixed={ xi = 500.0 }" : "fit.fixed={}",
                 "fit.likelihood=[]", "measure.mechanics=true", R"(fit.parameters=["f_over_mu", "eta"])",
                 R"(fit.compare=[{ name = "l", line = 0 }])",
                 R"(fit.profiles=[{ file = "u.csv", role = "predict" }])"});
        else if (info.table == "fit")
            overrides.insert(overrides.begin(),
                             {"fit.trajectories=[]",
                              "fit.fixed={ force = 1.0, c11 = 3.0, c22 = 3.0, c12 = 1.0, c66 = 1.0 }"});
        if (info.table.starts_with("fit.posterior"))
            overrides.insert(overrides.begin(), "fit.bounds={ f_over_mu = [0.1, 10.0] }");
        if (full_name(info) == "fit.fixed")
            overrides.insert(overrides.begin(), {"fit.maps=[]", "fit.masks=[]"});
        if (info.name == "profiles" || info.name == "residuals")
            overrides.push_back("figures.0.kind=fit");
        if (info.name == "parameter")
            overrides.push_back("figures.0.kind=fit_likelihood");
        if (info.name == "colour")
            overrides.push_back("figures.0.kind=snapshot");
        if (info.name == "cells" || info.name == "boundary" || info.name == "slices")
            overrides.push_back("figures.0.kind=phase_diagram");
        if (info.name == "column")
            overrides.push_back("figures.0.kind=scan_curve");
        const bool of_rectangle = info.name == "kind" || info.name == "sides";
        const std::string scene = info.table != "granular.container" ? scene_for_example(info)
                                  : of_rectangle
                                      ? in_container("kind = \"rectangle\"\nsides = [\"40 a\", \"30 a\"]\n")
                                      : in_container("radius = \"20 a\"\n");
        CHECK(error_text(scene, overrides) == "");
    }
}

TEST_CASE("a member of a scene's table without its key is found out") {
    using namespace rodwake::scene;
    using rodwake::member_count;
    struct Table {
        std::string name;
        std::size_t members;
        int without_key; ///< members less keys: tables of their own, and what several keys or none give
    };
    const std::vector<Table> tables = {
        {"fit", member_count<Fit>(), -1},
        {"fit.posterior", member_count<FitPosterior>(), 0},
        {"fit.trajectories[]", member_count<FitTrajectory>(), 0},
        {"field", member_count<Field>(), 1},
        {"field.cuts[]", member_count<Cut>(), 0},
        {"figures[]", member_count<Figure>(), 0},
        {"granular", member_count<Granular>(), 9},
        {"granular.container", member_count<BedContainer>(), 0},
        {"granular.output", member_count<GranularOutput>(), 0},
        {"granular.rods_random", member_count<RandomBedRods>(), 0},
        {"measure", member_count<Measure>(), 0},
        {"medium.measured", member_count<MeasuredMedium>(), 0},
        {"noise", member_count<Noise>(), 0},
        {"rods_order", member_count<RodsOrder>(), 0},
        {"rods_random", member_count<RandomRods>(), 0},
        {"rods_run", member_count<RodsRun>(), 0},
        {"scan", member_count<Scan>(), 2},
        {"scan.axes[]", member_count<ScanAxis>(), 0},
        {"tracks", member_count<Tracks>(), 2},
        {"tracks.columns", member_count<TracksColumns>(), 0},
        {"variants[]", member_count<Variant>(), 0},
    };
    const auto keys = scene_keys();
    for (const Table& table : tables) {
        INFO(table.name);
        CHECK(static_cast<int>(table.members) -
                  static_cast<int>(std::ranges::count(keys, table.name, &KeyInfo::table)) ==
              table.without_key);
    }
}
