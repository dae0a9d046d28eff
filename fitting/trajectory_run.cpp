#include "trajectory_run.hpp"

#include "rodwake/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <tuple>
#include <utility>

namespace rodwake::fitting {

namespace {

using Column = Eigen::Index;

const std::map<std::string, Role>& physical_roles() {
    static const std::map<std::string, Role> roles = [] {
        std::map<std::string, Role> all = {{"eta", {rods::Parameter::eta}},
                                           {"xi", {rods::Parameter::xi}},
                                           {"alpha", {rods::Parameter::xi, true}},
                                           {"gamma_flow", {.flow = true}},
                                           {"gamma_rows", {rods::Parameter::rows_gamma}},
                                           {"rows_direction", {rods::Parameter::rows_direction}},
                                           {"stall_overlap", {rods::Parameter::stall_overlap}},
                                           {"mobility_ratio", {rods::Parameter::mobility_ratio}},
                                           {"D_r", {.diffusion = Role::Diffusion::rotational}},
                                           {"D_t", {.diffusion = Role::Diffusion::translational}}};
        for (int k = 0; k < static_cast<int>(rods::Parameter::eta); ++k)
            all[std::string(rods::coupling_list[k].name)] = {static_cast<rods::Parameter>(k)};
        return all;
    }();
    return roles;
}

/// What the sensitivities are taken by, and how it follows from the parameters of the fit.
struct SensitivityColumns {
    std::vector<rods::Parameter> physical;
    std::vector<std::size_t> headings, places;
    Eigen::MatrixXd by_parameter; ///< d column / d parameter

