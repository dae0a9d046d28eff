// The search: each algorithm, bounds, many starts, interruption and resume.

#include "catch2/catch.hpp"
#include "fitting/search.hpp"
#include "toy_problems.hpp"

#include <algorithm>
#include <atomic>

using namespace rodwake::fitting;
using Catch::Matchers::Contains;
using Catch::Matchers::StartsWith;

namespace {

constexpr Algorithm algorithms[] = {Algorithm::bobyqa, Algorithm::nelder_mead, Algorithm::slsqp,
                                    Algorithm::lbfgs,  Algorithm::mma,         Algorithm::mlsl,
                                    Algorithm::crs,    Algorithm::isres,       Algorithm::direct_l};

Method with(Algorithm algorithm) {
    Method method;
    method.algorithm = algorithm;
    return method;
}

/// To the last bit, all of it.
bool same(const StartResult& a, const StartResult& b) {
    return a.index == b.index && a.start == b.start && a.end == b.end && a.objective == b.objective &&
           a.termination == b.termination && a.evaluations == b.evaluations;
}
bool same(const Fit& a, const Fit& b) {
    return a.values == b.values && a.objective == b.objective && a.chi2 == b.chi2 &&
           a.termination == b.termination && a.reason == b.reason && a.distance == b.distance &&
           a.evaluations == b.evaluations &&
           std::ranges::equal(a.starts, b.starts, [](const auto& x, const auto& y) { return same(x, y); });
}

Problem boxed_rosenbrock() {
    Problem problem = toy::rosenbrock(-1.2, 1.0);
    for (Parameter& p : problem.parameters) {
        p.lower = -5.0;
        p.upper = 5.0;
    }
    return problem;
}

Problem boxed_decay() {
    Problem problem = toy::decay(40, 3);
    problem.parameters[0] = toy::bounded("a", 1.0, -20.0, 20.0);
    problem.parameters[1].lower = 0.01;
    problem.parameters[1].upper = 100.0;
    problem.parameters[2] = toy::bounded("c", 0.7, 0.6, 20.0);
    return problem;
}

} // namespace

TEST_CASE("every algorithm finds the end of Rosenbrock's valley") {
    for (const Algorithm algorithm : algorithms) {
        CAPTURE(to_string(algorithm));
        const Fit best = fit(boxed_rosenbrock(), with(algorithm));
        CHECK_THAT(best.reason, StartsWith(to_string(algorithm)));
        CHECK_THAT(best.reason, Contains("polish"));
        CHECK(best.termination == Termination::converged);
        // r = 0 there, and Levenberg-Marquardt ends within rounding errors of it
        CHECK(best.values[0] == Approx(1.0).epsilon(1e-12));
        CHECK(best.values[1] == Approx(1.0).epsilon(1e-12));
        CHECK(best.chi2 < 1e-20);
        CHECK(best.evaluations > 10);
    }
}

TEST_CASE("every algorithm comes down by itself, without Levenberg-Marquardt") {
    for (const Algorithm algorithm : algorithms) {
        CAPTURE(to_string(algorithm));
        Method method = with(algorithm);
        method.levenberg_marquardt = false;
        method.tolerance = 1e-12;
        method.max_evaluations = 20000;
        const Fit best = fit(boxed_decay(), method);
        method.levenberg_marquardt = true;
        const Fit refined = fit(boxed_decay(), method);
        CHECK_THAT(best.reason, !Contains("polish"));
        // MMA and L-BFGS stop at a relative change of 1e-12 of the objective, far from 1e-6
        CHECK(best.objective <= refined.objective * (1.0 + 1e-6));
        CHECK(refined.objective <= best.objective * (1.0 + 1e-15));
    }
}

TEST_CASE("BOBYQA, which needs two parameters, says so for one") {
    Problem problem = toy::decay(40, 3);
    problem.parameters[0].fixed = problem.parameters[2].fixed = true;
    const Fit best = fit(problem, with(Algorithm::bobyqa));
    CHECK_THAT(best.reason, Contains("bobyqa needs two parameters; instead nelder-mead"));
    CHECK(best.objective == Approx(fit(problem, {}).objective).epsilon(1e-12));
}

TEST_CASE("a bound that is active is reached exactly, and the others are as if it were fixed") {
    Problem held = boxed_decay();
    held.parameters[2].start = 0.6;
    held.parameters[2].fixed = true;
    const Fit expected = fit(held, {});
    for (const Algorithm algorithm : algorithms) {
        CAPTURE(to_string(algorithm));
        const Fit best = fit(boxed_decay(), with(algorithm));
        CHECK(best.termination == Termination::converged);
        CHECK(best.values[2] == 0.6);
        // both are stationary to 1e-6 of a standard error (0.1 and less) or better
        CHECK(best.values[0] == Approx(expected.values[0]).epsilon(1e-7));
        CHECK(best.values[1] == Approx(expected.values[1]).epsilon(1e-7));
        CHECK(best.distance < 1e-5);
    }
}

