// Residuals of profiles against the rod's field: values, derivatives, what is refused.

#include "catch2/catch.hpp"
#include "rodwake/core/box_sides.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/elastic/field.hpp"
#include "rodwake/fitting/wake.hpp"
#include "synthetic_profiles.hpp"
#include "toy_problems.hpp"

#include <set>

using namespace rodwake::fitting;
using namespace fitting_test;
using Catch::Matchers::Contains;
using toy::jacobian_error;

namespace {

const std::vector<std::string> monopole = {"f_over_mu", "eta", "xi"};

std::vector<Parameter> parameters(const std::vector<std::string>& names, const std::vector<double>& values) {
    std::vector<Parameter> list;
    for (std::size_t i = 0; i < names.size(); ++i)
        list.push_back({.name = names[i], .start = values[i]});
    return list;
}

Profile line(Component component, Axis along, double at) {
    return {.name = "line", .component = component, .along = along, .at = at};
}

/// Exact data on the four lines of the paper's Fig. ufield2.
Problem four_lines(const WakeModel& model, const std::vector<std::string>& names,
                   const std::vector<double>& truth) {
    const auto list = parameters(names, truth);
    std::vector<Profile> data;
    for (const Profile& one : {line(Component::Ux, Axis::x, 0.0), line(Component::Ux, Axis::y, 0.0),
                               line(Component::Uy, Axis::x, 4.0), line(Component::Uy, Axis::y, 0.0)})
        data.push_back(made_up(model, list, truth, one, 20, 30.0, 0.01));
    return wake_problem(model, data, list);
}

} // namespace

TEST_CASE("the names of the wake's parameters are different") {
    const auto names = wake_parameter_names();
    CHECK(std::set<std::string>(names.begin(), names.end()).size() == names.size());
}

TEST_CASE("the model is the exact field times its strengths plus the offset") {
    const std::vector<std::string> names = {"offset_y", "xi",        "f2d_over_mu", "eta",
                                            "offset",   "f_over_mu", "x0"};
    const std::vector<double> values = {0.3, 12.0, 0.7, 1.3, -0.2, 2.2, 1.5};
    const std::vector<double> places = {-7.0, 0.5, 9.0};
    const auto list = parameters(names, values);
    const rodwake::elastic::Field field({1.3, 12.0});
    const auto ux = predict({}, line(Component::Ux, Axis::x, 4.0), places, list, values).value;
    const auto uy = predict({}, line(Component::Uy, Axis::y, -3.0), places, list, values).value;
    for (std::size_t i = 0; i < places.size(); ++i) {
        const auto a = field.at(places[i] - 1.5, 4.0, {.displacement = true, .dipole = true});
        CHECK(ux[i] == Approx(2.2 * a.displacement.x + 0.7 * a.dipole.x - 0.2).epsilon(1e-14));
        const auto b = field.at(-3.0 - 1.5, places[i], {.displacement = true, .dipole = true});
        CHECK(uy[i] == Approx(2.2 * b.displacement.y + 0.7 * b.dipole.y + 0.3).epsilon(1e-14));
    }
}

TEST_CASE("one strength alone is its own term and nothing else, in value and derivatives") {
    const rodwake::elastic::Field field({1.3, 12.0});
    const auto f = field.at(-5.0, 4.0, {.displacement = true, .dipole = true});
    const std::vector<double> values = {0.7, 1.3, 12.0};
    for (const bool dipole : {false, true}) {
        const auto list = parameters({dipole ? "f2d_over_mu" : "f_over_mu", "eta", "xi"}, values);
        const auto found = predict({}, line(Component::Ux, Axis::x, 4.0), std::vector{-5.0}, list, values);
        CHECK(found.value[0] == Approx(0.7 * (dipole ? f.dipole.x : f.displacement.x)).epsilon(1e-14));
        CHECK(found.by_parameter.allFinite());
    }
}

TEST_CASE("alpha stands for f_over_mu/xi") {
    const std::vector<double> places = {-5.0, 3.0};
    const Profile here = line(Component::Ux, Axis::x, 1.0);
    const auto by_xi =
        predict({}, here, places, parameters(monopole, {2.2, 1.3, 22.0}), std::vector{2.2, 1.3, 22.0});
    const auto by_alpha =
        predict({}, here, places, parameters({"f_over_mu", "eta", "alpha"}, {2.2, 1.3, 0.1}),
                std::vector{2.2, 1.3, 0.1});
    for (std::size_t i = 0; i < places.size(); ++i)
        CHECK(by_alpha.value[i] == Approx(by_xi.value[i]).epsilon(1e-14));
}

