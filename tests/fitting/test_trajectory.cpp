// Residuals of trajectories: gradients, errors, and the couplings found again from the reference
// trajectories.

#include "rod_data.hpp"
#include "toy_problems.hpp"

#include "rodwake/core/error.hpp"

#include "catch2/catch.hpp"

#include <algorithm>
#include <cmath>

using namespace rodwake;
using namespace rodwake::fitting;
using Catch::Matchers::Contains;
using test::reference;
using test::ReferenceCase;
using test::tight;
using test::trajectory_of;
using toy::parameter;
using toy::residuals;

namespace {

std::vector<Parameter> parameters(double kappa, double gamma1, double gamma2, double eta, double alpha) {
    return {parameter("kappa", kappa), parameter("gamma1", gamma1), parameter("gamma2", gamma2),
            parameter("eta", eta), parameter("alpha", alpha)};
}

std::vector<double> starts(const Problem& problem) { return toy::starts(problem.parameters); }

double gradient_error(const Problem& problem) { return toy::jacobian_error(problem, starts(problem)); }

/// Rounding of the differences: solves to 1e-10 over steps of 3e-4 and more of the parameter.
constexpr double gradient_bound = 1e-5;

} // namespace

TEST_CASE("gradients of trajectory residuals agree with differences, headings free too") {
    Trajectory mixed = trajectory_of(reference("mixed couplings")),
               three = trajectory_of(reference("three rods"));
    mixed.free_headings = true;
    const Problem problem = trajectory_problem(tight(), {mixed, three}, parameters(2.7, -1.3, 0.9, 1.2, 1.8));
    REQUIRE(problem.parameters.size() == 7);
    CHECK(problem.parameters[6].name == "heading.0.1");
    CHECK(problem.residuals == 2 + 3 * 6 + 3 * 9);
    CHECK(gradient_error(problem) < gradient_bound);
}

TEST_CASE("gradients by the poses at the start agree with differences, the first row is data then") {
    Trajectory mixed = trajectory_of(reference("mixed couplings")),
               three = trajectory_of(reference("three rods"));
    three.free_start = true;
    three.free_headings = true; // of which it is part
    const Problem problem = trajectory_problem(tight(), {mixed, three}, parameters(2.7, -1.3, 0.9, 1.2, 1.8));
    REQUIRE(problem.parameters.size() == 5 + 9);
    CHECK(problem.parameters[6].name == "y.1.0");
    CHECK(problem.parameters[13].name == "heading.1.2");
    CHECK(problem.residuals == 3 * 6 + 4 * 9);
    CHECK(problem.residual_name(18 + 4) == "three rods, row 1 y1");
    CHECK(gradient_error(problem) < gradient_bound);
    const auto rows = predict(tight(), three, 1, problem.parameters, starts(problem));
    CHECK(rows[0] == three.states[0]);
}

TEST_CASE("gradients hold by xi and by BDF") {
    std::vector<Parameter> by_xi = parameters(2.7, -1.3, 0.9, 1.2, 1.8);
    by_xi[4].name = "xi";
    const auto data = trajectory_of(reference("mixed couplings"));
    CHECK(gradient_error(trajectory_problem(tight(integrate::Method::bdf), {data}, by_xi)) < gradient_bound);
}

TEST_CASE("gradients hold at couplings that are zero") {
    const auto data = trajectory_of(reference("mixed couplings"));
    CHECK(gradient_error(trajectory_problem(tight(), {data}, parameters(0.0, 0.0, 0.0, 1.2, 1.8))) ==
          Approx(0.0).margin(gradient_bound));
}

TEST_CASE("gradients hold through a contact: its time, and rows after it that keep the state it had") {
    Trajectory data = trajectory_of(reference("side-by-side, strong coupling"));
    const double contact = *data.contact_time;
    for (const double t : {0.5 * contact, contact + 1.0, contact + 2.0}) {
        data.times.push_back(t);
        data.states.push_back(data.states.front());
    }
    const Problem problem = trajectory_problem(tight(), {data}, parameters(100.0, 0.5, -0.5, 1.0, 1.0));
    CHECK(gradient_error(problem) < gradient_bound);
    const auto rows = predict(tight(), data, 0, problem.parameters, starts(problem));
    CHECK(rows[2] == rows[3]);
    CHECK(std::hypot(rows[2][0] - rows[2][3], rows[2][1] - rows[2][4]) == Approx(0.1).epsilon(1e-9));
}

