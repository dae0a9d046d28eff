// The equations of motion: analytic Jacobian, symmetries, bases, and what is not evaluated.

#include "rods/interaction.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/rng.hpp"
#include "rodwake/elastic/field.hpp"
#include "rodwake/rods/simulate.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

using namespace rodwake;

namespace {

std::vector<double> random_state(RandomStream& random, std::size_t rods) {
    std::vector<double> y;
    for (std::size_t i = 0; i < rods; ++i)
        y.insert(y.end(), {random.uniform(-4, 4), random.uniform(-4, 4), random.uniform(-4, 4)});
    return y;
}

rods::RodModel random_model(RandomStream& random, std::size_t rods) {
    const rods::Couplings couplings{random.uniform(-5, 5), random.uniform(-5, 5), random.uniform(-5, 5)};
    return {elastic::exact_field({random.uniform(-0.5, 4.0), random.log_uniform(0.1, 10.0)}), couplings,
            rods};
}

/// Fourth-order central difference of the right-hand side by component j.
std::vector<double> difference(const rods::RodModel& model, const std::vector<double>& y, std::size_t j,
                               double h) {
    const auto at = [&](double shift) {
        std::vector<double> moved = y, ydot(y.size());
        moved[j] += shift;
        model.rhs(moved, ydot);
        return ydot;
    };
    const auto p1 = at(h), m1 = at(-h), p2 = at(2 * h), m2 = at(-2 * h);
    std::vector<double> d(y.size());
    for (std::size_t i = 0; i < y.size(); ++i)
        d[i] = (8.0 * (p1[i] - m1[i]) - (p2[i] - m2[i])) / (12.0 * h);
    return d;
}

double worst_jacobian_error(const rods::RodModel& model, const std::vector<double>& y,
                            const Eigen::MatrixXd& jacobian) {
    double worst = 0.0;
    for (std::size_t j = 0; j < y.size(); ++j) {
        const auto column = difference(model, y, j, 1e-3);
        for (std::size_t i = 0; i < y.size(); ++i)
            worst = std::max(worst, std::abs(jacobian(Eigen::Index(i), Eigen::Index(j)) - column[i]));
    }
    return worst / (1.0 + jacobian.cwiseAbs().maxCoeff());
}

/// The reference states of this file keep rods at least this far apart, so that the differences resolve the
/// field.
bool well_separated(const std::vector<double>& y) { return rods::closest_pair(y).distance > 0.5; }

} // namespace

TEST_CASE("the Jacobian matches finite differences at random states") {
    RandomStream random(11);
    int tried = 0;
    while (tried < 200) {
        const std::size_t rods = 2 + tried % 4;
        const auto y = random_state(random, rods);
        if (!well_separated(y))
            continue;
        ++tried;
        const auto model = random_model(random, rods);
        Eigen::MatrixXd jacobian(3 * rods, 3 * rods);
        model.jacobian(y, jacobian);
        // h = 1e-3 against a scale of 0.5: truncation (h/0.5)^4/5 ~ 3e-12 of a fifth derivative, rounding
        // 1e-13/h
        CHECK(worst_jacobian_error(model, y, jacobian) < 1e-7);
        jacobian(2, 0) += 1e-3 * (1.0 + jacobian.cwiseAbs().maxCoeff()); // and the comparison can fail
        CHECK(worst_jacobian_error(model, y, jacobian) > 1e-7);
    }
}

TEST_CASE("slope and Jacobian at once are those that are asked for one by one") {
    RandomStream random(12);
    for (const rods::Box box : {rods::Box{}, rods::Box{9.0}})
        for (const double gamma_rows : {0.0, 0.3})
            for (const double kappa : {0.0, 2.0}) {
                const rods::RodModel model(elastic::exact_field({1.3, 2.0}, box), {kappa, kappa, 0.5 * kappa},
                                           2, {gamma_rows, 0.2});
                const auto y = random_state(random, 2);
                std::vector<double> slope(6), at_once(6, 7.0);
                Eigen::MatrixXd jacobian(6, 6), also = Eigen::MatrixXd::Constant(6, 6, 7.0);
                model.rhs(y, slope);
                model.jacobian(y, jacobian);
                model.linearise(y, at_once, also);
                CHECK(also == jacobian);
                for (std::size_t i = 0; i < 6; ++i) // the sums of rhs() are those of lanes
                    CHECK(at_once[i] == Approx(slope[i]).epsilon(1e-12).margin(1e-12));
            }
}