const std::optional<rodwake::PeriodicBox> in_boxes[] = {std::nullopt, rodwake::PeriodicBox(78.0),
                                                        rodwake::PeriodicBox(78.0, 60.0)};

TEST_CASE("gradients of the residuals agree with differences") {
    const std::vector<std::string> names = {"f_over_mu", "f2d_over_mu", "eta",     "xi",
                                            "x0",        "offset",      "offset_y"};
    const std::vector<double> truth = {2.2, 0.8, 1.3, 22.0, 0.4, 0.05, -0.02};
    for (const std::optional<rodwake::PeriodicBox>& box : in_boxes)
        for (const double heading : {0.0, 0.4}) {
            CAPTURE(to_string(box.value_or(0.0)), heading);
            const WakeModel model{box, heading, 0.0};
            CHECK(jacobian_error(four_lines(model, names, truth), {2.0, 1.0, 0.9, 15.0, 0.1, 0.0, 0.1}) <
                  1e-6);
            CHECK(jacobian_error(four_lines(model, {"f_over_mu", "eta", "alpha"}, {2.2, 1.3, 0.1}),
                                 {2.0, 3.0, 0.2}) < 1e-6);
        }
}

TEST_CASE("a wrong gradient is seen") {
    Problem problem = four_lines({}, monopole, {2.2, 1.3, 22.0});
    const auto right = problem.evaluate;
    problem.evaluate = [=](auto p, auto r, Eigen::MatrixXd* jacobian) {
        right(p, r, jacobian);
        if (jacobian)
            jacobian->col(1) *= 1.0 + 1e-5;
    };
    CHECK(jacobian_error(problem, {2.0, 1.0, 15.0}) > 1e-6);
}

TEST_CASE("the residuals vanish for the parameters the data were made from") {
    const std::vector<double> truth = {2.2, 1.3, 22.0};
    for (const std::optional<rodwake::PeriodicBox>& box : in_boxes) {
        const Problem problem = four_lines({box, 0.0, 0.0}, monopole, truth);
        CHECK(toy::residuals(problem, truth).cwiseAbs().maxCoeff() == 0.0);
        CHECK(problem.sigma_known);
    }
}

TEST_CASE("points in the core are left out") {
    Profile data = line(Component::Ux, Axis::x, 0.0);
    data.place = {-9.0, -8.0, -1.0, 0.0, 7.9, 8.5};
    data.value = data.sigma = {1.0, 2.0, 3.0, 4.0, 5.0, 6.0};
    const Profile kept = outside_core(data, 8.0);
    CHECK(kept.place == std::vector{-9.0, -8.0, 8.5});
    CHECK(kept.value == std::vector{1.0, 2.0, 6.0});
    CHECK(kept.where.back() == "line[5]");
    CHECK_THROWS_WITH(wake_problem({{}, 0.0, 10.0}, {data}, parameters(monopole, {1.0, 1.0, 1.0})),
                      Contains("no points are left outside"));
    CHECK_THROWS_WITH(wake_problem({}, {data}, parameters(monopole, {1.0, 1.0, 1.0})),
                      Contains("line[3]") && Contains("infinite"));
}

TEST_CASE("points that share data are weighed less") {
    const auto list = parameters(monopole, {1.0, 1.0, 10.0});
    Profile data = made_up({}, list, {2.0, 1.0, 10.0}, line(Component::Ux, Axis::x, 0.0), 20, 30.0, 0.1);
    const Problem once = wake_problem({}, {data}, list);
    data.independent = 0.25;
    const Problem quarter = wake_problem({}, {data}, list);
    const Eigen::VectorXd full = toy::residuals(once, {1.0, 1.0, 10.0}),
                          less = toy::residuals(quarter, {1.0, 1.0, 10.0});
    CHECK((full - 2.0 * less).norm() < 1e-13 * full.norm());
    CHECK(once.independent == 1.0);
    CHECK(quarter.independent == Approx(0.25));
    data.independent = 0.0;
    CHECK_THROWS_WITH(wake_problem({}, {data}, list), Contains("independent = 0"));
}

