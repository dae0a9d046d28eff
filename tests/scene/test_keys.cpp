// Every key of the scene, taken from the field lists: a new key without tests here fails.

#include "support.hpp"

#include <catch2/catch.hpp>
#include <map>

using namespace scene_test;

namespace {

/// A value outside the legal range for each key, and a part of the message.
struct Illegal {
    std::string value, part;
};

const std::map<std::string, Illegal> illegal_values{
    {"schema", {"2", "must be 1"}},
    {"units", {"\"imperial\"", "must be one of reduced, si"}},
    {"title", {"\"two\\nlines\"", "one line"}},
    {"scales.bead_radius", {"0.0", "must be > 0"}},
    {"scales.f_over_mu", {"-1.0", "must be > 0"}},
    {"scales.v0", {"0", "must be > 0"}},
    {"medium.eta", {"-1.0", "must be > -1"}},
    {"medium.poisson_ratio", {"1.0", "must be > -1 and <= 0.999"}},
    {"medium.lame_lambda", {"1e13", "within +-1e+12"}},
    {"medium.bulk_modulus", {"1e13", "within +-1e+12"}},
    {"medium.mu", {"0.0", "must be > 0"}},
    {"medium.xi", {"0.0", "must be >= 1e-12"}},
    {"medium.alpha", {"-0.1", "must be >= 1e-12"}},
    {"medium.periodic", {"0.0", "must be > 0"}},
    {"medium.fitted", {"1", "expected true or false"}},
    {"medium.field", {"\"exakt\"", "must be one of exact (did you mean \"exact\"?)"}},
    {"medium.table.tolerance", {"1e-15", "must be >= 1e-14 and <= 0.1"}},
    {"coupling.kappa", {"1e13", "within +-1e+12"}},
    {"coupling.gamma1", {"-1e13", "within +-1e+12"}},
    {"coupling.gamma2", {"1e300", "within +-1e+12"}},
    {"coupling.polar_basis", {"\"laplace\"", "must be one of laplacian, divergence"}},
    {"noise.rotational_diffusion", {"0.01", "must be 0: noise is not available in this version"}},
    {"rods[].position", {"[0.0, 1.0, 2.0]", "expected 2 numbers, found 3"}},
    {"rods[].heading", {"1e13", "within +-1e+12"}},
    {"rods_run.t_end", {"0.0", "must be > 0"}},
    {"rods_run.output_times", {"[-1.0, 1.0]", "must be >= 0"}},
    {"rods_run.output_interval", {"-0.5", "must be > 0"}},
    {"rods_run.contact_distance", {"0", "must be > 0"}},
    {"rods_run.method", {"\"rk4\"", "must be one of auto, bdf, adams, erk"}},
    {"rods_run.form", {"\"angel\"", "did you mean \"angle\"?"}},
    {"rods_run.rtol", {"1e-14", "must be >= 1e-13 and <= 0.1"}},
    {"rods_run.atol", {"1.5", "must be > 0 and <= 1"}},
    {"rods_run.max_steps", {"0", "must be >= 1"}},
    {"field.x", {"[1.0]", "expected 2 numbers, found 1"}},
    {"field.y", {"[-1e13, 0.0]", "within +-1e+12"}},
    {"field.nx", {"1", "must be >= 2 and <= 4000"}},
    {"field.ny", {"4001", "must be >= 2 and <= 4000"}},
    {"field.cuts[].along", {"\"z\"", "must be one of x, y"}},
    {"field.cuts[].at", {"1e13", "within +-1e+12"}},
    {"field.cuts[].from", {"-1e13", "within +-1e+12"}},
    {"field.cuts[].to", {"1e13", "within +-1e+12"}},
    {"field.cuts[].count", {"1", "must be >= 2"}},
    {"granular.bead_radius", {"0.0", "must be > 0 and <= 1"}},
    {"granular.phi_b", {"0.91", "must be > 0 and <= 0.9069: a layer of equal discs"}},
    {"granular.beads", {"-1", "must be >= 0 and <= 1e+07"}},
    {"granular.count_rod_area", {"1", "expected true or false"}},
    {"granular.bead_density", {"0.0", "must be > 0"}},
    {"granular.gravity", {"0.0", "must be > 0"}},
    {"granular.box", {"0.0", "must be > 0"}},
    {"granular.start", {"\"grid\"", "must be one of lattice, random, restart"}},
    {"granular.restart_from", {"\"a\\tb\"", "one line"}},
    {"granular.orientation", {"1e13", "within +-1e+12"}},
    {"granular.start_speed", {"-0.02", "must be >= 0 and <= 10"}},
    {"granular.time_step", {"1.1e-3", "must be > 0 and <= 0.001: above 1e-3 s"}},
    {"granular.equilibrate", {"-0.5", "must be >= 0"}},
    {"granular.duration", {"0", "must be > 0"}},
    {"granular.stop_at_travel", {"0.0", "must be > 0 and <= 1000"}},
    {"granular.seed", {"-1", "must be >= 0"}},
    {"granular.runs", {"0", "must be >= 1 and <= 1000000"}},
    {"granular.overlap_limit", {"1.5", "must be > 0 and <= 1"}},
    {"granular.order_cutoff", {"0.0", "must be > 0"}},
    {"granular.plates.gap", {"0.0", "must be > 0 and <= 1"}},
    {"granular.plates.frequency", {"0", "must be > 0"}},
    {"granular.plates.gamma", {"-7.0", "must be >= 0"}},
    {"granular.contacts.particle_particle.friction", {"-0.05", "must be >= 0 and <= 1000"}},
    {"granular.contacts.particle_particle.restitution", {"1.1", "must be >= 0 and <= 1"}},
    {"granular.contacts.rod_wall.friction", {"1001", "must be >= 0 and <= 1000"}},
    {"granular.contacts.rod_wall.restitution", {"-0.1", "must be >= 0 and <= 1"}},
    {"granular.contacts.bead_wall.friction", {"-1", "must be >= 0 and <= 1000"}},
    {"granular.contacts.bead_wall.restitution", {"2", "must be >= 0 and <= 1"}},
    {"granular.contacts.bead_bead.friction", {"-1", "must be >= 0 and <= 1000"}},
    {"granular.contacts.bead_bead.restitution", {"2", "must be >= 0 and <= 1"}},
    {"granular.contacts.bead_rod.friction", {"-1", "must be >= 0 and <= 1000"}},
    {"granular.contacts.bead_rod.restitution", {"2", "must be >= 0 and <= 1"}},
    {"granular.contacts.rod_rod.friction", {"-1", "must be >= 0 and <= 1000"}},
    {"granular.contacts.rod_rod.restitution", {"2", "must be >= 0 and <= 1"}},
    {"granular.output.frames", {"0.0", "must be > 0"}},
    {"granular.output.table", {"-1.0", "must be > 0"}},
    {"granular.output.formats", {"[\"vtk\"]", "must be one of h5md, xyz"}},
    {"granular.output.last_period", {"50", "expected true or false"}},
    {"granular.output.checkpoint", {"0.0", "must be > 0"}},
    {"granular.rods[].position", {"[0.0]", "expected 2 numbers, found 1"}},
    {"granular.rods[].heading", {"1e13", "within +-1e+12"}},
    {"granular.rods[].imposed_speed", {"-11.0", "within +-10"}},
    {"granular.rods[].kind", {"\"polar\"", "must be one of motile, apolar"}},
    {"granular.rods[].spheres", {"0", "must be >= 1 and <= 1000"}},
    {"granular.rods[].thick_diameter", {"0.0", "must be > 0"}},
    {"granular.rods[].thin_diameter", {"0.0", "must be > 0"}},
    {"granular.rods[].length", {"0.0", "must be > 0"}},
    {"granular.rods[].taper", {"\"stepped\"", "must be one of linear, stepwise"}},
    {"granular.rods[].segments", {"0", "must be >= 1"}},
    {"granular.rods[].density", {"0.0", "must be > 0"}},
    {"measure.order", {"1", "expected true or false"}},
    {"measure.microrheology", {"1", "expected true or false"}},
    {"measure.flow", {"1", "expected true or false"}},
    {"measure.displacement", {"\"phse\"", "did you mean \"phase\"?"}},
    {"measure.pairs", {"2", "expected true or false"}},
    {"measure.force", {"1.0", "expected true or false"}},
    {"measure.interval", {"0.0", "must be > 0"}},
    {"measure.from", {"-1.0", "must be >= 0"}},
    {"measure.block", {"0", "must be > 0"}},
    {"measure.trajectory", {"\"a\\tb\"", "one line"}},
    {"measure.rod", {"-1", "must be >= 0 and <= 999"}},
    {"measure.order_interval", {"0.0", "must be > 0"}},
    {"measure.order_neighbours", {"\"voronoi\"", "must be one of cutoff, delaunay"}},
    {"measure.order_cutoff", {"0.0", "must be > 0"}},
    {"measure.s_low", {"0.0", "must be > 0"}},
    {"measure.s_high", {"-1", "must be > 0"}},
    {"measure.flow_lag", {"0.0", "must be > 0"}},
    {"measure.flow_spacing", {"0.0", "must be > 0"}},
    {"measure.marked_within", {"0.0", "must be > 0"}},
    {"measure.marked_travel", {"0.0", "must be > 0"}},
    {"measure.spacing", {"0.0", "must be > 0"}},
    {"measure.reference", {"\"near\"", "must be one of box, far"}},
    {"measure.far_from", {"0.0", "must be > 0"}},
    {"measure.mirror", {"1", "expected true or false"}},
    {"measure.profile_offset", {"-1.0", "must be >= 0"}},
    {"measure.contact_distance", {"0.0", "must be > 0"}},
    {"fit.parameters", {"[\"f_over_my\"]", "did you mean \"f_over_mu\"?"}},
    {"fit.start", {"{ etta = 1.0 }", "unknown parameter \"etta\" (did you mean \"eta\"?)"}},
    {"fit.bounds", {"{ eta = [0.1, 1.0, 2.0] }", "expected 2 numbers, found 3"}},
    {"fit.fixed", {"{ f2d_over_mu = 1e13 }", "within +-1e+12"}},
    {"fit.tied", {"{ f2d_over_mu = [\"f_over_mu\"] }", "expected [name, factor]"}},
    {"fit.log", {"[\"eta\", \"eta\"]", "stands in the list already"}},
    {"fit.box", {"0.0", "must be > 0"}},
    {"fit.heading", {"1e13", "within +-1e+12"}},
    {"fit.core", {"-1.0", "must be >= 0"}},
    {"fit.independent_spacing", {"0.0", "must be > 0"}},
    {"fit.method", {"\"bobiqa\"", "did you mean \"bobyqa\"?"}},
    {"fit.loss", {"\"absolute\"", "must be one of squares, huber, cauchy"}},
    {"fit.loss_width", {"0.0", "must be > 0"}},
    {"fit.polish", {"1", "expected true or false"}},
    {"fit.starts", {"0", "must be >= 1"}},
    {"fit.spread", {"1.0", "must be > 1"}},
    {"fit.seed", {"-1", "must be >= 0"}},
    {"fit.tolerance", {"0.0", "must be > 0 and <= 0.1"}},
    {"fit.max_evaluations", {"0", "must be >= 1"}},
    {"fit.likelihood", {"[\"nu\"]", "must be one of f_over_mu"}},
    {"fit.length_unit", {"\"a\\tb\"", "one line"}},
    {"fit.profiles[].file", {"\"a\\tb\"", "one line"}},
    {"fit.profiles[].component", {"\"Uz\"", "must be one of Ux, Uy"}},
    {"fit.profiles[].along", {"\"z\"", "must be one of x, y"}},
    {"fit.profiles[].at", {"1e13", "within +-1e+12"}},
    {"fit.profiles[].range", {"[1.0]", "2 numbers"}},
    {"fit.profiles[].role", {"\"predicted\"", "must be one of fit, predict"}},
    {"fit.profiles[].name", {"\"a\\tb\"", "one line"}},
    {"fit.trajectories[].file", {"\"a\\tb\"", "one line"}},
    {"fit.trajectories[].sigma_position", {"0.0", "must be > 0"}},
    {"fit.trajectories[].sigma_heading", {"-1.0", "must be > 0"}},
    {"fit.trajectories[].free_headings", {"1", "expected true or false"}},
    {"fit.trajectories[].contact_distance", {"0.0", "must be > 0"}},
    {"fit.trajectories[].contact_time", {"0.0", "must be > 0"}},
    {"fit.trajectories[].sigma_contact", {"0.0", "must be > 0"}},
    {"fit.trajectories[].f_over_mu", {"0.0", "must be > 0"}},
    {"fit.trajectories[].speed", {"0.0", "must be > 0"}},
    {"fit.trajectories[].name", {"\"a\\tb\"", "one line"}},
    {"fit.compare[].name", {"\"a\\tb\"", "one line"}},
    {"fit.compare[].values", {"{ xj = 1.0 }", "unknown parameter \"xj\""}},
    {"figures[].name", {"\"../etc/passwd\"", "file name"}},
    {"figures[].kind", {"\"plot\"", "must be one of extensional_axis"}},
    {"figures[].title", {"\"a\\tb\"", "one line"}},
    {"figures[].cut", {"-1", "must be >= 0"}},
    {"figures[].component", {"\"Uz\"", "must be one of Ux, Uy"}},
    {"figures[].sqrt_scaled", {"1", "expected true or false"}},
    {"figures[].along", {"\"z\"", "must be one of x, y"}},
    {"figures[].quantity", {"\"psi\"", "must be one of psi6, stiffness"}},
    {"figures[].against", {"\"phi\"", "must be one of phi_b, d0, imposed_speed"}},
    {"figures[].gammas", {"[]", "expected 1 to 16 pairs"}},
    {"figures[].frame", {"-2", "must be >= -1"}},
    {"figures[].colour", {"\"red\"", "must be one of order, orientation"}},
    {"figures[].fps", {"0", "must be >= 1 and <= 120"}},
    {"figures[].profiles", {"[-1]", "must be >= 0 and <= 99"}},
    {"figures[].residuals", {"1", "expected true or false"}},
    {"figures[].parameter", {"\"etta\"", "did you mean \"eta\"?"}},
    {"figures[].x", {"[1.0]", "expected 2 numbers"}},
    {"figures[].y", {"[0.0, 1e13]", "within +-1e+12"}},
    {"variants[].name", {"\"\"", "file name"}},
    {"variants[].label", {"\"a\\u0007\"", "one line"}},
    {"variants[].set", {"{}", "expected 1 to 100 keys, found 0"}},
};

bool takes_tables(const KeyInfo& info) { return info.type.starts_with("table of"); }

bool takes_units(const KeyInfo& info) { return !info.unit.empty(); }

} // namespace

