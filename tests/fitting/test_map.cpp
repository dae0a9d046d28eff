// Fits of maps: truth comes back, derivatives are right, masks and errors in the data are reported.

#include "made_up_map.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/fitting/refits.hpp"

#include <catch2/catch.hpp>

using namespace made_up_map;

namespace {

const std::vector<std::string> all_but_scale = {"amplitude", "p_xx", "p_yy",  "c11",    "c22",     "c12",
                                                "zeta",      "rho",  "eta_s", "offset", "offset_y"};

/// A ridge along the rod's row, of which the theory knows nothing.
Map with_ridge(Map map, double half_width) {
    for (std::size_t i = 0; i < map.bins(); ++i)
        if (std::abs(map.place_y(i)) < half_width)
            map.Ux[i] += 0.3;
    return map;
}

double fitted(const Map& map, const MapMask& mask, const std::string& name,
              const std::vector<Parameter>& parameters) {
    return fit(map_problem(model, {map}, mask, parameters), {}).values[index_of(name)];
}

/// The truth with second moments, without viscosity; those named are free.
std::vector<Parameter> with_moments(const std::vector<std::string>& free, double q_yxy = 50.0) {
    std::vector<Parameter> out = truth;
    out[index_of("eta_s")].start = 0.0;
    for (const auto& [name, value] : {std::pair{"q_xxx", 120.0}, {"q_xyy", -70.0}, {"q_yxy", q_yxy}})
        out.push_back({.name = name, .start = value});
    for (Parameter& p : out)
        p.fixed = std::ranges::find(free, p.name) == free.end();
    return out;
}

/// Bins of a map whose source has the moments of `with_moments`.
Map map_with_moments(std::size_t n, double sigma) { return made_by(map_of(n, sigma), with_moments({})); }

const std::vector<std::string> linear = {"amplitude", "p_xx", "p_yy", "q_xxx", "q_xyy", "offset"};
const MapMask beyond{.strip = 8.0, .radius = 15.0}; // five widths of the source

ParameterEstimate estimate_of(const Report& r, const std::string& name) {
    return *std::ranges::find(r.estimates, name, &ParameterEstimate::name);
}

} // namespace

TEST_CASE("a map without noise gives back every parameter that it can") {
    auto parameters = free_ones(all_but_scale); // c66 fixes the unit of force
    for (Parameter& p : parameters)
        if (!p.fixed)
            p.start *= p.name == "offset_y" ? 3.0 : 1.25;
    const Problem problem =
        map_problem(model, {map_of(20, 0.01)}, {.strip = 8.0, .radius = 10.0}, parameters);
    const Fit best = fit(problem, {});
    for (std::size_t k = 0; k < truth.size(); ++k) {
        CAPTURE(truth[k].name);
        CHECK(best.values[k] == Approx(truth[k].start).epsilon(1e-5));
    }
}

TEST_CASE("second moments come back within their errors, and chi2 needs them") {
    rodwake::RandomStream random(7, 3);
    const Map map = with_noise(map_with_moments(24, 0.01), random);
    const auto parameters = with_moments(linear);
    const Problem problem = map_problem(model, {map}, beyond, parameters);
    const Report r = report(problem, fit(problem, {}));
    for (const std::string name : {"amplitude", "p_xx", "p_yy", "q_xxx", "q_xyy"}) {
        const ParameterEstimate e = estimate_of(r, name);
        const double true_value = std::ranges::find(parameters, name, &Parameter::name)->start;
        CAPTURE(name, e.value, e.standard_error);
        CHECK(std::abs(e.value - true_value) < 4.0 * e.standard_error); // by chance once in 16 000
    }
    CHECK(estimate_of(r, "q_xxx").value > 4.0 * estimate_of(r, "q_xxx").standard_error);
    CHECK(estimate_of(r, "q_xyy").value < -4.0 * estimate_of(r, "q_xyy").standard_error);
    CHECK(std::abs(r.chi2 - double(r.dof)) < 4.0 * std::sqrt(2.0 * double(r.dof)));
    const Problem dipoles =
        map_problem(model, {map}, beyond, free_ones({"amplitude", "p_xx", "p_yy", "offset"}));
    CHECK(report(dipoles, fit(dipoles, {})).chi2 > 1.2 * r.chi2);
}

