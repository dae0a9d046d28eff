#include "reference.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <stdexcept>

namespace rodwake::test {

namespace {

using nlohmann::json;

rods::RodProblem problem_of(const json& c) {
    rods::RodProblem problem;
    problem.medium = elastic::Medium{c.at("eta").get<double>(), 1.0 / c.at("alpha").get<double>()};
    problem.couplings = {c.at("kappa").get<double>(), c.at("gamma1").get<double>(),
                         c.at("gamma2").get<double>()};
    const auto start = c.at("initial").get<std::vector<double>>();
    for (std::size_t i = 0; i + 2 < start.size(); i += 3)
        problem.rods.push_back({start[i], start[i + 1], start[i + 2]});
    if (c.contains("contact_distance"))
        problem.contact_distance = c.at("contact_distance").get<double>();
    return problem;
}

ReferencePoint point_of(const json& output) {
    ReferencePoint point{std::stod(output.at("time").get<std::string>()), {}, output.contains("event")};
    for (const json& value : output.at("state"))
        point.state.push_back(std::stod(value.get<std::string>()));
    return point;
}

double difference(const std::vector<double>& a, const std::vector<double>& b) {
    double worst = a.size() == b.size() ? 0.0 : std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
        worst = std::max(worst, std::abs(a[i] - b[i]));
    return worst;
}

double contact_error(const ReferencePoint& point, const rods::RodResult& result) {
    if (result.outcome.ending != Ending::contact)
        return std::numeric_limits<double>::infinity();
    return std::max(std::abs(result.outcome.time - point.time),
                    difference(result.solution.final_state, point.state));
}

double output_error(const ReferencePoint& point, const integrate::Solution& solution) {
    const auto at = std::ranges::find(solution.times, point.time);
    if (at == solution.times.end())
        return std::numeric_limits<double>::infinity();
    return difference(solution.states[static_cast<std::size_t>(at - solution.times.begin())], point.state);
}

} // namespace

std::vector<ReferenceCase> reference_cases(const std::string& file) {
    std::ifstream in(file);
    std::vector<ReferenceCase> cases;
    const json document = json::parse(in);
    for (const json& c : document.at("cases")) {
        ReferenceCase one{c.at("name").get<std::string>(), problem_of(c), {}};
        for (const json& output : c.at("output"))
            one.points.push_back(point_of(output));
        for (const ReferencePoint& point : one.points)
            if (!point.contact)
                one.problem.output_times.push_back(point.time);
        one.problem.t_end = one.points.back().time + (one.points.back().contact ? 1.0 : 0.0);
        cases.push_back(std::move(one));
    }
    if (cases.empty())
        throw std::runtime_error(file + ": no reference case");
    return cases;
}

std::vector<ReferenceCase> reference_cases() {
    return reference_cases(RODWAKE_TEST_DATA "/rod_trajectories.json");
}

double worst_error(const ReferenceCase& reference, const rods::RodResult& result) {
    double worst = 0.0;
    for (const ReferencePoint& point : reference.points)
        worst = std::max(worst,
                         point.contact ? contact_error(point, result) : output_error(point, result.solution));
    return worst;
}

} // namespace rodwake::test