TEST_CASE("a model run that collides where the data did not ends there, with slopes") {
    const Trajectory data = trajectory_of(reference("side-by-side, weak attraction"));
    auto all = parameters(1.0, 0.0, 0.0, 1.0, 1.0); // meets at t = 29, the last row is at 30
    for (std::size_t j = 1; j < 5; ++j)
        all[j].fixed = true;
    const Problem problem = trajectory_problem(tight(), {data}, all);
    CHECK(gradient_error(problem) < gradient_bound);
    const auto end = predict(tight(), data, 0, problem.parameters, starts(problem)).back();
    CHECK(end[1] - end[4] == Approx(0.01 * 2.0 * data.states.back()[1]).epsilon(1e-6));
}

TEST_CASE("a contact that is not met by the end of the run still has a slope, and the right sign") {
    const Trajectory data = trajectory_of(reference("side-by-side, contact at 0.1"));
    auto all = parameters(0.02, 0.0, 0.0, 1.0, 1.0);
    for (std::size_t j = 1; j < 5; ++j)
        all[j].fixed = true;
    const Problem problem = trajectory_problem(tight(), {data}, all);
    CHECK(gradient_error(problem) < gradient_bound);
    Eigen::MatrixXd jacobian;
    CHECK(residuals(problem, starts(problem), &jacobian)[0] > 0.0); // too late
    CHECK(jacobian(0, 0) < 0.0);                                    // more kappa brings it sooner
}

TEST_CASE("the comparison of gradients notices a wrong one") {
    Problem problem = trajectory_problem(tight(), {trajectory_of(reference("mixed couplings"))},
                                         parameters(2.7, -1.3, 0.9, 1.2, 1.8));
    const auto right = problem.evaluate;
    problem.evaluate = [right](auto p, auto r, Eigen::MatrixXd* j) {
        right(p, r, j);
        if (j)
            (*j)(4, 3) *= 1.01;
    };
    CHECK(gradient_error(problem) > gradient_bound);
}

TEST_CASE("columns of fixed parameters are left out, of tied ones not") {
    auto all = parameters(2.7, -1.3, 0.9, 1.2, 1.8);
    all[3].fixed = true;
    all[2].tied_to = "gamma1";
    const Problem problem = trajectory_problem(tight(), {trajectory_of(reference("mixed couplings"))}, all);
    Eigen::MatrixXd jacobian;
    residuals(problem, starts(problem), &jacobian);
    CHECK(jacobian.col(3).isZero(0.0));
    CHECK(!jacobian.col(2).isZero(1e-6));
}

TEST_CASE("residuals are data minus nothing but the model, in sigma, and named") {
    const ReferenceCase one = reference("three rods");
    Trajectory data = trajectory_of(one);
    data.where = {"r.csv:2", "r.csv:3", "r.csv:4", "r.csv:5"};
    data.states[1][4] += 5e-3;
    const Problem problem = trajectory_problem(tight(), {data}, parameters(2.0, 0.5, -0.5, 1.0, 1.0));
    const Eigen::VectorXd r = residuals(problem, starts(problem));
    CHECK(r[4] == Approx(-5.0).epsilon(1e-4)); // 5 sigma; the model is good to 1e-8
    CHECK(std::abs(r[5]) < 1e-4);
    CHECK(problem.residual_name(4) == "r.csv:3 y1");
    CHECK(problem.residual_name(26) == "r.csv:5 theta2");
    Trajectory later = data; // only times from the first row on count
    for (double& t : later.times)
        t += 17.0;
    const Eigen::VectorXd shifted =
        residuals(trajectory_problem(tight(), {later}, problem.parameters), starts(problem));
    CHECK((shifted - r).cwiseAbs().maxCoeff() < 1e-6);
}

