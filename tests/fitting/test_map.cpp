// Fits of maps: truth comes back, derivatives are right, masks and errors in the data are told.

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
Map map_with_moments(std::size_t n, double sigma) {
    Map map = map_of(n, sigma);
    auto u = predict(model, map, with_moments({}), starts(with_moments({})));
    map.Ux = std::move(u.Ux);
    map.Uy = std::move(u.Uy);
    return map;
}

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
        const auto rows = static_cast<Eigen::Index>(problem.residuals);
        Eigen::VectorXd r(rows), up(rows), down(rows);
        Eigen::MatrixXd slopes = Eigen::MatrixXd::Zero(rows, static_cast<Eigen::Index>(truth.size()));
        problem.evaluate(true_values(), r, &slopes);
        for (const std::string& name : free) {
            CAPTURE(name);
            std::vector<double> p = true_values();
            const std::size_t k = index_of(name);
            const double h = 1e-4 * std::abs(p[k]);
            p[k] += h;
            problem.evaluate(p, up, nullptr);
            p[k] -= 2.0 * h;
            problem.evaluate(p, down, nullptr);
            const auto slope = slopes.col(static_cast<Eigen::Index>(k));
            // h^2 of the third derivative, and rounding
            CHECK((((up - down) / (2.0 * h)) - slope).norm() < 1e-6 * slope.norm());
        }
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