namespace {

/// Independent values in all.
double values(const std::vector<double>& places, double spacing) {
    return mean_worth(independent_worth(places, spacing)) * static_cast<double>(places.size());
}

std::vector<double> steps(std::size_t count, double step, double from = 0.0) {
    std::vector<double> places;
    for (std::size_t i = 0; i < count; ++i)
        places.push_back(from + step * static_cast<double>(i));
    return places;
}

std::vector<double> both(std::vector<double> a, const std::vector<double>& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

} // namespace

TEST_CASE("independent values are counted from the places themselves") {
    const std::vector<double> run = steps(40, 1.0);
    CHECK(independent_worth(run, 4.0) == std::vector<double>(40, 0.25));
    CHECK(values(run, 1.0) == 40.0);
    CHECK(values(run, 0.3) == 40.0);
    CHECK(values(both(steps(20, 1.0), steps(20, 1.0, 27.5)), 4.0) == 10.0); // a gap is none of the steps
    // two runs one after the other, whatever their places: each counts
    for (const double from : {0.0, 0.01, 0.5, 100.0})
        CHECK(values(both(run, steps(40, 1.0, from)), 4.0) == Approx(20.0));
    CHECK(values(both(run, std::vector<double>(run.rbegin(), run.rend())), 4.0) == Approx(20.0).epsilon(0.1));
    // in no order, or row by row, they are one: what is not known to be independent is not
    std::vector<double> mixed;
    for (std::size_t i = 0; i < 80; ++i)
        mixed.push_back(static_cast<double>(i * 31 % 80) * 0.5);
    CHECK(values(mixed, 4.0) == Approx(10.0));
    std::vector<double> pairs;
    for (const double place : run) {
        pairs.push_back(place);
        pairs.push_back(place + 1e-6);
    }
    CHECK(values(pairs, 4.0) == Approx(10.0).epsilon(0.1)); // ends of the run: half a step of 20
    CHECK(values(std::vector<double>(10, 5.0), 4.0) == Approx(1.0));
    CHECK(values({5.0}, 4.0) == 1.0);
    // a dense part is one value, what is far from all else another
    const std::vector<double> uneven = independent_worth(both(steps(100, 0.001), {10.0, 20.0, 30.0}), 4.0);
    CHECK(uneven[100] + uneven[101] + uneven[102] == 3.0);
    CHECK(uneven[50] == Approx(0.01));
}

TEST_CASE("points in a dense part of a profile are weighed less than the others") {
    const auto list = parameters(monopole, {1.0, 1.0, 10.0});
    Profile data = made_up({}, list, {2.0, 1.0, 10.0}, line(Component::Ux, Axis::x, 1.0), 20, 30.0, 0.1);
    for (std::size_t i = 0; i < 10; ++i)
        data.place[i] = -30.0 + 1e-3 * static_cast<double>(i);
    share_data(data, 2.0);
    CHECK(residual_scale(data, 3) == Approx(0.1 * std::sqrt(10.0)).epsilon(1e-9));
    CHECK(residual_scale(data, 15) == Approx(0.1).epsilon(1e-12));
    CHECK(wake_problem({}, {data}, list).independent == Approx(11.0 / 20.0));
    share_data(data, 200.0); // all of it is one value
    CHECK(independent_values(wake_problem({}, {data}, list)) == 1);
}

TEST_CASE("chi2 of a prediction is that of the residuals the fit has") {
    Profile data = line(Component::Ux, Axis::x, 1.0);
    data.place = {-3.0, -1.0, 2.0, 4.0};
    data.value = {0.2, 0.5, 0.4, 0.1};
    data.independent = 0.5;
    const std::vector<double> values = {1.0, 2.0, 30.0};
    const auto list = parameters(monopole, values);
    for (const bool known : {false, true}) {
        if (known)
            data.sigma = {0.1, 0.2, 0.1, 0.3};
        const Problem problem = wake_problem({}, {data}, list);
        const Eigen::VectorXd r = toy::residuals(problem, values);
        std::vector<double> model = predict({}, data, data.place, list, values).value;
        CHECK(chi2_of(data, model) == Approx(r.squaredNorm()).epsilon(1e-12));
        model[1] = std::nan("");
        CHECK(chi2_of(data, model) == Approx(r.squaredNorm() - r[1] * r[1]).epsilon(1e-12));
        CHECK(residual_scale(data, 3) == Approx((known ? 0.3 : 1.0) * std::sqrt(2.0)).epsilon(1e-15));
        CHECK_THROWS_AS(chi2_of(data, std::span(model).first(3)), rodwake::InputError);
    }
}

TEST_CASE("places at the singularity have no prediction") {
    const std::vector<double> places = {-1.0, 0.0, 1.0}, values = {1.0, 1.0, 1.0};
    const auto found =
        predict({}, line(Component::Ux, Axis::x, 0.0), places, parameters(monopole, values), values);
    CHECK(std::isfinite(found.value[0]));
    CHECK(std::isnan(found.value[1]));
    CHECK(std::isfinite(found.value[2]));
}

TEST_CASE("data that cannot be fitted are refused") {
    const auto list = parameters(monopole, {1.0, 1.0, 10.0});
    const Profile good =
        made_up({}, list, {2.0, 1.0, 10.0}, line(Component::Ux, Axis::x, 0.0), 20, 30.0, 0.1);
    const auto refused = [&](auto change, const std::string& words) {
        Profile data = good;
        change(data);
        CHECK_THROWS_WITH(wake_problem({}, {data}, list), Contains(words));
        CHECK_THROWS_AS(wake_problem({}, {data}, list), rodwake::InputError);
    };
    CHECK_NOTHROW(wake_problem({}, {good}, list));
    refused([](Profile& p) { p.value[3] = NAN; }, "line[3]: position and value must be finite");
    refused([](Profile& p) { p.place[2] = INFINITY; }, "line[2]");
    refused([](Profile& p) { p.sigma[5] = 0.0; }, "line[5]: sigma = 0: must be above 0");
    refused([](Profile& p) { p.sigma[5] = -1.0; }, "sigma = -1");
    refused([](Profile& p) { p.sigma[5] = NAN; }, "sigma");
    refused([](Profile& p) { p.sigma.pop_back(); }, "differ in number");
    refused([](Profile& p) { p.at = NAN; }, "other coordinate");
    refused([](Profile& p) { p.value.assign(20, 0.5); }, "all 20 values are equal (0.5)");
    refused([](Profile& p) { p.place.resize(2), p.value.resize(2), p.sigma.resize(2); },
            "2 data points cannot fix 3 parameters");
    CHECK_THROWS_WITH(wake_problem({}, {}, list), Contains("no data"));
    CHECK_THROWS_WITH(wake_problem({-1.0, 0.0, 0.0}, {good}, list), Contains("box = -1"));
}

TEST_CASE("some profiles with and some without sigma are refused, all without are relative") {
    const auto list = parameters(monopole, {1.0, 1.0, 10.0});
    const Profile with =
        made_up({}, list, {2.0, 1.0, 10.0}, line(Component::Ux, Axis::x, 0.0), 20, 30.0, 0.1);
    Profile without = with;
    without.sigma.clear();
    CHECK_THROWS_WITH(wake_problem({}, {with, without}, list), Contains("column sigma"));
    CHECK_FALSE(wake_problem({}, {without, without}, list).sigma_known);
}

TEST_CASE("parameters that are unknown or missing are named") {
    const Profile data = made_up({}, parameters(monopole, {2.0, 1.0, 10.0}), {2.0, 1.0, 10.0},
                                 line(Component::Ux, Axis::x, 0.0), 20, 30.0, 0.1);
    const auto refused = [&](const std::vector<std::string>& names, const std::string& words) {
        CHECK_THROWS_WITH(wake_problem({}, {data}, parameters(names, std::vector<double>(names.size(), 1.0))),
                          Contains(words));
    };
    refused({"f_over_mu", "eta", "zeta"}, "unknown parameter \"zeta\"");
    refused({"f_over_mu", "xi"}, "eta is needed");
    refused({"f_over_mu", "eta"}, "exactly one of xi and alpha");
    refused({"f_over_mu", "eta", "xi", "alpha"}, "exactly one of xi and alpha");
    refused({"f2d_over_mu", "eta", "alpha"}, "needs f_over_mu");
}