TEST_CASE("malformed trajectories are refused with what is wrong and where") {
    const Trajectory good = trajectory_of(reference("mixed couplings"));
    const auto all = parameters(3.0, -1.5, 0.75, 1.3, 2.0);
    const auto refused = [&](auto change, const std::string& text) {
        Trajectory data = good;
        std::vector<Parameter> p = all;
        change(data, p);
        CHECK_THROWS_WITH(trajectory_problem(tight(), {data}, p), Contains(text));
        CHECK_THROWS_AS(trajectory_problem(tight(), {data}, p), InputError);
    };
    refused([](auto& d, auto&) { d.states[2].pop_back(); }, "row 3: 5 numbers");
    refused([](auto& d, auto&) { d.times[2] = d.times[1]; }, "not after");
    refused([](auto& d, auto&) { d.states[1][0] = std::nan(""); }, "finite");
    refused([](auto& d, auto&) { d.times[3] = HUGE_VAL; }, "finite");
    refused([](auto& d, auto&) { d.sigma_heading = 0.0; }, "sigma_heading = 0");
    refused([](auto& d, auto&) { d.times.pop_back(); }, "3 times and 4 rows");
    refused([](auto& d, auto&) { d.states.clear(), d.times.clear(); }, "0 times");
    refused(
        [](auto& d, auto&) {
            for (auto& s : d.states)
                s.resize(3);
        },
        "two rods or more");
    refused([](auto& d, auto&) { d.contact_time = 5.0; }, "needs a contact_distance");
    refused([](auto& d, auto&) { d.contact_distance = 100.0; }, "below the smallest starting separation");
    refused([](auto& d, auto&) { d.contact_distance = 0.1, d.contact_time = -1.0; }, "after the first row");
    refused([](auto& d, auto&) { d.times.resize(1), d.states.resize(1); }, "a single row");
    refused([](auto& d, auto&) { d.states[0] = {0, 0, 0, 0, 0, 1}; }, "same position");
    refused([](auto&, auto& p) { p[0].name = "kapa"; }, "no parameter \"kapa\"");
    refused([](auto&, auto& p) { p[0].name = "heading.0.1"; }, "heading.0.1"); // not free
    refused([](auto&, auto& p) { p.erase(p.begin() + 3); }, "eta is missing");
    refused([](auto&, auto& p) { p.pop_back(); }, "xi (or alpha) is missing");
    refused([](auto&, auto& p) { p.push_back(parameter("xi", 1.0)); }, "both given");
    refused([](auto&, auto& p) { p.erase(p.begin(), p.begin() + 3); }, "nothing turns");
    const auto one_datum = [](auto& d, auto&) {
        d.times.resize(1), d.states.resize(1), d.contact_distance = 0.1, d.contact_time = 5.0;
    };
    refused(one_datum, "1 data cannot fix 5");
    CHECK_THROWS_WITH(trajectory_problem(tight(), {}, all), Contains("none"));
    CHECK_THROWS_WITH(trajectory_problem(tight(integrate::Method::erk), {good}, all), Contains("adams"));
    CHECK_NOTHROW(trajectory_problem(tight(), {good}, all));
}

TEST_CASE("a model run that fails is an error, not a crash") {
    Trajectory data = trajectory_of(reference("mixed couplings"));
    TrajectoryModel model = tight();
    model.ode.max_steps = 3;
    const Problem problem = trajectory_problem(model, {data}, parameters(3.0, -1.5, 0.75, 1.3, 2.0));
    CHECK_THROWS_WITH(residuals(problem, starts(problem)),
                      Contains("mixed couplings") && Contains("max_steps"));
}

TEST_CASE("problems joined: residuals one after the other, parameters by name") {
    const auto all = parameters(2.7, -1.3, 0.9, 1.2, 1.8);
    const Trajectory mixed = trajectory_of(reference("mixed couplings")),
                     three = trajectory_of(reference("three rods"));
    auto fewer = all;
    fewer.erase(fewer.begin() + 1);
    const Problem a = trajectory_problem(tight(), {mixed}, fewer),
                  b = trajectory_problem(tight(), {three}, all);
    const Problem both = joined({a, b});
    REQUIRE(both.parameters.size() == 5);
    CHECK(both.parameters[4].name == "gamma1");
    CHECK(both.residuals == a.residuals + b.residuals);
    CHECK(both.residual_name(a.residuals + 3) == b.residual_name(3));
    const Eigen::VectorXd r = residuals(both, {2.7, 0.9, 1.2, 1.8, -1.3});
    CHECK(r.head(18) == residuals(a, {2.7, 0.9, 1.2, 1.8}));
    CHECK(r.tail(27) == residuals(b, {2.7, -1.3, 0.9, 1.2, 1.8}));
    CHECK(gradient_error(both) ==
          Approx(std::max(gradient_error(a), gradient_error(b))).margin(gradient_bound));

    auto other = all;
    other[3].start = 1.3;
    CHECK_THROWS_WITH(joined({a, trajectory_problem(tight(), {three}, other)}), Contains("eta"));
    Problem relative = b;
    relative.sigma_known = false;
    CHECK_THROWS_WITH(joined({a, relative}), Contains("standard errors"));
    CHECK_THROWS_AS(joined({}), InputError);
}
