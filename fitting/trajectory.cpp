#include "rodwake/fitting/trajectory.hpp"

#include "rodwake/core/box_sides.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/rods/separation.hpp"
#include "trajectory_run.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <memory>

namespace rodwake::fitting {

namespace {

using Row = Eigen::Index;

/// The residuals of a trajectory in order: what is free of the first row, x, y, heading of each rod in each
/// row after it, the time of contact.
struct ResidualLayout {
    std::size_t start, rows, contact, count;

    explicit ResidualLayout(const Trajectory& trajectory)
        : start(trajectory.states.front().size() / (trajectory.free_start ? 1 : 3) *
                (is_free(trajectory, 2) ? 1 : 0)),
          rows((trajectory.times.size() - 1) * trajectory.states.front().size()),
          contact(trajectory.contact_time ? 1 : 0), count(start + rows + contact) {}
};

double sigma_of(const Trajectory& trajectory, std::size_t component) {
    return (component % 3 == 2 ? trajectory.sigma_heading : trajectory.sigma_position) /
           std::sqrt(trajectory.independent);
}

struct Trajectories {
    integrate::OdeOptions options;
    std::vector<Trajectory> all;
    std::vector<Role> roles;
    std::vector<bool> wanted; ///< parameters to differentiate by

    void evaluate(std::span<const double> p, Eigen::Ref<Eigen::VectorXd> r, Eigen::MatrixXd* jacobian) const;
    std::string residual_name(std::size_t i) const;
};

// NOLINTNEXTLINE(performance-unnecessary-value-param): an Eigen::Ref is a view
void Trajectories::evaluate(std::span<const double> p, Eigen::Ref<Eigen::VectorXd> r,
                            Eigen::MatrixXd* jacobian) const {
    Row at = 0;
    for (std::size_t k = 0; k < all.size(); ++k) {
        const Trajectory& track = all[k];
        const ModelRun run = run_model(options, track, k, roles, p, jacobian ? &wanted : nullptr);
        const bool slopes = jacobian && !run.derivatives.empty();
        for (std::size_t row = 0; row < track.states.size(); ++row)
            for (std::size_t i = 0; i < track.states[row].size(); ++i) {
                if (row == 0 && !is_free(track, i))
                    continue;
                const auto component = static_cast<Row>(i);
                r[at] = (run.states[row][component] - track.states[row][i]) / sigma_of(track, i);
                if (slopes)
                    jacobian->row(at) = run.derivatives[row].row(component) / sigma_of(track, i);
                else if (jacobian)
                    jacobian->row(at).setZero();
                ++at;
            }
        if (!track.contact_time)
            continue;
        r[at] = (run.contact_time - (*track.contact_time - track.times.front())) / track.sigma_contact;
        if (slopes)
            jacobian->row(at) = run.contact_time_by_parameter.transpose() / track.sigma_contact;
        else if (jacobian)
            jacobian->row(at).setZero();
        ++at;
    }
}

std::string Trajectories::residual_name(std::size_t i) const {
    static constexpr const char* names[] = {"x", "y", "theta"};
    for (const Trajectory& track : all) {
        const ResidualLayout size(track);
        if (i >= size.count) {
            i -= size.count;
            continue;
        }
        if (i < size.start) {
            const std::size_t of_row = track.free_start ? i : 3 * i + 2;
            return fmt::format("{} {}{}", row_name(track, 0), names[of_row % 3], of_row / 3);
        }
        const std::size_t in_rows = i - size.start, n = track.states.front().size(), component = in_rows % n;
        return in_rows >= size.rows ? track.name + " contact time"
                                    : fmt::format("{} {}{}", row_name(track, in_rows / n + 1),
                                                  names[component % 3], component / 3);
    }
    return fmt::format("residual {} beyond the last", i);
}

/// Number, sigmas, series and independence of the residuals.
void describe_residuals(const std::vector<Trajectory>& trajectories, Problem& problem) {
    double values = 0.0;
    for (const Trajectory& track : trajectories) {
        // x, y and heading of each rod are series; a time of contact stands alone.
        const ResidualLayout size(track);
        const std::size_t n = track.states.front().size(), first = problem.residuals;
        for (std::size_t component = 0; component < n; ++component) {
            Series series{track.name, component % 3 == 2 ? "headings" : "positions", {}};
            if (is_free(track, component))
                series.residuals.push_back(first + (track.free_start ? component : component / 3));
            for (std::size_t row = 0; row < size.rows / n; ++row)
                series.residuals.push_back(first + size.start + row * n + component);
            problem.series.push_back(std::move(series));
        }
        for (std::size_t row = 0; row < track.states.size(); ++row)
            for (std::size_t i = 0; i < n; ++i)
                if (row > 0 || is_free(track, i))
                    problem.log_sigma.push_back(std::log(sigma_of(track, i)));
        if (track.contact_time) {
            problem.series.push_back({track.name, "contact time", {first + size.start + size.rows}});
            problem.log_sigma.push_back(std::log(track.sigma_contact));
        }
        problem.residuals += size.count;

        // The share of independent values is a mean over the residuals; a time of contact counts in full.
        values += static_cast<double>(size.contact) +
                  track.independent * static_cast<double>(size.count - size.contact);
    }
    problem.independent = values / static_cast<double>(problem.residuals);
}

} // namespace

integrate::OdeOptions trajectory_ode_options() {
    integrate::OdeOptions options;
    options.rtol = 1e-10;
    options.atol = 1e-12;
    options.max_steps = 50000;
    return options;
}

std::vector<std::string> trajectory_parameter_names() {
    std::vector<std::string> names;
    for (const rods::Coupling& coupling : rods::coupling_list)
        names.emplace_back(coupling.name);
    for (const rods::OtherTurning& turning : rods::other_turning)
        names.emplace_back(turning.name);
    names.insert(names.end(), {"eta", "xi", "alpha", "stall_overlap", "mobility_ratio", "D_r", "D_t"});
    return names;
}

Problem trajectory_problem(const TrajectoryModel& model, const std::vector<Trajectory>& trajectories,
                           std::vector<Parameter> parameters) {
    check_trajectories(trajectories);
    check_trajectory_parameters(parameters);
    const bool bodies = std::ranges::any_of(trajectories, [](const auto& t) { return t.bodies.any(); });
    for (const Parameter& p : parameters)
        if (!bodies && (p.name == "stall_overlap" || p.name == "mobility_ratio"))
            throw InputError(fmt::format("fit of trajectories: {} needs rods with bodies", p.name));
        else if (bodies && rods::is_noise(p.name))
            throw InputError(
                fmt::format("fit of trajectories: {} of rods with bodies cannot be fitted: their "
                            "contacts are not linear in what noise moves them",
                            p.name));
    if (std::ranges::any_of(parameters, rods::is_noise, &Parameter::name))
        return noisy_problem(trajectories, std::move(parameters));
    if (model.ode.method == integrate::Method::erk)
        throw InputError("fit of trajectories: method erk has no sensitivities; use adams or, for stiff "
                         "couplings, bdf");

    // Components of free starts are parameters.
    for (std::size_t k = 0; k < trajectories.size(); ++k) {
        const std::vector<double>& start = trajectories[k].states.front();
        for (std::size_t i = 0; i < start.size(); ++i) {
            const std::string name = pose_name(k, i / 3, i % 3);
            if (!is_free(trajectories[k], i) ||
                std::ranges::find(parameters, name, &Parameter::name) != parameters.end())
                continue;
            Parameter pose;
            pose.name = name;
            pose.start = start[i];
            pose.scale = 0.1; // rad, f/mu: chosen from the start it would be 0 for a rod along x
            pose.spreads = false;
            parameters.push_back(pose);
        }
    }
    Trajectories all{model.ode, trajectories, {}, {}};
    for (const Parameter& p : parameters) {
        all.roles.push_back(role_of(p.name, trajectories));
        all.wanted.push_back(!p.fixed);
    }
    Problem problem;
    problem.parameters = std::move(parameters);
    describe_residuals(trajectories, problem);
    const auto shared = std::make_shared<const Trajectories>(std::move(all));
    // NOLINTNEXTLINE(performance-unnecessary-value-param)
    problem.evaluate = [shared](std::span<const double> p, Eigen::Ref<Eigen::VectorXd> r,
                                Eigen::MatrixXd* jacobian) { shared->evaluate(p, r, jacobian); };
    problem.residual_name = [shared](std::size_t i) { return shared->residual_name(i); };
    const auto free = static_cast<std::size_t>(std::ranges::count_if(problem.parameters, &Parameter::free));
    if (problem.residuals < free)
        throw InputError(
            fmt::format("fit of trajectories: {} data cannot fix {} free parameters; fix some of "
                        "them or give more rows",
                        problem.residuals, free));
    return problem;
}

std::vector<std::vector<double>> predict(const TrajectoryModel& model, const Trajectory& trajectory,
                                         std::size_t index, const std::vector<Parameter>& parameters,
                                         std::span<const double> values) {
    // Starts of other trajectories are not this one's: only their names are known here.
    std::vector<Trajectory> all(index + 1);
    all[index] = trajectory;
    std::vector<Role> roles;
    std::vector<double> used;
    for (std::size_t j = 0; j < parameters.size(); ++j) {
        const std::string& name = parameters[j].name;
        if (is_start_pose(name) && !name.substr(name.find('.')).starts_with(fmt::format(".{}.", index)))
            continue;
        roles.push_back(role_of(name, all));
        used.push_back(values[j]);
    }
    std::vector<std::vector<double>> states;
    for (const Eigen::VectorXd& state : run_model(model.ode, trajectory, index, roles, used, nullptr).states)
        states.emplace_back(state.begin(), state.end());
    return states;
}

namespace {

void require(bool legal, const std::string& where, const std::string& message) {
    if (!legal)
        throw InputError(fmt::format("{}: {}", where, message));
}

} // namespace

std::string row_name(const Trajectory& trajectory, std::size_t row) {
    return row < trajectory.where.size() ? trajectory.where[row]
                                         : fmt::format("{}, row {}", trajectory.name, row + 1);
}

void check_trajectories(const std::vector<Trajectory>& trajectories) {
    if (trajectories.empty())
        throw InputError("fit of trajectories: there are none");
    for (const Trajectory& trajectory : trajectories) {
        require(!trajectory.times.empty() && trajectory.times.size() == trajectory.states.size(),
                trajectory.name,
                fmt::format("{} times and {} rows: there must be as many, one at least",
                            trajectory.times.size(), trajectory.states.size()));
        const std::size_t size = trajectory.states.front().size();
        require(size % 3 == 0 && size >= 6, trajectory.name,
                fmt::format("{} numbers a row: x, y and heading of two rods or more are needed", size));
        require(trajectory.times.size() > 1 || trajectory.contact_time, trajectory.name,
                "a single row is only the start: give a second one or contact_time");
        require(!trajectory.box || valid_sides(*trajectory.box), trajectory.name,
                fmt::format("box = {}: must be above 0 and finite", to_string(trajectory.box.value_or(0.0))));
        require(trajectory.independent > 0.0 && trajectory.independent <= 1.0, trajectory.name,
                fmt::format("independent = {}: a row is worth more than 0 and at most 1 row",
                            trajectory.independent));
        for (std::size_t row = 0; row < trajectory.times.size(); ++row) {
            const std::string where = row_name(trajectory, row);
            const std::vector<double>& state = trajectory.states[row];
            require(state.size() == trajectory.states.front().size(), where,
                    fmt::format("{} numbers, but the first row has {}", state.size(),
                                trajectory.states.front().size()));
            require(std::isfinite(trajectory.times[row]), where, "the time must be a finite number");
            require(row == 0 || trajectory.times[row] > trajectory.times[row - 1], where,
                    fmt::format("the time is {}, not after {} of the row before", trajectory.times[row],
                                trajectory.times[row == 0 ? 0 : row - 1]));
            require(std::ranges::all_of(state, [](double v) { return std::isfinite(v); }), where,
                    "positions and headings must be finite numbers");
        }
        for (const auto& [name, sigma] : {std::pair("sigma_position", trajectory.sigma_position),
                                          std::pair("sigma_heading", trajectory.sigma_heading),
                                          std::pair("sigma_contact", trajectory.sigma_contact)})
            require(sigma > 0.0 && std::isfinite(sigma), trajectory.name,
                    fmt::format("{} = {}: must be above 0 and finite", name, sigma));
        require(!trajectory.contact_time || trajectory.contact_distance, trajectory.name,
                "contact_time needs a contact_distance");
        require(!trajectory.contact_time || (*trajectory.contact_time > trajectory.times.front() &&
                                             std::isfinite(*trajectory.contact_time)),
                trajectory.name,
                fmt::format("contact_time = {}: must be finite and after the first row, {}",
                            trajectory.contact_time.value_or(0.0), trajectory.times.front()));
        const double start = rods::closest_pair(trajectory.states.front(), trajectory.box).distance;
        for (std::size_t row = 0; row < trajectory.states.size(); ++row)
            require(rods::closest_pair(trajectory.states[row], trajectory.box).distance > 0.0,
                    row_name(trajectory, row), "two rods are at the same position");
        require(!trajectory.contact_distance ||
                    (*trajectory.contact_distance > 0.0 && *trajectory.contact_distance < start),
                trajectory.name,
                fmt::format(
                    "contact_distance = {}: must be above 0 and below the smallest starting separation, {}",
                    trajectory.contact_distance.value_or(0.0), start));
    }
}

void check_trajectory_parameters(const std::vector<Parameter>& parameters) {
    const auto has = [&](std::string_view name) {
        return std::ranges::find(parameters, name, &Parameter::name) != parameters.end();
    };
    bool wakes = false, free_medium = false;
    for (const Parameter& p : parameters) {
        wakes = wakes || rods::turns_in_wakes(p.name);
        free_medium = free_medium || (!p.fixed && (p.name == "eta" || p.name == "xi" || p.name == "alpha"));
    }
    if (has("rows_direction") && !has("gamma_rows"))
        throw InputError(
            "fit of trajectories: rows_direction needs gamma_rows, which turns the rods into these rows");
    if (wakes && !has("eta"))
        throw InputError("fit of trajectories: parameter eta is missing; fix it if it is known");
    if (has("xi") && has("alpha"))
        throw InputError("fit of trajectories: xi and alpha = 1/xi are both given; leave one out");
    if (wakes && !has("xi") && !has("alpha"))
        throw InputError("fit of trajectories: parameter xi (or alpha) is missing; fix it if it is known");
    std::vector<std::string_view> couplings;
    for (const rods::Coupling& coupling : rods::coupling_list)
        couplings.push_back(coupling.name);
    if (!wakes && free_medium)
        throw InputError(
            fmt::format("fit of trajectories: none of {}, gamma_flow is a parameter, so nothing turns "
                        "the rods in the medium that is to be fitted",
                        fmt::join(couplings, ", ")));
}

} // namespace rodwake::fitting
