// Maps in an isotropic medium, by the parameters of the theory.

#include "made_up_map.hpp"
#include "rodwake/core/error.hpp"

#include <catch2/catch.hpp>

using namespace made_up_map;

namespace {

/// A bed at rest with a rod's moments (studies/reports/bed.md); f/(zeta v) in place of the screening length.
std::vector<Parameter> bed(const std::vector<std::string>& free, const std::string& drag = "drag_area",
                           double strength = 860.0) {
    std::vector<Parameter> out = {{.name = "f_over_mu", .start = 1.48}, {.name = "eta", .start = 2.0},
                                  {.name = drag, .start = strength},    {.name = "p_xx", .start = 55.0},
                                  {.name = "p_yy", .start = 80.0},      {.name = "q_xxx", .start = -300.0},
                                  {.name = "q_xyy", .start = -230.0},   {.name = "t_xxxx", .start = -500.0},
                                  {.name = "t_xxyy", .start = -500.0},  {.name = "h_xxxxx", .start = -5e3},
                                  {.name = "h_xxxyy", .start = -4e3},   {.name = "offset", .start = 0.01}};
    for (Parameter& p : out)
        p.fixed = std::ranges::find(free, p.name) == free.end();
    return out;
}

Map map_of_bed(double sigma, const std::vector<Parameter>& truth) {
    Map map = map_of(36, sigma);
    auto u = predict(model, map, truth, starts(truth));
    map.Ux = std::move(u.Ux);
    map.Uy = std::move(u.Uy);
    return map;
}

const std::vector<std::string> fitted = {"f_over_mu", "eta",    "p_xx",    "p_yy",    "q_xxx", "q_xyy",
                                         "t_xxxx",    "t_xxyy", "h_xxxxx", "h_xxxyy", "offset"};
const MapMask beyond{.strip = 8.0, .radius = 15.0};

} // namespace

TEST_CASE("an isotropic map is the orthotropic one in units of the shear modulus") {
    const double v = 1.7, mu = 3.0, f = 1.48, xi = 860.0 / f;
    const auto parameters = bed({});
    const Map map = map_of_bed(0.01, parameters);
    std::vector<Parameter> same = {
        {.name = "force", .start = f * mu}, {.name = "c11", .start = 3.0 * mu},
        {.name = "c22", .start = 3.0 * mu}, {.name = "c12", .start = mu},
        {.name = "c66", .start = mu},       {.name = "zeta", .start = mu / (xi * v)}};
    for (Parameter p : parameters)
        if (p.name != "f_over_mu" && p.name != "eta" && p.name != "drag_area") {
            p.start *= p.name == "offset" ? 1.0 : mu;
            same.push_back(p);
        }
    const auto u = predict(model, map, same, starts(same));
    for (std::size_t i = 0; i < map.bins(); ++i) {
        CHECK(u.Ux[i] == Approx(map.Ux[i]).margin(1e-13));
        CHECK(u.Uy[i] == Approx(map.Uy[i]).margin(1e-13));
    }
    for (const auto& [name, value] : {std::pair{"xi", xi}, {"alpha", f / xi}}) {
        const auto other = bed({}, name, value);
        CHECK(predict(model, map, other, starts(other)).Ux[5] == Approx(map.Ux[5]).margin(1e-13));
    }
}

TEST_CASE("derivatives of an isotropic map are those of differences, on the grid and along a line") {
    for (const auto& [drag, strength] : {std::pair{"drag_area", 40.0}, {"xi", 30.0}, {"alpha", 0.05}}) {
        auto all = fitted;
        all.emplace_back(drag);
        const auto parameters = bed(all, drag, strength); // a short screening length, so that it counts
        const Map map = map_of(8, 0.01);
        const Problem problem = map_problem(model, {map}, {}, parameters);
        const Profile line{.component = Component::Uy, .along = Axis::x, .at = 4.0};
        const auto rows = static_cast<Eigen::Index>(problem.residuals);
        Eigen::VectorXd r(rows), up(rows), down(rows);
        Eigen::MatrixXd slopes = Eigen::MatrixXd::Zero(rows, static_cast<Eigen::Index>(parameters.size()));
        problem.evaluate(starts(parameters), r, &slopes);
        const auto of_line = [&](const std::vector<double>& p) {
            return predict_line(model, map, line, map.x, parameters, p);
        };
        const Prediction along = of_line(starts(parameters));
        for (std::size_t k = 0; k < parameters.size(); ++k) {
            CAPTURE(parameters[k].name, drag);
            std::vector<double> p = starts(parameters);
            const double h = 1e-4 * std::abs(p[k]);
            p[k] += h;
            problem.evaluate(p, up, nullptr);
            const auto above = of_line(p).value;
            p[k] -= 2.0 * h;
            problem.evaluate(p, down, nullptr);
            const auto below = of_line(p).value;
            const auto column = static_cast<Eigen::Index>(k);
            // h^2 of the third derivative, and rounding
            CHECK((((up - down) / (2.0 * h)) - slopes.col(column)).norm() < 1e-6 * slopes.col(column).norm());
            for (std::size_t i = 0; i < above.size(); ++i)
                CHECK((above[i] - below[i]) / (2.0 * h) ==
                      Approx(along.by_parameter(static_cast<Eigen::Index>(i), column))
                          .margin(1e-6 * along.by_parameter.col(column).cwiseAbs().maxCoeff()));
        }
    }
}

TEST_CASE(
    "force and eta of a made-up bed come back within their errors, and eta needs more than second moments") {
    rodwake::RandomStream random(11, 4);
    std::vector<Map> runs; // of a noise like that of the quick start's six runs
    for (int run = 0; run < 6; ++run)
        runs.push_back(with_noise(map_of_bed(0.01, bed({})), random));
    const auto found = [&](const std::vector<std::string>& free) {
        auto parameters = bed(free);
        for (Parameter& p : parameters)
            if (!p.fixed)
                p.start = p.name == "f_over_mu" || p.name == "eta" ? 1.0 : 0.0;
            else if (p.name != "drag_area")
                p.start = 0.0;
        const Problem problem = map_problem(model, runs, beyond, parameters);
        return report(problem, fit(problem, {}));
    };
    const Report whole = found(fitted);
    for (const auto& [index, truth] : {std::pair{std::size_t{0}, 1.48}, {std::size_t{1}, 2.0}}) {
        const ParameterEstimate& e = whole.estimates[index];
        CAPTURE(e.name, e.value, e.standard_error);
        CHECK(std::abs(e.value - truth) < 4.0 * e.standard_error); // by chance once in 16 000
        CHECK(e.standard_error < 0.1 * truth);
    }
    const Report seconds = found({"f_over_mu", "eta", "p_xx", "p_yy", "q_xxx", "q_xyy", "offset"});
    CHECK(std::abs(seconds.estimates[1].value - 2.0) > 4.0 * seconds.estimates[1].standard_error);
}

TEST_CASE("an isotropic map has no second set of constants") {
    auto parameters = bed(fitted);
    parameters.push_back({.name = "c66", .start = 1.0});
    CHECK_THROWS_AS(map_problem(model, {map_of(8, 0.01)}, {}, parameters), rodwake::InputError);
    parameters.back().name = "xi";
    CHECK_THROWS_AS(map_problem(model, {map_of(8, 0.01)}, {}, parameters), rodwake::InputError);
}