TEST_CASE("upper bounds hold as lower ones do, and let go inward") {
    Problem problem = boxed_decay(), held = problem;
    problem.parameters[2] = toy::bounded("c", 0.1, -20.0, 0.4);
    held.parameters[2].fixed = true;
    held.parameters[2].start = 0.4;
    const Fit best = fit(problem, {}), expected = fit(held, {});
    CHECK(best.values[2] == 0.4);
    CHECK(best.termination == Termination::converged);
    CHECK(best.distance < 1e-5);
    CHECK(best.values[0] == Approx(expected.values[0]).epsilon(1e-7));
    problem.parameters[2] = toy::bounded("c", 3.0, -20.0, 3.0);
    const SearchSpace space(problem);
    Evaluator evaluator(problem, space, {});
    const SearchResult end =
        levenberg_marquardt(evaluator, space.coordinates(std::vector<double>{1.0, 1.0, 3.0}));
    CHECK(space.values(end.u)[2] == Approx(fit(toy::decay(40, 3), {}).values[2]).epsilon(1e-7));
    CHECK(end.termination == Termination::converged);
}

TEST_CASE("bounds on all sides, and starts on bounds") {
    Problem corner = boxed_decay();
    corner.parameters[0] = toy::bounded("a", 3.0, 3.0, 4.0);
    corner.parameters[1].start = corner.parameters[1].lower = 2.5;
    corner.parameters[2] = toy::bounded("c", 2.0, 1.0, 2.0);
    const Fit best = fit(corner, {});
    CHECK(best.values == std::vector<double>{3.0, 2.5, 1.0});
    CHECK(best.termination == Termination::converged);
    Problem inward = toy::line({0.0, 1.0, 2.0, 3.0});
    inward.parameters[0] = toy::bounded("a", 5.0, -5.0, 5.0);
    inward.parameters[1] = toy::bounded("b", -2.0, -2.0, 2.0);
    CHECK(fit(inward, {}).values[1] == Approx(1.0).epsilon(1e-12));
}

TEST_CASE("global searches and many starts find the deepest of several minima, one local search does not") {
    const Problem problem = toy::waves(-8.0);
    const Fit local = fit(problem, {});
    CHECK(std::abs(local.values[0] - 2.0) > 1.0);
    CHECK(local.termination == Termination::converged);
    for (const Algorithm algorithm :
         {Algorithm::mlsl, Algorithm::crs, Algorithm::isres, Algorithm::direct_l}) {
        CAPTURE(to_string(algorithm));
        CHECK(fit(problem, with(algorithm)).values[0] == Approx(2.0).epsilon(1e-8));
    }
    Problem from_zero = problem;
    from_zero.parameters[0].start = 0.0; // linear, start 0: the others anywhere between the bounds
    Method many;
    many.starts = 30;
    const Fit best = fit(from_zero, many);
    CHECK(best.values[0] == Approx(2.0).epsilon(1e-8));
    CHECK(best.starts.size() == 30);
    CHECK(std::ranges::count_if(best.starts, [](const StartResult& s) { return s.objective > 1e-3; }) > 3);
    for (const StartResult& s : best.starts) {
        CHECK(s.objective >= best.objective);
        CHECK((s.start[0] >= -10.0 && s.start[0] <= 10.0));
    }
}

TEST_CASE("the better of two minima is taken, however little better") {
    Problem problem;
    problem.parameters = {toy::bounded("x", 0.0, -10.0, 10.0)};
    problem.residuals = 3;
    problem.evaluate = [](auto p, auto r, Eigen::MatrixXd* jacobian) {
        const double d =
            p[0] - 0.5; // minima at d = -2, nearer the start, and 2, better by 4e-6 of the objective
        r << 3.0 * (d * d - 4.0), 0.005 * (d - 2.0), 10.0;
        if (jacobian)
            *jacobian << 6.0 * d, 0.005, 0.0;
    };
    CHECK(fit(problem, {}).values[0] == Approx(-1.5).epsilon(1e-3));
    Method many;
    many.starts = 10;
    CHECK(fit(problem, many).values[0] == Approx(2.5).epsilon(1e-3));
}

