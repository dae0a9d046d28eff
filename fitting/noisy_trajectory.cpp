// Tracks of rods that diffuse (rods/noise.hpp): the likelihood of each row given those before it.
//
// Between rows mean m and covariance P of the poses go by the moments of a normal distribution,
//
//   m' = <f(y)>,   P' = J P + P J^T + 2 diag(D_t, D_t, D_r),   J = <df/dy>,
//
// in which <cos theta> = exp(-P_theta/2) cos m_theta is exact and the turning by wakes and rows is linear
// about m (the extended Kalman filter's step). At a row S = P + sigma^2, and the innovation datum - m is
// normal of covariance S = L L^T: its residuals are L^-1 (m - datum), and L_ii/sigma_i is what log_scales of
// the problem bring in. A start that is data has the variance of its sigmas: its poses are no parameters.

#include "trajectory_run.hpp"

#include "prior_map.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/rods/noise.hpp"
#include "rodwake/rods/separation.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

namespace rodwake::fitting {

namespace {

using Index = Eigen::Index;

/// Mean and covariance of the poses of all rods.
struct Belief {
    Eigen::VectorXd mean;
    Eigen::MatrixXd covariance;
};

struct DiffusionCoefficients {
    double rotational = 0.0, translational = 0.0;
};

double sigma_at(const Trajectory& trajectory, Index component) {
    return component % 3 == 2 ? trajectory.sigma_heading : trajectory.sigma_position;
}

DiffusionCoefficients diffusion_of(std::span<const Role> roles, std::span<const double> values) {
    DiffusionCoefficients out;
    for (std::size_t j = 0; j < roles.size(); ++j)
        if (roles[j].diffusion)
            (*roles[j].diffusion == Role::Diffusion::rotational ? out.rotational : out.translational) =
                values[j];
    return out;
}

/// The moments' equations between two rows in units of the data's errors, so that one tolerance serves all:
/// how far the mean has moved, then the covariance's upper triangle, column by column.
class MomentEquations {
public:
    MomentEquations(const rods::RodModel& model, const DiffusionCoefficients& diffusion,
                    const Trajectory& trajectory)
        : model_(model), box_(trajectory.box), n_(static_cast<Index>(3 * model.rods())), unit_(n_),
          driven_(n_), mean_(n_), rate_(n_), P_(n_, n_), J_(n_, n_), JP_transposed_(n_, n_) {
        for (Index i = 0; i < n_; ++i) {
            unit_[i] = sigma_at(trajectory, i);
            driven_[i] = 2.0 * (i % 3 == 2 ? diffusion.rotational : diffusion.translational);
        }
    }