TEST_CASE("every key refuses a value of the wrong type") {
    for (const auto& info : rodwake::scene::scene_keys()) {
        INFO(full_name(info));
        CHECK(mentions(problems_of(complete, {override_path(info) + "=1979-05-27"}), message_path(info),
                       "expected"));
        CHECK(mentions(problems_of(complete, {override_path(info) + "={ a = 1 }"}), message_path(info),
                       "found a table") != takes_tables(info));
    }
}

TEST_CASE("every key refuses a value out of its range") {
    for (const auto& info : rodwake::scene::scene_keys()) {
        INFO(full_name(info));
        const auto it = illegal_values.find(full_name(info));
        REQUIRE(it != illegal_values.end()); // a new key needs an illegal value in the table above
        const auto problems = problems_of(complete, {override_path(info) + "=" + it->second.value});
        const auto about_key = [&](const Problem& p) {
            return p.key.starts_with(message_path(info)) &&
                   p.message.find(it->second.part) != std::string::npos;
        };
        CAPTURE(problems.empty() ? "no problem" : problems.front().text());
        CHECK(std::any_of(problems.begin(), problems.end(), about_key));
    }
    CHECK(illegal_values.size() == rodwake::scene::scene_keys().size());
}

TEST_CASE("every misspelt key is refused with the right one named") {
    for (const auto& info : rodwake::scene::scene_keys()) {
        INFO(full_name(info));
        KeyInfo misspelt = info;
        misspelt.name = info.name.size() > 2 ? info.name + "q" : info.name + "_";
        const auto problems = problems_of(complete, {override_path(misspelt) + "=1"});
        CHECK(mentions(problems, message_path(misspelt), "unknown"));
        CHECK(mentions(problems, message_path(misspelt), "Known keys: "));
        CHECK(mentions(problems, message_path(misspelt), "did you mean \"" + info.name + "\"?"));
    }
}