TEST_CASE("starts spread by a factor, within the bounds, the first where the problem says") {
    Problem problem = toy::decay(20, 3);
    problem.parameters[0].start = -1.0;
    problem.parameters[1].lower = 0.5;
    Method method;
    method.starts = 200;
    method.spread = 4.0;
    method.max_evaluations = 1;
    method.levenberg_marquardt = false;
    const Fit best = fit(problem, method);
    CHECK(best.starts[0].start == std::vector<double>{-1.0, 1.0, 0.1});
    double least = 1.0, most = 1.0;
    int turned = 0;
    for (const StartResult& s : best.starts) {
        CHECK((std::abs(s.start[0]) >= 0.25 && std::abs(s.start[0]) <= 4.0));
        turned += s.start[0] > 0.0;
        CHECK((s.start[1] >= 0.5 && s.start[1] <= 4.0));
        CHECK((std::abs(s.start[2]) >= 0.025 && std::abs(s.start[2]) <= 0.4));
        least = std::min(least, s.start[1]);
        most = std::max(most, s.start[1]);
    }
    // of 199 even ones each of the outer tenths holds one but for a chance of 0.9^199 = 1e-9
    CHECK(least < 0.5 * std::pow(8.0, 0.1));
    CHECK(most > 4.0 / std::pow(8.0, 0.1));
    CHECK(std::abs(turned - 99.5) < 4.0 * std::sqrt(199.0) / 2.0); // binomial, 4 standard deviations
}

TEST_CASE("starts keep the sign where a bound allows no other") {
    Problem problem = toy::decay(20, 3);
    problem.parameters[0].start = -1.0;
    problem.parameters[0].upper = 0.0;
    problem.parameters[2].lower = -0.05; // both, but not as far
    Method method;
    method.starts = 50;
    method.max_evaluations = 1;
    method.levenberg_marquardt = false;
    bool below = false;
    for (const StartResult& s : fit(problem, method).starts) {
        CHECK((s.start[0] >= -10.0 && s.start[0] <= -0.1));
        CHECK(s.start[2] >= -0.05);
        below = below || s.start[2] < 0.0;
    }
    CHECK(below);
}

TEST_CASE("threads change no bit, the seed does", "[threads]") {
    for (const Algorithm algorithm : {Algorithm::slsqp, Algorithm::nelder_mead, Algorithm::mlsl,
                                      Algorithm::crs, Algorithm::isres, Algorithm::direct_l}) {
        CAPTURE(to_string(algorithm));
        Method method = with(algorithm);
        method.starts = 12;
        method.max_evaluations = 300;
        const Fit one = fit(toy::waves(-8.0), method);
        method.threads = 4;
        CHECK(same(one, fit(toy::waves(-8.0), method)));
        method.seed = 2;
        CHECK_FALSE(same(one, fit(toy::waves(-8.0), method)));
    }
}

TEST_CASE("random searches take the seed, the others have no use for it") {
    const auto differs = [](Algorithm algorithm) {
        Method method = with(algorithm);
        method.max_evaluations = 200;
        const Fit one = fit(toy::waves(-8.0), method);
        CHECK(same(one, fit(toy::waves(-8.0), method)));
        method.seed = 2;
        return !same(one, fit(toy::waves(-8.0), method));
    };
    CHECK(differs(Algorithm::crs));
    CHECK(differs(Algorithm::isres));
    CHECK_FALSE(differs(Algorithm::direct_l));
    CHECK_FALSE(differs(Algorithm::slsqp));
}

TEST_CASE("finished starts are taken over: an interrupted fit goes on to the same bits") {
    const Problem problem = toy::waves(-8.0);
    Method method;
    method.starts = 8;
    const Fit whole = fit(problem, method);
    for (const std::size_t threads : {1, 3}) {
        std::vector<StartResult> ledger;
        Method first = method;
        first.threads = threads;
        first.on_start_done = [&](const StartResult& end) { ledger.push_back(end); };
        first.stop_requested = [&] { return ledger.size() >= 3; };
        const Fit cut = fit(problem, first);
        CHECK(cut.termination == Termination::interrupted);
        CHECK((ledger.size() >= 3 && ledger.size() <= 5));
        CHECK(cut.starts.size() < 8);
        Method second = method;
        second.done = ledger;
        std::size_t again = 0;
        second.on_start_done = [&](const StartResult&) { ++again; };
        CHECK(same(fit(problem, second), whole));
        CHECK(again == 8 - ledger.size());
    }
}

