#include "trajectory_run.hpp"

#include "rodwake/core/box_sides.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/rods/separation.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace rodwake::fitting {

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
    if (!has("eta"))
        throw InputError("fit of trajectories: parameter eta is missing; fix it if it is known");
    if (has("xi") == has("alpha"))
        throw InputError(
            has("xi") ? "fit of trajectories: xi and alpha = 1/xi are both given; leave one out"
                      : "fit of trajectories: parameter xi (or alpha) is missing; fix it if it is known");
    std::vector<std::string_view> couplings;
    for (const rods::Coupling& coupling : rods::coupling_list)
        couplings.push_back(coupling.name);
    if (std::ranges::none_of(couplings, has))
        throw InputError(
            fmt::format("fit of trajectories: none of {} is a parameter, so nothing turns the rods",
                        fmt::join(couplings, ", ")));
}

} // namespace rodwake::fitting
