#include "trajectory_run.hpp"

#include "rodwake/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>

namespace rodwake::fitting {

namespace {

using Column = Eigen::Index;

const std::map<std::string, Role>& physical_roles() {
    static const std::map<std::string, Role> roles = [] {
        std::map<std::string, Role> all = {{"eta", {rods::Parameter::eta}},
                                           {"xi", {rods::Parameter::xi}},
                                           {"alpha", {rods::Parameter::xi, true}}};
        for (int k = 0; k < static_cast<int>(rods::Parameter::eta); ++k)
            all[std::string(rods::coupling_list[k].name)] = {static_cast<rods::Parameter>(k)};
        return all;
    }();
    return roles;
}

/// What the sensitivities are taken by, and which parameter of the fit each column is.
struct Columns {
    std::vector<rods::Parameter> physical;
    std::vector<std::size_t> headings, places;
    std::vector<std::size_t> parameter;
    std::vector<double> factor; ///< d physical / d parameter
};

Columns columns_of(std::size_t index, std::span<const Role> roles, std::span<const double> values,
                   const std::vector<bool>& wanted) {
    Columns columns;
    const auto kind = [](const Role& role) { return role.physical ? 0 : role.component == 2 ? 1 : 2; };
    for (const int wanted_kind : {0, 1, 2})
        for (std::size_t j = 0; j < roles.size(); ++j) {
            const Role& role = roles[j];
            if (!wanted[j] || !role.matters_to(index) || kind(role) != wanted_kind)
                continue;
            if (role.physical)
                columns.physical.push_back(*role.physical);
            else if (role.component == 2)
                columns.headings.push_back(role.rod);
            else
                columns.places.push_back(2 * role.rod + role.component);
            columns.parameter.push_back(j);
            columns.factor.push_back(role.inverse ? -1.0 / (values[j] * values[j]) : 1.0);
        }
    return columns;
}

/// From the columns of a run to those of the fit.
Eigen::MatrixXd spread(const Columns& columns, std::size_t parameters, const Eigen::MatrixXd& S) {
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(S.rows(), static_cast<Column>(parameters));
    for (std::size_t j = 0; j < columns.parameter.size(); ++j)
        all.col(static_cast<Column>(columns.parameter[j])) =
            columns.factor[j] * S.col(static_cast<Column>(j));
    return all;
}

Eigen::VectorXd vector(const std::vector<double>& v) {
    return Eigen::Map<const Eigen::VectorXd>(v.data(), static_cast<Column>(v.size()));
}

std::vector<double> times_to_solve(const Trajectory& trajectory) {
    std::vector<double> times;
    for (const double t : trajectory.times)
        times.push_back(t - trajectory.times.front());
    if (!trajectory.contact_time)
        return times;
    const double horizon = contact_patience * (*trajectory.contact_time - trajectory.times.front());
    if (horizon > times.back())
        times.push_back(horizon);
    return times;
}

integrate::OdeOptions tightened(integrate::OdeOptions options) {
    options.atol = std::min(options.atol, 0.1 * options.rtol); // as rods::simulate
    return options;
}

/// Solves with sensitivities if there is something to differentiate by.
integrate::SensitivitySolution solve(const rods::RodProblem& rods, const Columns& columns,
                                     const integrate::OdeOptions& options, std::span<const double> times) {
    const auto problem =
        rods::to_sensitivity_problem(rods, columns.physical, columns.headings, columns.places);
    if (columns.parameter.empty())
        return {integrate::solve(problem.ode, options, times), {}, {}, {}};
    return integrate::solve_with_sensitivities(problem, options, times);
}

Eigen::VectorXd slope_at_end(const rods::RodProblem& problem, const integrate::Solution& solution) {
    Eigen::VectorXd slope(static_cast<Column>(solution.final_state.size()));
    rods::model_of(problem).rhs(solution.final_state, {slope.data(), solution.final_state.size()});
    return slope;
}

/// The end and its derivatives; at a contact those of the moving end.
void add_end(ModelRun& run, const rods::RodProblem& problem, const integrate::SensitivitySolution& solved,
             const Columns& columns, std::size_t parameters, std::size_t rows) {
    Eigen::MatrixXd S = solved.final_sensitivity;
    if (solved.event_time_by_parameter.size() > 0)
        S += slope_at_end(problem, solved.solution) * solved.event_time_by_parameter.transpose();
    while (run.states.size() < rows) {
        run.states.push_back(vector(solved.solution.final_state));
        if (!columns.parameter.empty())
            run.derivatives.push_back(spread(columns, parameters, S));
    }
}

/// A run that has not met by the end counts as if its closest pair closed in at speed 1 from there: the
/// residual then goes on where contact moves out of the run, and its slope says in which direction to look.
void add_contact(ModelRun& run, const Trajectory& trajectory, const integrate::SensitivitySolution& solved,
                 const Columns& columns, std::size_t parameters) {
    const bool met = solved.solution.status.termination == integrate::Termination::stopped_at_event;
    const rods::Separation pair = rods::closest_pair(solved.solution.final_state, trajectory.box);
    run.contact_time =
        solved.solution.final_time + (met ? 0.0 : pair.distance - *trajectory.contact_distance);
    if (columns.parameter.empty())
        return;
    Eigen::MatrixXd by = solved.event_time_by_parameter.transpose();
    if (!met) {
        const auto a = static_cast<Column>(3 * pair.first), b = static_cast<Column>(3 * pair.second);
        const rods::Offset d =
            rods::offset(solved.solution.final_state, pair.first, pair.second, trajectory.box);
        const Eigen::RowVector2d axis = Eigen::RowVector2d(d.x, d.y) / pair.distance;
        by = axis * (solved.final_sensitivity.middleRows(a, 2) - solved.final_sensitivity.middleRows(b, 2));
    }
    run.contact_time_by_parameter = spread(columns, parameters, by).transpose();
}

/// Fields are singular where rods meet, and no solve gets past that. Without a contact distance of its own a
/// model run ends where rods come a hundred times closer than in any row: the rows after it are then far from
/// the data, with slopes, instead of nowhere.
double implied_contact(const Trajectory& trajectory) {
    double smallest = HUGE_VAL;
    for (const std::vector<double>& state : trajectory.states)
        smallest = std::min(smallest, rods::closest_pair(state, trajectory.box).distance);
    return 0.01 * smallest;
}

constexpr std::array pose_words = {"x", "y", "heading"};

/// The role that a name like "x.0.1" says.
std::optional<Role> pose_of(const std::string& name) {
    const auto dot = name.find('.');
    const auto word = std::ranges::find(pose_words, name.substr(0, dot));
    Role role;
    if (dot == std::string::npos || word == pose_words.end() ||
        std::sscanf(name.c_str() + dot, ".%zu.%zu", &role.trajectory, &role.rod) != 2)
        return std::nullopt;
    role.component = static_cast<std::size_t>(word - pose_words.begin());
    return name == pose_name(role.trajectory, role.rod, role.component) ? std::optional(role) : std::nullopt;
}

double& component(rods::Pose& rod, std::size_t which) {
    return which == 0 ? rod.x : which == 1 ? rod.y : rod.heading;
}

} // namespace

std::string pose_name(std::size_t trajectory, std::size_t rod, std::size_t component) {
    return fmt::format("{}.{}.{}", pose_words[component], trajectory, rod);
}

bool is_start_pose(const std::string& name) { return pose_of(name).has_value(); }

Role role_of(const std::string& name, const std::vector<Trajectory>& trajectories) {
    if (const auto known = physical_roles().find(name); known != physical_roles().end())
        return known->second;
    if (const auto pose = pose_of(name); pose && pose->trajectory < trajectories.size())
        if (const Trajectory& one = trajectories[pose->trajectory];
            is_free(one, pose->component) && pose->rod < one.states.front().size() / 3)
            return *pose;
    throw InputError(
        fmt::format("fit of trajectories: no parameter \"{}\"; there are {} and, of trajectories "
                    "with free starts, x.<trajectory>.<rod>, y. and heading. likewise",
                    name, fmt::join(trajectory_parameter_names(), ", ")));
}

rods::RodProblem rod_problem(const Trajectory& trajectory, std::size_t index, std::span<const Role> roles,
                             std::span<const double> values) {
    rods::RodProblem problem;
    problem.medium.emplace();
    const std::vector<double>& start = trajectory.states.front();
    for (std::size_t i = 0; i + 2 < start.size(); i += 3)
        problem.rods.push_back({start[i], start[i + 1], start[i + 2]});
    for (std::size_t j = 0; j < roles.size(); ++j) {
        if (roles[j].physical)
            rods::value(problem, *roles[j].physical) = roles[j].inverse ? 1.0 / values[j] : values[j];
        else if (roles[j].trajectory == index)
            component(problem.rods[roles[j].rod], roles[j].component) = values[j];
    }
    problem.box = trajectory.box;
    problem.contact_distance = trajectory.contact_distance.value_or(implied_contact(trajectory));
    problem.t_end = times_to_solve(trajectory).back();
    return problem;
}

ModelRun run_model(const integrate::OdeOptions& options, const Trajectory& trajectory, std::size_t index,
                   std::span<const Role> roles, std::span<const double> values,
                   const std::vector<bool>* wanted) {
    const rods::RodProblem problem = rod_problem(trajectory, index, roles, values);
    const Columns columns = wanted ? columns_of(index, roles, values, *wanted) : Columns{};
    const integrate::SensitivitySolution solved =
        solve(problem, columns, tightened(options), times_to_solve(trajectory));
    if (!solved.solution.status.ok())
        throw RunError(trajectory.name + ": " + solved.solution.status.message());
    ModelRun run;
    const std::size_t rows = trajectory.times.size();
    for (std::size_t k = 0; k < std::min(rows, solved.solution.times.size()); ++k) {
        run.states.push_back(vector(solved.solution.states[k]));
        if (!columns.parameter.empty())
            run.derivatives.push_back(spread(columns, roles.size(), solved.sensitivities[k]));
    }
    add_end(run, problem, solved, columns, roles.size(), rows);
    if (trajectory.contact_time)
        add_contact(run, trajectory, solved, columns, roles.size());
    return run;
}

} // namespace rodwake::fitting