TEST_CASE("in a periodic box too, with the rods' own images") {
    RandomStream random(13);
    int tried = 0;
    while (tried < 20) {
        const std::size_t rods = 1 + tried % 3;
        const auto y = random_state(random, rods);
        const double box = random.uniform(2.0, 12.0);
        if (rods > 1 && !(rods::closest_pair(y, box).distance > 0.5))
            continue;
        ++tried;
        const rods::Couplings couplings{random.uniform(-5, 5), random.uniform(-5, 5), random.uniform(-5, 5)};
        const rods::RodModel model(
            elastic::exact_field({random.uniform(0.0, 4.0), random.log_uniform(0.3, 10.0)}, box), couplings,
            rods);
        Eigen::MatrixXd jacobian(3 * rods, 3 * rods);
        model.jacobian(y, jacobian);
        CAPTURE(box, rods);
        // as above, and the field is good to 1e-10 of its largest value at that distance, over h = 1e-3
        CHECK(worst_jacobian_error(model, y, jacobian) < 1e-6);
        jacobian(2, 2) += 1e-3 * (1.0 + jacobian.cwiseAbs().maxCoeff());
        CHECK(worst_jacobian_error(model, y, jacobian) > 1e-6);
    }
}

TEST_CASE("the turning rate is z.[n x (kappa eps.n + gamma1 lap u + gamma2 grad div u)] in the lab frame") {
    RandomStream random(12);
    for (int k = 0; k < 50; ++k) {
        const elastic::Medium medium{random.uniform(0, 3), random.log_uniform(0.1, 10)};
        const rods::Couplings c{random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 2)};
        const auto y = random_state(random, 2);
        std::vector<double> ydot(6);
        rods::RodModel(elastic::exact_field(medium), c, 2).rhs(y, ydot);
        const auto f = elastic::lab_field(elastic::Field(medium), {y[3], y[4], y[5]}, y[0], y[1],
                                          {.strain = true, .polar = true});
        const double nx = std::cos(y[2]), ny = std::sin(y[2]);
        const double vx = c.kappa * (f.strain.xx * nx + f.strain.xy * ny) + c.gamma1 * f.laplacian.x +
                          c.gamma2 * f.gradient_of_trace.x;
        const double vy = c.kappa * (f.strain.xy * nx + f.strain.yy * ny) + c.gamma1 * f.laplacian.y +
                          c.gamma2 * f.gradient_of_trace.y;
        const double scale = std::abs(nx * vy) + std::abs(ny * vx);
        CHECK(ydot[2] ==
              Approx(nx * vy - ny * vx).margin(1e-13 * scale)); // two rotations and a dozen products
    }
}

TEST_CASE("the divergence basis is the laplacian one with gamma1/2 and gamma2 + gamma1/2") {
    // div eps = (lap u + grad div u)/2 and grad tr eps = grad div u, so both must turn a rod alike.
    const auto c = rods::from_divergence_basis({0.3, 1.5, -0.7});
    CHECK(c.kappa == 0.3);
    CHECK(c.gamma1 == 0.75);
    CHECK(c.gamma2 == Approx(0.05).epsilon(1e-15)); // one rounding
}

TEST_CASE("mirror images move as mirror images") {
    RandomStream random(13);
    const auto model = random_model(random, 3);
    auto y = random_state(random, 3);
    std::vector<double> ydot(9), mirrored(9);
    model.rhs(y, ydot);
    for (std::size_t i = 0; i < 3; ++i) {
        y[3 * i + 1] *= -1.0;
        y[3 * i + 2] *= -1.0;
    }
    model.rhs(y, mirrored);
    for (std::size_t i = 0; i < 9; ++i)
        CHECK(mirrored[i] == (i % 3 == 0 ? ydot[i] : -ydot[i])); // sign symmetry holds to the bit
}

TEST_CASE("terms that a scene leaves out are not evaluated") {
    CHECK_FALSE(rods::request_of({.kappa = 1.0}, false).polar);
    CHECK_FALSE(rods::request_of({.kappa = 1.0}, false).gradients);
    CHECK_FALSE(rods::request_of({.gamma1 = 1.0}, false).strain);
    CHECK_FALSE(rods::request_of({.gamma2 = 1.0}, true).dipole);
    CHECK_FALSE(rods::RodModel(elastic::exact_field({}), {.kappa = 1.0}, 1).interacting());
    CHECK_FALSE(rods::RodModel(elastic::exact_field({}), {}, 5).interacting());
    CHECK_FALSE(rods::RodModel(nullptr, {.kappa = 1.0}, 5).interacting());
    CHECK(rods::RodModel(elastic::exact_field({}), {.kappa = 1.0}, 2).interacting());
}

TEST_CASE("a single rod walks straight") {
    const rods::RodProblem problem{elastic::Medium{}, {.kappa = 3.0}, {{1.0, 2.0, 0.5}}, 10.0, {}, {}};
    const auto result = rods::simulate(problem, {});
    CHECK(result.solution.final_state[0] ==
          Approx(1.0 + 10.0 * std::cos(0.5)).epsilon(1e-13)); // constant rates
    CHECK(result.solution.final_state[2] == 0.5);
    CHECK(result.outcome.ending == Ending::undecided);
    CHECK(std::isinf(result.outcome.min_separation));
}

TEST_CASE("components are named as users know them") {
    CHECK(rods::RodModel::component_name(0) == "rods[0].x");
    CHECK(rods::RodModel::component_name(10) == "rods[3].y");
    CHECK(rods::RodModel::component_name(11) == "rods[3].theta");
}