    bool empty() const { return physical.empty() && headings.empty() && places.empty(); }
};

double gamma_flow_of(std::span<const Role> roles, std::span<const double> values) {
    const auto at = std::ranges::find_if(roles, &Role::flow);
    return at == roles.end() ? 0.0 : values[static_cast<std::size_t>(at - roles.begin())];
}

SensitivityColumns columns_of(std::size_t index, std::span<const Role> roles, std::span<const double> values,
                              const std::vector<bool>& wanted, const elastic::Medium& medium) {
    SensitivityColumns columns;
    std::vector<std::size_t> headings, places; // which parameters they are
    std::vector<std::tuple<std::size_t, std::size_t, double>> entries;
    const double flow = gamma_flow_of(roles, values);
    for (std::size_t j = 0; j < roles.size(); ++j) {
        const Role& role = roles[j];
        if (!wanted[j] || role.diffusion || !role.matters_to(index))
            continue;
        if (role.of_start()) {
            (role.component == 2 ? headings : places).push_back(j);
            (role.component == 2 ? columns.headings : columns.places)
                .push_back(role.component == 2 ? role.rod : 2 * role.rod + role.component);
            continue;
        }

        // d physical / d parameter, of those that are not 0. A number of the medium enters
        // gamma1 += gamma_flow xi and gamma2 += gamma_flow xi eta, too.
        using enum rods::Parameter;
        std::vector<std::pair<rods::Parameter, double>> slopes;
        const double own = role.inverse ? -1.0 / (values[j] * values[j]) : 1.0;
        if (role.flow)
            slopes = {{gamma1, medium.xi}, {gamma2, medium.xi * medium.eta}};
        else
            slopes = {{*role.physical, own}};
        if (flow != 0.0 && role.physical == xi)
            slopes.insert(slopes.end(), {{gamma1, own * flow}, {gamma2, own * flow * medium.eta}});
        if (flow != 0.0 && role.physical == eta)
            slopes.emplace_back(gamma2, own * flow * medium.xi);
        for (const auto& [physical, slope] : slopes) {
            const auto at = std::ranges::find(columns.physical, physical);
            entries.emplace_back(at - columns.physical.begin(), j, slope);
            if (at == columns.physical.end())
                columns.physical.push_back(physical);
        }
    }
    std::size_t column = columns.physical.size();
    for (const auto* list : {&headings, &places})
        for (const std::size_t j : *list)
            entries.emplace_back(column++, j, 1.0);
    columns.by_parameter.setZero(static_cast<Column>(column), static_cast<Column>(roles.size()));
    for (const auto& [row, j, slope] : entries)
        columns.by_parameter(static_cast<Column>(row), static_cast<Column>(j)) += slope;
    return columns;
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

/// A run that has not met by the end counts as if its closest pair closed in at speed 1 from there: the
/// residual then goes on where contact moves out of the run, and its slope says in which direction to look.
void add_contact(ModelRun& run, const Trajectory& trajectory, const integrate::SensitivitySolution& solved,
                 const SensitivityColumns& columns) {
    const bool met = solved.solution.status.termination == integrate::Termination::stopped_at_event;
    const rods::Separation pair = rods::closest_pair(solved.solution.final_state, trajectory.box);
    run.contact_time =
        solved.solution.final_time + (met ? 0.0 : pair.distance - *trajectory.contact_distance);
    if (columns.empty())
        return;
    Eigen::MatrixXd by = solved.event_time_by_parameter.transpose();
    if (!met) {
        const auto a = static_cast<Column>(3 * pair.first), b = static_cast<Column>(3 * pair.second);
        const rods::Offset d =
            rods::offset(solved.solution.final_state, pair.first, pair.second, trajectory.box);
        const Eigen::RowVector2d axis = Eigen::RowVector2d(d.x, d.y) / pair.distance;
        by = axis * (solved.final_sensitivity.middleRows(a, 2) - solved.final_sensitivity.middleRows(b, 2));
    }
    run.contact_time_by_parameter = (by * columns.by_parameter).transpose();
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

} // namespace

std::string pose_name(std::size_t trajectory, std::size_t rod, std::size_t component) {
    return fmt::format("{}.{}.{}", pose_words[component], trajectory, rod);
}

bool is_start_pose(const std::string& name) { return pose_of(name).has_value(); }

Role role_of(const std::string& name, const std::vector<Trajectory>& trajectories) {
    if (const auto known = physical_roles().find(name); known != physical_roles().end())
        return known->second;
    if (const auto pose = pose_of(name); pose && pose->trajectory < trajectories.size())
        if (const Trajectory& trajectory = trajectories[pose->trajectory];
            is_free(trajectory, pose->component) && pose->rod < trajectory.states.front().size() / 3)
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
    problem.bodies = trajectory.bodies;
    problem.goes_on = trajectory.bodies.any();
    const std::vector<double>& start = trajectory.states.front();
    for (std::size_t i = 0; i + 2 < start.size(); i += 3)
        problem.rods.push_back({start[i], start[i + 1], start[i + 2]});
    for (std::size_t j = 0; j < roles.size(); ++j) {
        if (roles[j].physical)
            rods::value(problem, *roles[j].physical) = roles[j].inverse ? 1.0 / values[j] : values[j];
        if (!roles[j].of_start() || roles[j].trajectory != index)
            continue;
        rods::Pose& rod = problem.rods[roles[j].rod];
        (roles[j].component == 0 ? rod.x : roles[j].component == 1 ? rod.y : rod.heading) = values[j];
    }
    problem.couplings = rods::with_flow(problem.couplings, gamma_flow_of(roles, values), problem.medium->eta,
                                        problem.medium->xi);
    problem.box = trajectory.box;
    // Fields are singular where rods meet, and no solve gets past that. Without a contact distance of its own
    // a model run ends where rods come a hundred times closer than in any row: the rows after it are then far
    // from the data, with slopes, instead of nowhere.
    double smallest = HUGE_VAL;
    for (const std::vector<double>& state : trajectory.states)
        smallest = std::min(smallest, rods::closest_pair(state, trajectory.box).distance);
    problem.contact_distance = trajectory.contact_distance.value_or(0.01 * smallest);
    problem.t_end = times_to_solve(trajectory).back();
    return problem;
}

ModelRun run_model(const integrate::OdeOptions& options, const Trajectory& trajectory, std::size_t index,
                   std::span<const Role> roles, std::span<const double> values,
                   const std::vector<bool>* wanted) {
    const rods::RodProblem problem = rod_problem(trajectory, index, roles, values);
    const SensitivityColumns columns =
        wanted ? columns_of(index, roles, values, *wanted, *problem.medium) : SensitivityColumns{};
    integrate::OdeOptions tight = options;
    tight.atol = std::min(tight.atol, 0.1 * tight.rtol); // as rods::simulate
    const auto sensitivity_problem =
        rods::to_sensitivity_problem(problem, columns.physical, columns.headings, columns.places);
    integrate::SensitivitySolution solved;
    if (columns.empty()) {
        if (tight.method == integrate::Method::adams) // a third of the time, to the same tolerance
            tight.method = integrate::Method::erk;
        solved.solution = integrate::solve(sensitivity_problem.ode, tight, times_to_solve(trajectory));
    } else {
        solved = integrate::solve_with_sensitivities(sensitivity_problem, tight, times_to_solve(trajectory));
    }
    if (!solved.solution.status.ok())
        throw RunError(trajectory.name + ": " + solved.solution.status.message());
    ModelRun run;
    const std::size_t rows = trajectory.times.size();
    const auto size = static_cast<Column>(solved.solution.final_state.size());
    for (std::size_t k = 0; k < std::min(rows, solved.solution.times.size()); ++k) {
        run.states.emplace_back(Eigen::Map<const Eigen::VectorXd>(solved.solution.states[k].data(), size));
        if (!columns.empty())
            run.derivatives.push_back(solved.sensitivities[k] * columns.by_parameter);
    }
    // At a contact the derivatives of the end are those of the moving end.
    Eigen::MatrixXd S = solved.final_sensitivity;
    if (solved.event_time_by_parameter.size() > 0) {
        Eigen::VectorXd slope(size);
        rods::model_of(problem).rhs(solved.solution.final_state,
                                    {slope.data(), solved.solution.final_state.size()});
        S += slope * solved.event_time_by_parameter.transpose();
    }
    while (run.states.size() < rows) {
        run.states.emplace_back(Eigen::Map<const Eigen::VectorXd>(solved.solution.final_state.data(), size));
        if (!columns.empty())
            run.derivatives.push_back(S * columns.by_parameter);
    }
    if (trajectory.contact_time)
        add_contact(run, trajectory, solved, columns);
    return run;
}

} // namespace rodwake::fitting