TEST_CASE("outside the rod a moment held at another value moves the others as the formula says, no more") {
    // elastic/anisotropic.hpp: s times the hidden source has q_yxy = -s (c12 + c66)/2; w is a fifth of the
    // mask's radius, so the Gaussian is exp(-12.5) of its height.
    const auto parameters = with_moments(linear, 0.0);
    const Problem problem = map_problem(model, {map_with_moments(24, 0.01)}, beyond, parameters);
    const Fit best = fit(problem, {});
    const auto found = [&](const std::string& name) {
        return best.values[static_cast<std::size_t>(std::ranges::find(parameters, name, &Parameter::name) -
                                                    parameters.begin())];
    };
    const double s = 2.0 * 50.0 / (1.3 + 1.0), v = 1.7;
    CHECK(found("amplitude") == Approx(0.8).epsilon(1e-3));
    CHECK(found("q_xxx") == Approx(120.0 + s * (0.03 * v * v - 3.1)).epsilon(2e-3));
    CHECK(found("q_xyy") == Approx(-70.0 - s).epsilon(2e-3));
    CHECK(found("p_xx") == Approx(-3.0 + s * 0.05 * v).epsilon(2e-2));
    CHECK(report(problem, best).chi2 < 1.0);
    // All three free: the report says that the data do not fix them.
    auto all = linear;
    all.insert(all.end(), {"q_yxy"});
    const Problem free = map_problem(model, {map_with_moments(24, 0.01)}, beyond, with_moments(all));
    const Report r = report(free, fit(free, {}));
    CAPTURE(estimate_of(r, "q_yxy").standard_error, estimate_of(r, "q_xxx").standard_error);
    CHECK(estimate_of(r, "q_yxy").standard_error > 1e3);
}

TEST_CASE("moments of 0 change no bit of a map") {
    auto parameters = truth;
    for (const char* name : {"q_xxx", "q_xyy", "q_yxy"})
        parameters.push_back({.name = name, .start = 0.0});
    const Map map = map_of(12, 0.01);
    const auto u = predict(model, map, parameters, starts(parameters));
    CHECK(u.Ux == map.Ux);
    CHECK(u.Uy == map.Uy);
}

TEST_CASE("derivatives of the residuals of a map are those of differences") {
    std::vector<std::string> names;
    for (const Parameter& p : truth)
        names.push_back(p.name);
    // the second problem has its medium worked out beforehand
    for (const auto& free :
         {names, std::vector<std::string>{"amplitude", "force", "p_xx", "p_yy", "offset"}}) {
        const Problem problem = map_problem(model, {map_of(8, 0.01)}, {}, free_ones(free));
        CHECK(toy::jacobian_error(problem, true_values()) < 1e-6);
    }
}

TEST_CASE("a mask keeps the bins it says") {
    const MapMask mask{.strip = 8.0, .radius = 20.0, .from = 0.0, .to = 1.6};
    CHECK(mask.keeps(25.0, 8.0));
    CHECK(mask.keeps(25.0, -8.0));
    CHECK_FALSE(mask.keeps(25.0, 7.9));
    CHECK_FALSE(mask.keeps(10.0, 12.0));
    CHECK_FALSE(mask.keeps(-25.0, 9.0));
    Map map = map_of(12, 0.01);
    const std::size_t all = used_bins(map, {}).size();
    CHECK(all == 144);
    map.known[0] = false;
    CHECK(used_bins(map, {}).size() == 143);
}

TEST_CASE("what is wrong inside the mask does not touch the fit, without it the amplitude is off") {
    const auto parameters = free_ones({"amplitude", "p_xx", "p_yy", "offset", "offset_y"});
    const Map map = with_ridge(map_of(24, 0.01), 7.0);
    CHECK(fitted(map, {.strip = 8.0}, "amplitude", parameters) == Approx(0.8).epsilon(1e-8));
    const Problem whole = map_problem(model, {map}, {}, parameters);
    const Report r = report(whole, fit(whole, {}));
    CHECK(std::abs(r.estimates[0].value - 0.8) > 2.0 * r.estimates[0].standard_error);
    CHECK(r.probability < 1e-6); // and the report says that it does not fit
}

TEST_CASE("a wrong constant shifts the amplitude by what its error is said to add") {
    const auto parameters = free_ones({"amplitude", "p_yy"});
    const Map map = map_of(16, 0.01);
    const MapMask mask{.strip = 8.0};
    const auto remake = [&](const std::vector<Parameter>& p) { return map_problem(model, {map}, mask, p); };
    const Fit best = fit(remake(parameters), {});
    const double error = 0.1;
    const auto change = change_with(remake, parameters, {}, best.values, {index_of("c66"), error});
    auto off = parameters;
    off[index_of("c66")].start += error;
    const double shift = fitted(map, mask, "amplitude", off) - 0.8;
    CHECK(std::abs(shift) > 0.01);
    CHECK(change[0] == Approx(shift).epsilon(0.05)); // the second order in error/c66, a tenth
    CHECK_THROWS_AS(change_with(remake, parameters, {}, best.values, {0, 0.1}), rodwake::InputError);
    // a medium that does not exist within the error
    CHECK_THROWS_AS(change_with(remake, parameters, {}, best.values, {index_of("c66"), 1.1}),
                    rodwake::InputError);
}