TEST_CASE("every number refuses nan and inf") {
    for (const auto& info : rodwake::scene::scene_keys())
        for (const std::string value : {"nan", "-inf", "inf"}) {
            INFO(full_name(info));
            const bool list = info.type.find("numbers") != std::string::npos;
            const bool pairs = info.type.find("pairs") != std::string::npos;
            const std::string wrapped = pairs  ? "[[" + value + ", 0.0]]"
                                        : list ? "[" + value + ", 1.0]"
                                               : value;
            CHECK_FALSE(problems_of(complete, {override_path(info) + "=" + wrapped}).empty());
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
        const auto text = error_text(complete, {override_path(info) + "=" + value});
        CHECK(text.find("found \"" + wrong + "\" (string)") != std::string::npos);
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
        if (info.table == "fit")
            overrides.insert(overrides.begin(), {"fit.trajectories=[]", "fit.fixed={}"});
        if (info.name == "profiles" || info.name == "residuals")
            overrides.push_back("figures.0.kind=fit");
        if (info.name == "parameter")
            overrides.push_back("figures.0.kind=fit_likelihood");
        const bool fitted = full_name(info) == "medium.fitted"; // which gives eta and xi
        CHECK(error_text(fitted ? replaced(complete, "eta = 1.0\nalpha = 0.5\n", "") : complete, overrides) ==
              "");
    }
}

TEST_CASE("every table of later versions is refused as such") {
    CHECK(error_text(complete + "[scan]\nx = 1\n").find("[scan] is not available in this version") !=
          std::string::npos);
    for (const std::string form : {"director", "dae"})
        CHECK(error_text(complete, {"rods_run.form=" + form}) ==
              "-s rods_run.form=" + form + ": rods_run.form = \"" + form +
                  "\" is not available in this version; available: angle");
    for (const std::string field : {"table", "measured", "dynamic"})
        CHECK(error_text(complete, {"medium.field=" + field})
                  .find("is not available in this version; available: exact") != std::string::npos);
}
