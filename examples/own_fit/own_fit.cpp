// Least squares for a model of your own: how a wake decays with the distance, a exp(-x/b) + c, with errors.
// Data made up from a = 2, b = 5, c = 0.3 and a ripple of 0.01 that the model does not know.

#include <rodwake/fitting/report.hpp>

#include <cmath>
#include <cstdio>

using namespace rodwake::fitting;

namespace {

constexpr int points = 40;
constexpr double sigma = 0.01;

double place(Eigen::Index i) { return 0.5 * static_cast<double>(i); }

double measured(Eigen::Index i) {
    return 2.0 * std::exp(-place(i) / 5.0) + 0.3 + sigma * std::cos(7.0 * static_cast<double>(i));
}

void residuals(std::span<const double> p, Eigen::Ref<Eigen::VectorXd> r, Eigen::MatrixXd* jacobian) {
    for (Eigen::Index i = 0; i < points; ++i) {
        const double decay = std::exp(-place(i) / p[1]);
        r[i] = (p[0] * decay + p[2] - measured(i)) / sigma;
        if (jacobian)
            jacobian->row(i) << decay / sigma, p[0] * decay * place(i) / (p[1] * p[1]) / sigma, 1.0 / sigma;
    }
}

} // namespace

int main() {
    Problem problem;
    problem.parameters = {
        {.name = "a", .start = 1.0},
        {.name = "b", .start = 1.0, .lower = 1e-3, .upper = 1e3, .transform = Transform::log},
        {.name = "c", .start = 0.0}};
    problem.residuals = points;
    problem.evaluate = residuals;
    Method method;
    method.algorithm = Algorithm::slsqp;
    method.starts = 5;
    const Fit found = fit(problem, method);
    const Report said = report(problem, found);
    std::puts(to_text(problem, found, said).c_str());
    std::printf("pull of b    %.3f standard errors from 5\n",
                (found.values[1] - 5.0) / said.estimates[1].standard_error);
    return found.termination == Termination::failed ? 1 : 0;
}