TEST_CASE("maps that cannot be fitted are refused") {
    const Map map = map_of(8, 0.01);
    const auto refused = [&](const Map& m, const std::vector<Parameter>& p, const MapMask& mask = {}) {
        CHECK_THROWS_AS(map_problem(model, {m}, mask, p), rodwake::InputError);
    };
    auto parameters = free_ones({"amplitude"});
    refused(map, {parameters.begin(), parameters.begin() + 4}); // no constants
    refused(map, {parameters.begin() + 4, parameters.end()});   // no source
    refused(map, parameters, {.strip = 40.0});                  // nothing left
    Map bad = map;
    bad.sigma_y[5] = 0.0;
    refused(bad, parameters);
    bad = map;
    bad.Ux[3] = std::nan("");
    refused(bad, parameters);
    bad = map;
    bad.Ux.pop_back();
    refused(bad, parameters);
    Map without = map;
    without.sigma_x.clear();
    without.sigma_y.clear();
    CHECK_THROWS_AS(map_problem(model, {map, without}, {}, parameters), rodwake::InputError);
    CHECK_FALSE(map_problem(model, {without}, {}, parameters).sigma_known);
    parameters[index_of("c66")].start = -1.0;
    refused(map, parameters);
}

TEST_CASE("spread and jackknife are those of their formulas") {
    CHECK(spread({{1.0}, {2.0}, {4.5}})[0] == Approx(1.80277563773)); // sqrt(13/4)
    // of a mean the jackknife is s/sqrt(n): {1, 2, 6} has s^2 = 7, means without one are 4, 3.5, 1.5
    CHECK(jackknife_error({{{4.0}, {3.5}, {1.5}}})[0] == Approx(std::sqrt(7.0 / 3.0)));
    CHECK(jackknife_error({{{4.0}, {3.5}, {1.5}}, {{1.0}, {3.0}}})[0] == Approx(std::sqrt(7.0 / 3.0 + 1.0)));
    CHECK_THROWS_AS(jackknife_error({{{1.0}}}), rodwake::InputError);
    CHECK_THROWS_AS(spread({{1.0}}), rodwake::InputError);
}

// --- Maps in an isotropic medium, by the parameters of the theory

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
    return made_by(map_of(36, sigma), truth);
}

const std::vector<std::string> all_terms = {"f_over_mu", "eta",    "p_xx",    "p_yy",    "q_xxx", "q_xyy",
                                            "t_xxxx",    "t_xxyy", "h_xxxxx", "h_xxxyy", "offset"};

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
        auto all = all_terms;
        all.emplace_back(drag);
        const auto parameters = bed(all, drag, strength); // a short screening length, so that it counts
        const Map map = map_of(8, 0.01);
        const Problem problem = map_problem(model, {map}, {}, parameters);
        const Profile line{.component = Component::Uy, .along = Axis::x, .at = 4.0};
        CHECK(toy::jacobian_error(problem, starts(parameters)) < 1e-6);
        const auto of_line = [&](const std::vector<double>& p) {
            return predict_line(model, map, line, map.x, parameters, p);
        };
        const Prediction along = of_line(starts(parameters));
        for (std::size_t k = 0; k < parameters.size(); ++k) {
            CAPTURE(parameters[k].name, drag);
            std::vector<double> p = starts(parameters);
            const double h = 1e-4 * std::abs(p[k]);
            p[k] += h;
            const auto above = of_line(p).value;
            p[k] -= 2.0 * h;
            const auto below = of_line(p).value;
            const auto column = static_cast<Eigen::Index>(k);
            // h^2 of the third derivative, and rounding
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
    const Report whole = found(all_terms);
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
    auto parameters = bed(all_terms);
    parameters.push_back({.name = "c66", .start = 1.0});
    CHECK_THROWS_AS(map_problem(model, {map_of(8, 0.01)}, {}, parameters), rodwake::InputError);
    parameters.back().name = "xi";
    CHECK_THROWS_AS(map_problem(model, {map_of(8, 0.01)}, {}, parameters), rodwake::InputError);
}