    /// Moves on by `span`. Throws RunError where the solve fails.
    void foretell(double span, const std::string& name, Belief& belief) {
        begin_ = belief.mean;
        integrate::OdeProblem problem;
        problem.initial_state.assign(static_cast<std::size_t>(n_), 0.0);
        for (Index j = 0; j < n_; ++j)
            for (Index i = 0; i <= j; ++i)
                problem.initial_state.push_back(belief.covariance(i, j) / (unit_[i] * unit_[j]));
        problem.rhs = [this](double, integrate::State y, std::span<double> out) {
            unpack(y);
            const auto size = static_cast<std::size_t>(n_);
            model_.linearise({mean_.data(), size}, {rate_.data(), size}, J_);
            for (Index i = 0; i < n_; i += 3) {
                const double blur = std::exp(-0.5 * P_(i + 2, i + 2));
                for (const Index k : {i, i + 1}) { // places are driven by their own heading alone
                    rate_[k] *= blur;
                    JP_transposed_.col(k) = blur * J_(k, i + 2) * P_.col(i + 2);
                }
                JP_transposed_.col(i + 2).noalias() = P_ * J_.row(i + 2).transpose();
            }
            Eigen::Map<Eigen::VectorXd>(out.data(), n_) = rate_.cwiseQuotient(unit_);
            double* packed = out.data() + n_;
            for (Index j = 0; j < n_; ++j)
                for (Index i = 0; i <= j; ++i)
                    *packed++ = (JP_transposed_(i, j) + JP_transposed_(j, i) + (i == j ? driven_[i] : 0.0)) /
                                (unit_[i] * unit_[j]);
        };
        if (model_.interacting()) // steps may be as long as a row: none passes over an encounter
            problem.step_limit = [this](double, integrate::State y) {
                mean_ = begin_ + Eigen::Map<const Eigen::VectorXd>(y.data(), n_).cwiseProduct(unit_);
                return rods::encounter_step({mean_.data(), static_cast<std::size_t>(n_)}, box_);
            };
        integrate::OdeOptions options;
        options.method = integrate::Method::erk;
        options.rtol = 1e-8, options.atol = 1e-7, options.max_steps = 2000;
        options.initial_step = span / static_cast<double>(steps_);
        const auto end = integrate::solve(problem, options, std::array{span});
        if (!end.status.ok())
            throw RunError(name + ": " + end.status.message());
        steps_ = std::max(1L, end.statistics.steps);
        unpack(end.final_state);
        belief.mean = mean_;
        belief.covariance = P_;
    }

private:
    void unpack(integrate::State y) {
        mean_ = begin_ + Eigen::Map<const Eigen::VectorXd>(y.data(), n_).cwiseProduct(unit_);
        const double* packed = y.data() + n_;
        for (Index j = 0; j < n_; ++j)
            for (Index i = 0; i <= j; ++i)
                P_(i, j) = P_(j, i) = *packed++ * unit_[i] * unit_[j];
    }

    const rods::RodModel& model_;
    rods::Box box_;
    Index n_;
    Eigen::VectorXd unit_, driven_, mean_, rate_, begin_;
    Eigen::MatrixXd P_, J_, JP_transposed_;
    long steps_ = 1; ///< of the last row: as many are tried in the next
};

Belief at_start(const Trajectory& trajectory) {
    const std::vector<double>& start = trajectory.states.front();
    const auto n = static_cast<Index>(start.size());
    Belief belief{Eigen::Map<const Eigen::VectorXd>(start.data(), n), Eigen::MatrixXd::Zero(n, n)};
    for (Index i = 0; i < n; ++i)
        if (is_free(trajectory, static_cast<std::size_t>(i)))
            belief.covariance(i, i) = sigma_at(trajectory, i) * sigma_at(trajectory, i);
    return belief;
}

struct NoisyTrajectories {
    std::vector<Trajectory> all;
    std::vector<Role> roles;
    std::vector<bool> wanted; ///< parameters to differentiate by
    std::size_t data = 0;

