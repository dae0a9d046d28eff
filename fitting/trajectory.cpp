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
    std::size_t start, rows, contact;

    explicit ResidualLayout(const Trajectory& one)
        : start(one.states.front().size() / (one.free_start ? 1 : 3) * (is_free(one, 2) ? 1 : 0)),
          rows((one.times.size() - 1) * one.states.front().size()), contact(one.contact_time ? 1 : 0) {}
    std::size_t count() const { return start + rows + contact; }
};

double sigma_of(const Trajectory& one, std::size_t component) {
    return (component % 3 == 2 ? one.sigma_heading : one.sigma_position) / std::sqrt(one.independent);
}

/// Of the residuals; a time of contact counts in full.
double mean_independent(const std::vector<Trajectory>& all) {
    double values = 0.0, residuals = 0.0;
    for (const Trajectory& one : all) {
        const ResidualLayout size(one);
        residuals += static_cast<double>(size.count());
        values += static_cast<double>(size.contact) +
                  one.independent * static_cast<double>(size.count() - size.contact);
    }
    return values / residuals;
}

std::string residual_name(const Trajectory& one, std::size_t i) {
    static constexpr const char* names[] = {"x", "y", "theta"};
    const ResidualLayout size(one);
    const std::size_t n = one.states.front().size();
    if (i < size.start) {
        const std::size_t of_row = one.free_start ? i : 3 * i + 2;
        return fmt::format("{} {}{}", row_name(one, 0), names[of_row % 3], of_row / 3);
    }
    const std::size_t in_rows = i - size.start, component = in_rows % n;
    if (in_rows >= size.rows)
        return one.name + " contact time";
    return fmt::format("{} {}{}", row_name(one, in_rows / n + 1), names[component % 3], component / 3);
}

/// Of x, y and heading of each rod, from residual `first` on; a time of contact stands alone.
void add_series(const Trajectory& one, std::size_t first, std::vector<Series>& all) {
    const ResidualLayout size(one);
    const std::size_t n = one.states.front().size();
    for (std::size_t component = 0; component < n; ++component) {
        Series series{one.name, component % 3 == 2 ? "headings" : "places", {}};
        if (is_free(one, component))
            series.residuals.push_back(first + (one.free_start ? component : component / 3));
        for (std::size_t row = 0; row < size.rows / n; ++row)
            series.residuals.push_back(first + size.start + row * n + component);
        all.push_back(std::move(series));
    }
    if (size.contact > 0)
        all.push_back({one.name, "contact time", {first + size.start + size.rows}});
}

class Trajectories {
public:
    Trajectories(integrate::OdeOptions options, const std::vector<Trajectory>& all,
                 const std::vector<Parameter>& parameters)
        : options_(std::move(options)), all_(all) {
        for (const Parameter& p : parameters) {
            roles_.push_back(role_of(p.name, all));
            wanted_.push_back(!p.fixed);
        }
    }

    std::size_t residuals() const {
        std::size_t count = 0;
        for (const Trajectory& one : all_)
            count += ResidualLayout(one).count();
        return count;
    }

    // NOLINTNEXTLINE(performance-unnecessary-value-param): an Eigen::Ref is a view
    void evaluate(std::span<const double> p, Eigen::Ref<Eigen::VectorXd> r, Eigen::MatrixXd* jacobian) const {
        Row at = 0;
        for (std::size_t k = 0; k < all_.size(); ++k)
            at = add(k, run_model(options_, all_[k], k, roles_, p, jacobian ? &wanted_ : nullptr), at, r,
                     jacobian);
    }

    std::vector<double> log_sigma() const {
        std::vector<double> out;
        for (const Trajectory& one : all_) {
            for (std::size_t row = 0; row < one.states.size(); ++row)
                for (std::size_t i = 0; i < one.states[row].size(); ++i)
                    if (row > 0 || is_free(one, i))
                        out.push_back(std::log(sigma_of(one, i)));
            if (one.contact_time)
                out.push_back(std::log(one.sigma_contact));
        }
        return out;
    }

