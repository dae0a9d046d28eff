#include "interaction.hpp"
#include "rodwake/rods/simulate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace rodwake::rods {

namespace {

using integrate::State;

constexpr double relaxation = 1.0; ///< b of the header, mu v0/f

std::size_t stride_of(Formulation form) {
    switch (form) {
    case Formulation::angle:
        return 3;
    case Formulation::director:
        return 4;
    case Formulation::dae:
        break;
    }
    return 5;
}

/// Poses with headings in (-pi, pi], for functions to which whole turns mean nothing.
std::vector<double> poses_of(State state, std::size_t stride) {
    std::vector<double> poses(state.size() / stride * 3);
    for (std::size_t a = 0; a < state.size() / stride; ++a) {
        const State rod = state.subspan(a * stride, stride);
        poses[3 * a] = rod[0];
        poses[3 * a + 1] = rod[1];
        poses[3 * a + 2] = std::atan2(rod[3], rod[2]);
    }
    return poses;
}

Direction unit(State rod) {
    const double length = std::hypot(rod[2], rod[3]);
    return {rod[2] / length, rod[3] / length};
}

/// The equations of one form, of which the problem's functions are made.
struct Directors {
    RodModel model;
    Couplings couplings;
    std::size_t stride;

    std::vector<elastic::FieldValues> wakes(State state) const {
        std::vector<elastic::FieldValues> sums(model.rods());
        model.wakes(poses_of(state, stride), sums);
        return sums;
    }
    double rows_rate(Direction n) const {
        return model.rows().any() ? model.rows().rate(std::atan2(n.sine, n.cosine)) : 0.0;
    }
    /// Rates of the poses that contacts of bodies add.
    std::vector<double> by_contacts(State state) const {
        std::vector<double> rates(3 * model.rods(), 0.0);
        if (model.bodies().any())
            model.bodies().add_rates(poses_of(state, stride), rates);
        return rates;
    }
    void rhs(State state, std::span<double> rate) const;
    void rhs_with_multipliers(State state, std::span<double> rate) const;
    void jacobian(State state, Eigen::Ref<Eigen::MatrixXd> jacobian) const;
};

void Directors::rhs(State state, std::span<double> rate) const {
    const auto sums = wakes(state);
    const std::vector<double> pushed = by_contacts(state);
    for (std::size_t a = 0; a < model.rods(); ++a) {
        const State rod = state.subspan(4 * a, 4);
        const Direction n = unit(rod);
        const double turning =
            turning_rate(sums[a], couplings, {n.cosine, n.sine}) + rows_rate(n) + pushed[3 * a + 2];
        rate[4 * a] = rod[2] + pushed[3 * a];
        rate[4 * a + 1] = rod[3] + pushed[3 * a + 1];
        rate[4 * a + 2] = -turning * rod[3];
        rate[4 * a + 3] = turning * rod[2];
    }
}

void Directors::rhs_with_multipliers(State state, std::span<double> rate) const {
    const auto sums = wakes(state);
    const std::vector<double> pushed = by_contacts(state);
    for (std::size_t a = 0; a < model.rods(); ++a) {
        const State rod = state.subspan(5 * a, 5);
        const double nx = rod[2], ny = rod[3], multiplier = rod[4], square = nx * nx + ny * ny;
        const double turning = rows_rate(unit(rod)) + pushed[3 * a + 2];
        elastic::Vector h = drive(sums[a], couplings, {nx, ny});
        h = {h.x - turning * ny, h.y + turning * nx};
        rate[5 * a] = nx + pushed[3 * a];
        rate[5 * a + 1] = ny + pushed[3 * a + 1];
        rate[5 * a + 2] = h.x + multiplier * nx;
        rate[5 * a + 3] = h.y + multiplier * ny;
        rate[5 * a + 4] = nx * h.x + ny * h.y + multiplier * square + 0.5 * relaxation * (square - 1.0);
    }
}

/// From that of the angles: d theta/d n = (-n_y, n_x)/|n|^2.
void Directors::jacobian(State state, Eigen::Ref<Eigen::MatrixXd> jacobian) const {
    const auto rods = static_cast<Eigen::Index>(model.rods());
    const std::vector<double> poses = poses_of(state, stride);
    Eigen::MatrixXd of_angles = Eigen::MatrixXd::Zero(3 * rods, 3 * rods), pushed = of_angles;
    std::vector<double> rates(poses.size());
    model.jacobian(poses, of_angles);
    model.rhs(poses, rates);
    model.bodies().add_jacobian(poses, pushed);
    const auto director = [&](Eigen::Index a) {
        return Eigen::Vector2d(state[static_cast<std::size_t>(4 * a + 2)],
                               state[static_cast<std::size_t>(4 * a + 3)]);
    };
    for (Eigen::Index a = 0; a < rods; ++a) {
        const Eigen::Vector2d normal(-director(a).y(), director(a).x());
        const double turning = rates[static_cast<std::size_t>(3 * a + 2)];
        jacobian.block<2, 2>(4 * a, 4 * a + 2).setIdentity();
        for (Eigen::Index b = 0; b < rods; ++b) {
            const Eigen::Vector2d nb = director(b);
            const Eigen::RowVector2d heading_by_n = Eigen::RowVector2d(-nb.y(), nb.x()) / nb.squaredNorm();
            jacobian.block<2, 2>(4 * a + 2, 4 * b) = normal * of_angles.block<1, 2>(3 * a + 2, 3 * b);
            jacobian.block<2, 2>(4 * a + 2, 4 * b + 2) =
                normal * (of_angles(3 * a + 2, 3 * b + 2) * heading_by_n);
            jacobian.block<2, 2>(4 * a, 4 * b) += pushed.block<2, 2>(3 * a, 3 * b);
            jacobian.block<2, 2>(4 * a, 4 * b + 2) += pushed.block<2, 1>(3 * a, 3 * b + 2) * heading_by_n;
        }
        jacobian(4 * a + 2, 4 * a + 3) -= turning;
        jacobian(4 * a + 3, 4 * a + 2) += turning;
    }
}

} // namespace