    void set_residuals(std::span<const double> p, Eigen::Ref<Eigen::VectorXd> r) const;
    void evaluate(std::span<const double> p, Eigen::Ref<Eigen::VectorXd> r, Eigen::MatrixXd* jacobian) const;
};

// NOLINTNEXTLINE(performance-unnecessary-value-param): an Eigen::Ref is a view
void NoisyTrajectories::set_residuals(std::span<const double> p, Eigen::Ref<Eigen::VectorXd> r) const {
    const DiffusionCoefficients diffusion = diffusion_of(roles, p);
    Index at = 0;
    for (std::size_t k = 0; k < all.size(); ++k) {
        const Trajectory& track = all[k];
        const rods::RodModel model = rods::model_of(rod_problem(track, k, roles, p));
        MomentEquations moments(model, diffusion, track);
        Belief belief = at_start(track);
        const Index n = belief.mean.size();
        for (std::size_t row = 1; row < track.times.size(); ++row, at += n) {
            moments.foretell(track.times[row] - track.times[row - 1], track.name, belief);
            const Eigen::VectorXd innovation =
                Eigen::Map<const Eigen::VectorXd>(track.states[row].data(), n) - belief.mean;
            Eigen::VectorXd variance(n);
            for (Index i = 0; i < n; ++i)
                variance[i] = sigma_at(track, i) * sigma_at(track, i);
            Eigen::MatrixXd S = belief.covariance;
            S.diagonal() += variance;
            const Eigen::LLT<Eigen::MatrixXd> root(S);
            if (root.info() != Eigen::Success)
                throw RunError(track.name + ": the covariance of a row is not positive");
            r.segment(at, n) = -root.matrixL().solve(innovation);
            for (Index i = 0; i < n; ++i) // rounding may leave it a little below 1
                r[static_cast<Index>(data) + at + i] = std::sqrt(
                    std::max(0.0, 1.0 + std::log(std::pow(root.matrixLLT()(i, i), 2) / variance[i])));

            // The row is taken in by Joseph's form, which stays positive.
            const Eigen::MatrixXd gain = root.solve(belief.covariance).transpose(),
                                  rest = Eigen::MatrixXd::Identity(n, n) - gain;
            belief.mean += gain * innovation;
            belief.covariance = (rest * belief.covariance * rest.transpose() +
                                 gain * variance.asDiagonal() * gain.transpose())
                                    .eval();
        }
    }
}

// NOLINTNEXTLINE(performance-unnecessary-value-param): an Eigen::Ref is a view
void NoisyTrajectories::evaluate(std::span<const double> p, Eigen::Ref<Eigen::VectorXd> r,
                                 Eigen::MatrixXd* jacobian) const {
    const DiffusionCoefficients diffusion = diffusion_of(roles, p);
    if (!(diffusion.rotational >= 0.0 && diffusion.translational >= 0.0))
        throw RunError("D_r and D_t must not be negative");
    set_residuals(p, r);
    if (!jacobian)
        return;

    // Central differences, on the scale of what a parameter of this kind is: 1e-6 of the slope are left. The
    // scale of a diffusion coefficient adds a variance of a tenth of sigma's from row to row.
    jacobian->setZero();
    std::vector<double> moved(p.begin(), p.end());
    for (std::size_t j = 0; j < p.size(); ++j) {
        if (!wanted[j])
            continue;
        double scale = 0.1;
        if (roles[j].diffusion) {
            const Trajectory& track = all.front();
            const double sigma = *roles[j].diffusion == Role::Diffusion::rotational ? track.sigma_heading
                                                                                    : track.sigma_position;
            scale = 0.05 * sigma * sigma * static_cast<double>(track.times.size()) /
                    (track.times.back() - track.times.front());
        }
        const bool positive = roles[j].physical && *roles[j].physical >= rods::Parameter::eta &&
                              *roles[j].physical <= rods::Parameter::xi;
        const double h = 2e-3 * (positive ? std::abs(p[j]) : std::max(std::abs(p[j]), scale));
        Eigen::VectorXd low(static_cast<Index>(2 * data)), high = low;
        moved[j] = p[j] + h;
        set_residuals(moved, high);
        moved[j] = p[j] - h;
        set_residuals(moved, low);
        moved[j] = p[j];
        jacobian->col(static_cast<Index>(j)) = (high - low) / (2.0 * h);
    }
}

} // namespace

Problem noisy_problem(const std::vector<Trajectory>& trajectories, std::vector<Parameter> parameters) {
    for (const Trajectory& trajectory : trajectories) {
        if (trajectory.contact_time)
            throw InputError(trajectory.name +
                             ": contact_time is no datum of rods that diffuse (D_r, D_t): leave it "
                             "out, or fit without them");
        if (trajectory.independent < 1.0)
            throw InputError(trajectory.name +
                             ": independent_time and the rods' own noise (D_r, D_t) both explain why "
                             "neighbouring rows go together: leave one of them out");
        if (trajectory.times.size() < 2)
            throw InputError(trajectory.name + ": a single row has no information on rods that diffuse");
    }
    const auto noisy = std::make_shared<NoisyTrajectories>();
    noisy->all = trajectories;
    for (const Parameter& p : parameters) {
        noisy->roles.push_back(role_of(p.name, trajectories));
        noisy->wanted.push_back(!p.fixed);
    }

    // x, y and heading of each rod are series of residuals; sigmas are by datum.
    Problem problem;
    problem.parameters = std::move(parameters);
    for (const Trajectory& track : trajectories) {
        const std::size_t n = track.states.front().size(), rows = track.times.size() - 1;
        for (std::size_t i = 0; i < n; ++i) {
            Series& s =
                problem.series.emplace_back(Series{track.name, i % 3 == 2 ? "headings" : "positions", {}});
            for (std::size_t row = 0; row < rows; ++row)
                s.residuals.push_back(noisy->data + row * n + i);
        }
        for (std::size_t k = 0; k < rows * n; ++k)
            problem.log_sigma.push_back(std::log(sigma_at(track, static_cast<Index>(k % n))));
        noisy->data += rows * n;
    }
    problem.residuals = 2 * noisy->data;
    problem.log_scales = noisy->data;
    problem.log_sigma.resize(2 * noisy->data,
                             -log_root_2pi - 0.5); // 1 + 2 ln(s/sigma) becomes the logarithm of s
    // NOLINTNEXTLINE(performance-unnecessary-value-param)
    problem.evaluate = [noisy](std::span<const double> p, Eigen::Ref<Eigen::VectorXd> r,
                               Eigen::MatrixXd* jacobian) { noisy->evaluate(p, r, jacobian); };
    problem.residual_name = [noisy](std::size_t i) -> std::string {
        static constexpr const char* names[] = {"x", "y", "theta"};
        i %= noisy->data;
        for (const Trajectory& track : noisy->all) {
            const std::size_t n = track.states.front().size(), own = (track.times.size() - 1) * n;
            if (i < own)
                return fmt::format("{} {}{}", row_name(track, i / n + 1), names[i % n % 3], i % n / 3);
            i -= own;
        }
        return "";
    };
    return problem;
}

std::vector<std::vector<double>> drawn_states(const TrajectoryModel& model, const Trajectory& trajectory,
                                              std::size_t index, const std::vector<Parameter>& parameters,
                                              std::span<const double> values, std::uint64_t seed,
                                              std::uint32_t run) {
    if (std::ranges::none_of(parameters, rods::is_noise, &Parameter::name))
        return predict(model, trajectory, index, parameters, values);
    std::vector<Role> roles;
    roles.reserve(parameters.size());
    for (const Parameter& p : parameters)
        roles.push_back(role_of(p.name, std::vector<Trajectory>(index + 1, trajectory)));
    rods::RodProblem problem = rod_problem(trajectory, index, roles, values);
    for (const double t : trajectory.times)
        problem.output_times.push_back(t - trajectory.times.front());
    const DiffusionCoefficients diffusion = diffusion_of(roles, values);
    const auto found = rods::simulate(problem, {},
                                      {diffusion.rotational, diffusion.translational,
                                       rods::suitable_time_step(problem, diffusion.rotational), seed},
                                      run);
    std::vector<std::vector<double>> states = found.solution.states;
    if (states.size() < trajectory.times.size()) // rods that met stay there, as in predict()
        states.resize(trajectory.times.size(), found.solution.final_state);
    return states;
}

std::vector<std::vector<double>> noise_variance(const Trajectory& trajectory, std::size_t index,
                                                const std::vector<Parameter>& parameters,
                                                std::span<const double> values) {
    std::vector<Role> roles;
    roles.reserve(parameters.size());
    for (const Parameter& p : parameters)
        roles.push_back(role_of(p.name, {trajectory}));
    std::vector<std::vector<double>> out(trajectory.times.size(),
                                         std::vector<double>(trajectory.states.front().size()));
    const DiffusionCoefficients diffusion = diffusion_of(roles, values);
    if (diffusion.rotational == 0.0 && diffusion.translational == 0.0)
        return out;
    const rods::RodModel model = rods::model_of(rod_problem(trajectory, index, roles, values));
    MomentEquations moments(model, diffusion, trajectory);
    Belief belief = at_start(trajectory);
    for (std::size_t row = 0; row < out.size(); ++row) {
        if (row > 0)
            moments.foretell(trajectory.times[row] - trajectory.times[row - 1], trajectory.name, belief);
        std::ranges::copy(belief.covariance.diagonal(), out[row].begin());
    }
    return out;
}

} // namespace rodwake::fitting