    std::string name(std::size_t i) const {
        for (const Trajectory& one : all_) {
            if (i < ResidualLayout(one).count())
                return residual_name(one, i);
            i -= ResidualLayout(one).count();
        }
        return fmt::format("residual {} beyond the last", i);
    }

private:
    /// Residuals of one trajectory from `at` on; returns where the next one starts.
    Row add(std::size_t k, const ModelRun& run, Row at, Eigen::Ref<Eigen::VectorXd> r,
            Eigen::MatrixXd* jacobian) const {
        const Trajectory& one = all_[k];
        const bool slopes = jacobian && !run.derivatives.empty();
        const auto put = [&](double model, double datum, double sigma, const auto& slope) {
            r[at] = (model - datum) / sigma;
            if (jacobian)
                jacobian->row(at).setZero();
            if (slopes)
                jacobian->row(at) = slope() / sigma;
            ++at;
        };
        for (std::size_t row = 0; row < one.states.size(); ++row)
            for (std::size_t i = 0; i < one.states[row].size(); ++i)
                if (row > 0 || is_free(one, i))
                    put(run.states[row][static_cast<Row>(i)], one.states[row][i], sigma_of(one, i),
                        [&] { return run.derivatives[row].row(static_cast<Row>(i)); });
        if (one.contact_time)
            put(run.contact_time, *one.contact_time - one.times.front(), one.sigma_contact,
                [&] { return run.contact_time_by_parameter.transpose(); });
        return at;
    }

    integrate::OdeOptions options_;
    std::vector<Trajectory> all_;
    std::vector<Role> roles_;
    std::vector<bool> wanted_;
};

void add_starts(std::vector<Parameter>& parameters, const std::vector<Trajectory>& trajectories) {
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
}

void check_count(const Problem& problem) {
    const auto free = static_cast<std::size_t>(std::ranges::count_if(problem.parameters, &Parameter::free));
    if (problem.residuals < free)
        throw InputError(
            fmt::format("fit of trajectories: {} data cannot fix {} free parameters; fix some of "
                        "them or give more rows",
                        problem.residuals, free));
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
    names.insert(names.end(), {"eta", "xi", "alpha", "D_r", "D_t"});
    return names;
}

Problem trajectory_problem(const TrajectoryModel& model, const std::vector<Trajectory>& trajectories,
                           std::vector<Parameter> parameters) {
    check_trajectories(trajectories);
    check_trajectory_parameters(parameters);
    if (std::ranges::any_of(parameters, rods::is_noise, &Parameter::name))
        return noisy_problem(trajectories, std::move(parameters));
    if (model.ode.method == integrate::Method::erk)
        throw InputError("fit of trajectories: method erk has no sensitivities; use adams or, for stiff "
                         "couplings, bdf");
    add_starts(parameters, trajectories);
    const auto all = std::make_shared<const Trajectories>(model.ode, trajectories, parameters);
    Problem problem;
    problem.parameters = std::move(parameters);
    problem.residuals = all->residuals();
    problem.log_sigma = all->log_sigma();
    problem.independent = mean_independent(trajectories);
    std::size_t first = 0;
    for (const Trajectory& one : trajectories) {
        add_series(one, first, problem.series);
        first += ResidualLayout(one).count();
    }
    // NOLINTNEXTLINE(performance-unnecessary-value-param)
    problem.evaluate = [all](std::span<const double> p, Eigen::Ref<Eigen::VectorXd> r,
                             Eigen::MatrixXd* jacobian) { all->evaluate(p, r, jacobian); };
    problem.residual_name = [all](std::size_t i) { return all->name(i); };
    check_count(problem);
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

void check_row(const Trajectory& one, std::size_t row) {
    const std::string where = row_name(one, row);
    const std::vector<double>& state = one.states[row];
    require(state.size() == one.states.front().size(), where,
            fmt::format("{} numbers, but the first row has {}", state.size(), one.states.front().size()));
    require(std::isfinite(one.times[row]), where, "the time must be a finite number");
    require(row == 0 || one.times[row] > one.times[row - 1], where,
            fmt::format("the time is {}, not after {} of the row before", one.times[row],
                        one.times[row == 0 ? 0 : row - 1]));
    require(std::ranges::all_of(state, [](double v) { return std::isfinite(v); }), where,
            "positions and headings must be finite numbers");
}

void check_shape(const Trajectory& one) {
    require(!one.times.empty() && one.times.size() == one.states.size(), one.name,
            fmt::format("{} times and {} rows: there must be as many, one at least", one.times.size(),
                        one.states.size()));
    const std::size_t size = one.states.front().size();
    require(size % 3 == 0 && size >= 6, one.name,
            fmt::format("{} numbers a row: x, y and heading of two rods or more are needed", size));
    require(one.times.size() > 1 || one.contact_time, one.name,
            "a single row is only the start: give a second one or contact_time");
}

void check_sigma(const Trajectory& one, const char* name, double sigma) {
    require(sigma > 0.0 && std::isfinite(sigma), one.name,
            fmt::format("{} = {}: must be above 0 and finite", name, sigma));
}

void check_domain(const Trajectory& one) {
    require(!one.box || valid_sides(*one.box), one.name,
            fmt::format("box = {}: must be above 0 and finite", to_string(one.box.value_or(0.0))));
    require(one.independent > 0.0 && one.independent <= 1.0, one.name,
            fmt::format("independent = {}: a row is worth more than 0 and at most 1 row", one.independent));
}

void check_contact(const Trajectory& one) {
    require(!one.contact_time || one.contact_distance, one.name, "contact_time needs a contact_distance");
    require(!one.contact_time || (*one.contact_time > one.times.front() && std::isfinite(*one.contact_time)),
            one.name,
            fmt::format("contact_time = {}: must be finite and after the first row, {}",
                        one.contact_time.value_or(0.0), one.times.front()));
    const double start = rods::closest_pair(one.states.front(), one.box).distance;
    for (std::size_t row = 0; row < one.states.size(); ++row)
        require(rods::closest_pair(one.states[row], one.box).distance > 0.0, row_name(one, row),
                "two rods are in the same place");
    require(
        !one.contact_distance || (*one.contact_distance > 0.0 && *one.contact_distance < start), one.name,
        fmt::format("contact_distance = {}: must be above 0 and below the smallest starting separation, {}",
                    one.contact_distance.value_or(0.0), start));
}

} // namespace