std::size_t state_size(Formulation form, std::size_t rods) { return rods * stride_of(form); }

std::vector<double> to_form(Formulation form, State poses) {
    if (form == Formulation::angle)
        return {poses.begin(), poses.end()};
    std::vector<double> state;
    for (std::size_t i = 0; i < poses.size(); i += 3) {
        state.insert(state.end(), {poses[i], poses[i + 1], std::cos(poses[i + 2]), std::sin(poses[i + 2])});
        if (form == Formulation::dae)
            state.push_back(0.0);
    }
    return state;
}

std::vector<double> to_poses(Formulation form, State state, std::span<const double> near) {
    if (form == Formulation::angle)
        return {state.begin(), state.end()};
    std::vector<double> poses = poses_of(state, stride_of(form));
    for (std::size_t a = 0; a < near.size(); ++a)
        poses[3 * a + 2] = near[a] + std::remainder(poses[3 * a + 2] - near[a], 2.0 * std::numbers::pi);
    return poses;
}

integrate::OdeProblem to_ode(const RodProblem& problem, Formulation form) {
    integrate::OdeProblem ode = to_ode(problem);
    if (form == Formulation::angle)
        return ode;
    const std::size_t stride = stride_of(form);
    const auto rods =
        std::make_shared<const Directors>(Directors{model_of(problem), problem.couplings, stride});
    ode.initial_state = to_form(form, ode.initial_state);
    ode.jacobian = nullptr;
    if (form == Formulation::director) {
        ode.rhs = [rods](double, State y, std::span<double> rate) { rods->rhs(y, rate); };
        if (rods->model.has_jacobian())
            // NOLINTNEXTLINE(performance-unnecessary-value-param): an Eigen::Ref is a view
            ode.jacobian = [rods](double, State y, Eigen::Ref<Eigen::MatrixXd> j) { rods->jacobian(y, j); };
    } else {
        ode.rhs = [rods](double, State y, std::span<double> f) { rods->rhs_with_multipliers(y, f); };
        // The multipliers of directors of length 1: their equation is linear. Left to the solver, which
        // judges them by the tolerance of a guess, they would not be found where couplings are strong or rods
        // close.
        std::vector<double> rate(ode.initial_state.size());
        rods->rhs_with_multipliers(ode.initial_state, rate);
        for (std::size_t i = 4; i < rate.size(); i += 5)
            ode.initial_state[i] -= rate[i];
        for (std::size_t i = 0; i < ode.initial_state.size(); ++i)
            ode.algebraic.push_back(i % stride == 4);
    }
    ode.project = [stride](std::span<double> y) { // all directors back on the unit circle
        double drift = 0.0;
        for (std::size_t i = 2; i < y.size(); i += stride) {
            const double length = std::hypot(y[i], y[i + 1]);
            drift = std::max(drift, std::abs(length - 1.0));
            y[i] /= length;
            y[i + 1] /= length;
        }
        return drift;
    };
    ode.component_name = [stride](std::size_t i) {
        static constexpr std::array names = {"x", "y", "n_x", "n_y", "lambda"};
        return "rods[" + std::to_string(i / stride) + "]." + names[i % stride];
    };

    // Events and step limits see poses.
    for (integrate::Event& event : ode.events) {
        event.value = [value = event.value, stride](double t, State y) {
            return value(t, poses_of(y, stride));
        };
        event.candidate_time = [candidate = event.candidate_time, stride](const integrate::Step& step) {
            const auto before = poses_of(step.state_before, stride), after = poses_of(step.state, stride);
            return candidate({step.time_before, step.time, before, after});
        };
    }
    if (ode.step_limit)
        ode.step_limit = [limit = ode.step_limit, stride](double t, State y) {
            return limit(t, poses_of(y, stride));
        };
    return ode;
}

std::string to_string(Formulation form) {
    switch (form) {
    case Formulation::angle:
        return "angle";
    case Formulation::director:
        return "director";
    case Formulation::dae:
        break;
    }
    return "dae";
}

} // namespace rodwake::rods
