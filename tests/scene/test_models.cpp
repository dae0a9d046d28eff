// [[fit.models]]: what a rival of a fit is, and which are refused.

#include "rodwake/scene/read.hpp"
#include "support.hpp"

#include <catch2/catch.hpp>

using namespace scene_test;
using rodwake::scene::apply_model;
using rodwake::scene::Fit;

namespace {

const std::string pair = "[[fit.trajectories]]\nfile = \"rods.csv\"\n";

std::string with_models(const std::string& models, const std::string& keys = "",
                        const std::string& data = pair) {
    return "schema = 1\n[fit]\nname = \"strain\"\nparameters = [\"kappa\"]\nstart = { kappa = 2.0 }\nfixed = "
           "{ eta = "
           "1.3, alpha = 0.5 }\nlikelihood = [\"kappa\"]\n" +
           keys + data + models;
}

std::string model(const std::string& name, const std::string& set) {
    return "[[fit.models]]\nname = \"" + name + "\"\nset = { " + set + " }\n";
}

Fit rival(const std::string& set, const std::string& keys = "") {
    const Scene scene = parse(with_models(model("rival", set), keys));
    return *apply_model(scene, scene.fit->models[0]).fit;
}

void says(const std::string& text, const std::string& part) {
    const std::string message = error_text(text);
    INFO(message);
    CHECK(message.find(part) != std::string::npos);
}

} // namespace

TEST_CASE("a rival is the fit with its keys changed, and without what it does not use") {
    const Fit flow = rival("\"fit.parameters\" = [\"gamma_flow\"], \"fit.start.gamma_flow\" = 0.5");
    CHECK(flow.parameters == std::vector<std::string>{"gamma_flow"});
    CHECK(flow.start == std::map<std::string, double>{{"gamma_flow", 0.5}});
    CHECK(flow.likelihood.empty());
    CHECK(flow.fixed.at("alpha") == 0.5);
    CHECK(flow.models.empty());
    CHECK(flow.name == "rival");
    const Fit none = rival("\"fit.parameters\" = []");
    CHECK(none.parameters.empty());
    const Scene scene = parse(with_models(model("rival", "\"fit.parameters\" = [\"gamma1\", \"gamma2\"]")));
    CHECK(parse(rodwake::scene::to_toml(scene)) == scene);
}

TEST_CASE("keys of medium and couplings hold what the rival's fit does not name") {
    const Fit stiff = rival("\"coupling.gamma1\" = 2, \"medium.eta\" = 4.0", "");
    CHECK(stiff.fixed.at("gamma1") == 2.0);
    CHECK(stiff.fixed.at("eta") == 1.3); // which the fit has
    const std::string data = "[[fit.profiles]]\nfile = \"ux.csv\"\n";
    const std::string text =
        "schema = 1\n[fit]\nparameters = [\"f_over_mu\", \"eta\", \"xi\"]\n" + data +
        model("no_drag", "\"fit.parameters\" = [\"f_over_mu\", \"eta\"], \"medium.xi\" = 1e6");
    const Scene scene = parse(text);
    CHECK(apply_model(scene, scene.fit->models[0]).fit->fixed.at("alpha") == Approx(1e-6));
}

TEST_CASE("rivals that are no rivals are refused") {
    const std::string flow = "\"fit.parameters\" = [\"gamma_flow\"]";
    says(with_models(model("a", flow) + model("b", flow)), "gives the same model as fit.models[0]");
    says(with_models(model("a", "\"fit.parameters\" = [\"kappa\"]")),
         "gives the same model as the fit as written");
    says(with_models(model("a", flow) + model("a", "\"fit.parameters\" = [\"gamma1\"]")),
         "the name \"a\" is taken");
    says(with_models(model("strain", flow)), "is already taken by the fit itself");
    says(with_models(model("a", "\"fit.parametres\" = [\"kappa\"]")), "with fit.models[0] applied");
    says(with_models(model("a", "\"fit.parameters\" = [\"gamma3\"]")), "gamma3");
    says(with_models(model("a", "\"fit.start.gamma1\" = 1.0")), "fit.start has gamma1");
    says(with_models(model("a", flow + ", \"fit.trajectories.0.file\" = \"other.csv\"")),
         "changes the data (fit.trajectories)");
    says(with_models(model("a", "\"fit.parameters\" = [\"rows_direction\"]")), "nothing turns the rods");
    says(with_models("[[fit.models]]\nname = \"a\"\n"), "set");
}

TEST_CASE("gamma_flow and the rows say what they cannot have") {
    const std::string coupled = "contact_distance = 0.5\n[medium]\neta = 1\nalpha = 0.5\n[coupling]\n";
    const Scene scene =
        parse(two_rods(coupled + "gamma_flow = 2.0\ngamma_rows = 0.1\nrows_direction = \"30 deg\"\n"));
    CHECK(scene.coupling->gamma_flow == 2.0);
    CHECK(scene.coupling->rows.gamma == 0.1);
    CHECK(scene.coupling->rows.direction == Approx(0.5235987755982988));
    CHECK(parse(rodwake::scene::to_toml(scene)) == scene);
    const std::string dynamic =
        "contact_distance = 0.5\n[medium]\neta = 1\nalpha = 0.5\nfield = \"dynamic\"\n"
        "[medium.dynamic]\nbox = 40.0\nforce_width = 0.5\n";
    says(two_rods(dynamic + "[coupling]\ngamma_rows = 0.1\n"), "coupling.gamma_rows is not integrated");
    says(two_rods(dynamic + "inertia = 0.1\n[coupling]\ngamma_flow = 0.1\n"),
         "needs medium.dynamic.inertia = 0");
}
