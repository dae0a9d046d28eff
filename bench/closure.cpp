// Encounters of two rods under the quasi-static closure and without it, for studies/validate_closure.py.
// Reads cases from standard input, one a line:
//
//   HOW eta alpha kappa gamma1 gamma2 box width modes t_end contact x0 y0 heading0 x1 y1 heading1
//
// HOW: plane, box (steady wakes of point forces there), steady, first_order (closures of the dynamic medium),
// memory (the medium itself, with the wakes of rods that have always walked straight), rest (undeformed at
// t = 0). Answers each with a line of JSON: ending, time, cpu_seconds, smallest
// separation, poses every 0.25 f/(mu v0) and at the end.
//
//   build/release/bench/bench_closure < cases.txt

#include "rodwake/medium/simulate.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <ctime>
#include <iostream>
#include <sstream>
#include <string>
#include <string_view>

namespace {

using namespace rodwake;

constexpr double interval = 0.25, rtol = 1e-7;
constexpr long most_steps = 1000; // a first order that runs away is no result
constexpr std::array<std::string_view, 6> ways{"plane", "box", "steady", "first_order", "memory", "rest"};

struct Case {
    std::string how;
    medium::MediumProblem problem;
};

bool read(const std::string& line, Case& encounter) {
    std::istringstream words(line);
    double alpha = 0.0, contact = 0.0;
    elastic::Medium elastic;
    rods::RodProblem& p = encounter.problem.rods;
    medium::DynamicMedium& m = encounter.problem.medium;
    words >> encounter.how >> elastic.eta >> alpha >> p.couplings.kappa >> p.couplings.gamma1 >>
        p.couplings.gamma2 >> m.box >> m.force_width >> m.modes >> p.t_end >> contact;
    p.rods.resize(2);
    for (rods::Pose& rod : p.rods)
        words >> rod.x >> rod.y >> rod.heading;
    elastic.xi = 1.0 / alpha;
    p.medium = elastic;
    p.contact_distance = contact;
    for (int i = 0; i * interval < p.t_end; ++i)
        p.output_times.push_back(i * interval);
    return !words.fail() && std::ranges::count(ways, encounter.how) == 1;
}

rods::RodOptions options() {
    rods::RodOptions o;
    o.ode.method = integrate::Method::erk;
    o.ode.rtol = rtol;
    o.ode.atol = 0.01 * rtol;
    o.ode.max_steps = most_steps;
    return o;
}

rods::RodResult run(Case encounter) {
    medium::MediumProblem& p = encounter.problem;
    if (encounter.how == "plane")
        return rods::simulate(p.rods, options());
    if (encounter.how == "box") {
        p.rods.box = p.medium.box;
        return rods::simulate(p.rods, options());
    }
    p.medium.closure = encounter.how == "steady"        ? medium::Closure::steady
                       : encounter.how == "first_order" ? medium::Closure::first_order
                                                        : medium::Closure::none;
    if (encounter.how == "rest")
        p.medium.start = medium::Start::rest;
    return medium::simulate(p, options());
}

void print(const rods::RodResult& result, double cpu_seconds) {
    const bool failed = !result.solution.status.ok();
    std::printf(
        "{\"ending\": \"%s\", \"time\": %.9g, \"cpu_seconds\": %.4g, \"steps\": %ld, \"closest\": %.6g, "
        "\"poses\": [",
        failed ? "failed" : to_string(result.outcome.ending).c_str(), result.solution.final_time, cpu_seconds,
        result.solution.statistics.steps, result.outcome.min_separation);
    auto poses = result.solution.states;
    if (poses.empty() || poses.back() != result.solution.final_state)
        poses.push_back(result.solution.final_state);
    for (std::size_t k = 0; k < poses.size(); ++k) {
        std::printf(k == 0 ? "[" : ", [");
        for (std::size_t i = 0; i < poses[k].size(); ++i)
            std::printf(i == 0 ? "%.8g" : ", %.8g", poses[k][i]);
        std::printf("]");
    }
    std::puts("]}");
    std::fflush(stdout);
}

} // namespace

int main() {
    for (std::string line; std::getline(std::cin, line);) {
        Case encounter;
        if (!read(line, encounter)) {
            std::fprintf(stderr, "bench_closure: not a case: %s\n", line.c_str());
            return 2;
        }
        const std::clock_t start = std::clock();
        const rods::RodResult result = run(encounter);
        print(result, static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
    }
}