std::string row_name(const Trajectory& trajectory, std::size_t row) {
    return row < trajectory.where.size() ? trajectory.where[row]
                                         : fmt::format("{}, row {}", trajectory.name, row + 1);
}

void check_trajectories(const std::vector<Trajectory>& trajectories) {
    if (trajectories.empty())
        throw InputError("fit of trajectories: there are none");
    for (const Trajectory& one : trajectories) {
        check_shape(one);
        check_domain(one);
        for (std::size_t row = 0; row < one.times.size(); ++row)
            check_row(one, row);
        check_sigma(one, "sigma_position", one.sigma_position);
        check_sigma(one, "sigma_heading", one.sigma_heading);
        check_sigma(one, "sigma_contact", one.sigma_contact);
        check_contact(one);
    }
}

void check_trajectory_parameters(const std::vector<Parameter>& parameters) {
    const auto has = [&](std::string_view name) {
        return std::ranges::find(parameters, name, &Parameter::name) != parameters.end();
    };
    const auto in_wakes = [](const Parameter& p) { return rods::turns_in_wakes(p.name); };
    const bool wakes = std::ranges::any_of(parameters, in_wakes),
               medium = has("eta") || has("xi") || has("alpha");
    if (has("rows_direction") && !has("gamma_rows"))
        throw InputError(
            "fit of trajectories: rows_direction needs gamma_rows, which turns the rods into these rows");
    if (wakes && !has("eta"))
        throw InputError("fit of trajectories: parameter eta is missing; fix it if it is known");
    if (has("xi") && has("alpha"))
        throw InputError("fit of trajectories: xi and alpha = 1/xi are both given; leave one out");
    if (wakes && !has("xi") && !has("alpha"))
        throw InputError("fit of trajectories: parameter xi (or alpha) is missing; fix it if it is known");
    const auto free_medium = [](const Parameter& p) {
        return !p.fixed && (p.name == "eta" || p.name == "xi" || p.name == "alpha");
    };
    std::vector<std::string_view> couplings;
    for (const rods::Coupling& coupling : rods::coupling_list)
        couplings.push_back(coupling.name);
    if (!wakes && medium && std::ranges::any_of(parameters, free_medium))
        throw InputError(
            fmt::format("fit of trajectories: none of {}, gamma_flow is a parameter, so nothing turns "
                        "the rods in the medium that is to be fitted",
                        fmt::join(couplings, ", ")));
}

} // namespace rodwake::fitting