TEST_CASE("a stop request ends the search at once with the best so far") {
    for (const Algorithm algorithm : algorithms) {
        CAPTURE(to_string(algorithm));
        Problem problem = boxed_rosenbrock();
        std::atomic<long> calls = 0, after = 0;
        std::atomic<double> best_seen = 1e300;
        problem.evaluate = [&, inner = problem.evaluate](auto p, auto r, Eigen::MatrixXd* jacobian) {
            inner(p, r, jacobian);
            ++calls;
            after += calls > 15;
            best_seen = std::min<double>(best_seen, r.squaredNorm());
        };
        Method method = with(algorithm);
        method.stop_requested = [&] { return calls >= 15; };
        const Fit cut = fit(problem, method);
        CHECK(cut.termination == Termination::interrupted);
        CHECK(after <= 1); // the look at the best point, for its chi2
        CHECK(cut.evaluations == 15);
        CHECK(cut.objective == best_seen);
        CHECK(cut.chi2 == cut.objective);
    }
}

TEST_CASE("a stop at any evaluation, in Levenberg-Marquardt too, leaves the best so far") {
    bool in_second_stage = false;
    for (long after = 1; after < 60; ++after) {
        CAPTURE(after);
        Problem problem = toy::decay(40, 3);
        std::atomic<long> calls = 0;
        double best_seen = 1e300;
        problem.evaluate = [&, inner = problem.evaluate](auto p, auto r, Eigen::MatrixXd* jacobian) {
            inner(p, r, jacobian);
            if (++calls <= after)
                best_seen = std::min(best_seen, r.squaredNorm());
        };
        Method method;
        method.tolerance = 1e-3; // leaves Levenberg-Marquardt something to do
        method.stop_requested = [&] { return calls >= after; };
        const Fit cut = fit(problem, method);
        in_second_stage = in_second_stage || cut.reason.find("polish: interrupted") != std::string::npos;
        CHECK(cut.objective <= best_seen * (1.0 + 1e-14)); // the last digits are the sum's
        CHECK(calls <= after + 1);                         // one look at the best point
        CHECK((cut.termination == Termination::interrupted || calls < after + 2));
    }
    CHECK(in_second_stage);
}

TEST_CASE("a stop request before the first evaluation") {
    Method method;
    method.stop_requested = [] { return true; };
    const Fit none = fit(toy::decay(), method);
    CHECK(none.termination == Termination::interrupted);
    CHECK(none.evaluations == 0);
    CHECK(none.values == std::vector<double>{1.0, 1.0, 0.1});
    CHECK(std::isinf(none.chi2));
}

TEST_CASE("too few evaluations end as budget without Levenberg-Marquardt") {
    Method method;
    method.max_evaluations = 3;
    method.levenberg_marquardt = false;
    const Fit hasty = fit(toy::decay(40, 3), method);
    CHECK(hasty.termination == Termination::budget);
    CHECK_THAT(hasty.reason, Contains("MAXEVAL_REACHED"));
    method.levenberg_marquardt = true;
    CHECK(fit(toy::decay(40, 3), method).termination == Termination::converged);
}

TEST_CASE("nothing free: the values are looked at") {
    Problem problem = toy::decay(40, 3);
    for (Parameter& p : problem.parameters)
        p.fixed = true;
    const Fit looked = fit(problem, {});
    CHECK(looked.termination == Termination::converged);
    CHECK(looked.values == std::vector<double>{1.0, 1.0, 0.1});
    CHECK(looked.chi2 > 100.0);
    CHECK(report(problem, looked).dof == 40);
}

TEST_CASE("robust losses leave outliers aside") {
    Problem problem = toy::decay(40, 3);
    problem.evaluate = [inner = problem.evaluate](auto p, auto r, Eigen::MatrixXd* jacobian) {
        inner(p, r, jacobian);
        for (const int i : {27, 30, 33, 36})
            r[i] += 60.0;
    };
    const auto far = [&](Loss loss) {
        Method method;
        method.loss = loss;
        const Fit best = fit(problem, method);
        CHECK(best.termination == Termination::converged);
        return std::abs(best.values[2] - 0.5) / 0.04; // standard error of c: about 0.04
    };
    CHECK(far(Loss::squares) > 8.0);
    CHECK(far(Loss::huber) < 4.0);
    CHECK(far(Loss::cauchy) < 2.0);
}

TEST_CASE("the comparison of fits sees the last bit") {
    const Fit one = fit(toy::decay(40, 3), {});
    CHECK(same(one, one));
    Fit other = one;
    other.values[1] = std::nextafter(other.values[1], 10.0);
    CHECK_FALSE(same(one, other));
    other = one;
    other.starts[0].evaluations += 1;
    CHECK_FALSE(same(one, other));
}
