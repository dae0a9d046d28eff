// What a plan will cost, from a short measurement of each part on this machine.

#include "rodwake/assembly/describe.hpp"
#include "rodwake/elastic/field.hpp"
#include "rodwake/fitting/problem.hpp"
#include "rodwake/granular/simulation.hpp"
#include "rodwake/granular/start.hpp"
#include "rodwake/stages/run.hpp"
#include "scan/scan_rods.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <ctime>

namespace rodwake::stages {

namespace {

using assembly::Plan;
constexpr double budget = 0.5; ///< s, of each measurement

/// CPU seconds of this thread: what else the machine does is not a cost of the scene.
double now() {
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

double since(double start) { return now() - start; }

/// Seconds of a call, repeated for a tenth of the budget.
template<class Call>
double seconds_of(const Call& call) {
    const auto start = now();
    long count = 0;
    do {
        call();
        ++count;
    } while (since(start) < 0.1 * budget);
    return since(start) / static_cast<double>(count);
}

/// Of a step on one thread, from the second half of a short run: in the first one the bed is not yet shaken.
/// A lattice stands for every start.
double seconds_of_step(granular::GranularProblem problem) {
    problem.start = granular::Start::lattice;
    problem.equilibration_steps += problem.steps; // the end is not to come first
    granular::Simulation simulation(problem, granular::make_start(problem, 0), {}, 1);
    constexpr std::int64_t chunk = 10;
    const auto begin = now();
    while (since(begin) < 0.5 * budget && !simulation.finished() && !simulation.failure())
        simulation.advance(chunk);
    const auto half = now();
    std::int64_t steps = 0;
    do {
        simulation.advance(chunk);
        steps += chunk;
    } while (since(half) < 0.5 * budget && !simulation.finished() && !simulation.failure());
    return since(half) / static_cast<double>(steps);
}

double steps_of(const assembly::BedPlan& bed) {
    return static_cast<double>(bed.problem.steps + bed.problem.equilibration_steps);
}

std::string bed_cost(const Plan& plan) {
    const assembly::BedPlan& first = plan.beds.front();
    const double step = seconds_of_step(first.problem);
    const auto runs = static_cast<double>(first.of.scene.granular->runs);
    double all = 0.0;
    for (const assembly::BedPlan& bed : plan.beds) {
        all += step * steps_of(first) * assembly::sphere_steps(bed.problem) /
               assembly::sphere_steps(first.problem) * static_cast<double>(bed.of.scene.granular->runs);
    }
    const double one = step * steps_of(first);
    std::string text = fmt::format("  granular run: about {:.2g} CPU seconds", one);
    if (runs > 1.0)
        text += fmt::format(" each, {:.2g} for {:g} runs", one * runs, runs);
    if (plan.beds.size() > 1)
        text += fmt::format("; {:.2g} for all {} beds", all, plan.beds.size());
    return text + fmt::format("\n  output of a run: {}\n", assembly::describe_output(first));
}

std::string fit_cost(const Plan& plan) {
    constexpr double evaluations = 50.0; // of a start with gradients
    const scene::Fit& keys = *plan.scene.fit;
    const double all = evaluations * static_cast<double>(keys.search.starts);
    std::string text = fmt::format("  fit: {} start{}, about {:.0f} evaluations of the model",
                                   keys.search.starts, keys.search.starts == 1 ? "" : "s", all);
    if (!plan.fit_plan)
        return text + "; their time is known when the run has made the data\n";
    const fitting::Problem& problem = plan.fit_plan->problem;
    std::vector<double> start;
    for (const std::size_t i : fitting::free_parameters(problem))
        start.push_back(problem.parameters[i].start);
    const std::vector<double> values = fitting::all_values(problem, start);
    const auto rows = static_cast<Eigen::Index>(problem.residuals);
    Eigen::VectorXd residuals(rows);
    Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(rows, static_cast<Eigen::Index>(values.size()));
    const double each = seconds_of([&] { problem.evaluate(values, residuals, &jacobian); });
    return text + fmt::format(", {} residuals, about {:.2g} s\n", problem.residuals, all * each);
}

std::string field_cost(const scene::Scene& scene) {
    const elastic::Field field({scene.medium->eta, scene.medium->xi});
    double x = 0.0;
    const double point = seconds_of([&] {
        x = x > 3.0 ? 0.1 : x + 0.01;
        for (int i = 0; i < 100; ++i)
            field.at(x, 0.01 * i, {.displacement = true, .strain = true, .polar = true});
    });
    return fmt::format("  field maps: about {:.2g} s\n",
                       0.01 * point * static_cast<double>(scene.field->nx * scene.field->ny));
}

/// Further runs of a case, in draws of a measured field.
long samples_of(const scene::Scene& scene) {
    const bool measured = scene.medium && scene.medium->field == scene::FieldBackend::measured;
    return measured ? scene.medium->measured->samples : 0;
}

/// A run that is stopped when the measurement is over tells by how far it came.
std::string rods_cost(const Plan& plan) {
    const assembly::RodsPlan& first = plan.rods.front();
    rods::RodOptions options = first.options;
    double reached = 0.0;
    const auto start = now();
    options.ode.on_step = [&](const integrate::Step& step) { reached = step.time; };
    options.ode.stop_requested = [&] { return since(start) > budget; };
    const rods::RodResult result = rods::simulate(first.problem, options);
    const double seconds = since(start);
    if (!result.solution.status.ok() &&
        result.solution.status.termination != integrate::Termination::interrupted)
        return fmt::format("  rods: the solver gives up ({})\n", result.solution.status.message());
    const bool whole = result.solution.status.termination != integrate::Termination::interrupted;
    if (!whole && !(reached > 0.0))
        return fmt::format("  rods: a step takes more than {:.2g} s\n", seconds);
    const double each = whole ? seconds : seconds * first.problem.t_end / reached;
    double runs = 0.0;
    for (const assembly::RodsPlan& one : plan.rods)
        runs += 1.0 + static_cast<double>(samples_of(one.of.scene));
    return fmt::format(
        "  rods: about {:.2g} s{}{}\n", each * runs,
        first.of.scene.medium && first.of.scene.medium->measured
            ? ", and some for smoothing the measured field"
            : "",
        whole ? "" : fmt::format(" at the pace of the first {:.3g} of {:g}", reached, first.problem.t_end));
}

/// A few points spread over the scan stand for all.
double seconds_of_point(const assembly::ScanPlan& plan) {
    scan::Design spread = plan.design;
    if (spread.kind != scan::Kind::list)
        spread.kind = scan::Kind::sobol;
    spread.samples = 256;
    const scan::PointList points(spread);
    const scan::Evaluate evaluate = evaluate_rods(plan, nullptr);
    const double start = now();
    std::int64_t done = 0;
    while (done < points.size() && since(start) < budget) {
        const scan::Point one[] = {points[done++]};
        scan::Result result[1];
        evaluate(one, result);
    }
    return since(start) / static_cast<double>(done);
}

/// Of all runs, as dear as they are compared with the bed as written.
std::string bed_scan_cost(const Plan& plan) {
    const assembly::BedPlan& first = plan.beds.front();
    const scan::Design& design = plan.scan->design;
    const double one = seconds_of_step(first.problem) * steps_of(first);
    double all = 0.0;
    for (const double cost : design.costs)
        all += one * cost / assembly::sphere_steps(first.problem) * static_cast<double>(design.runs);
    const bool ends_early = first.schedule.stop_at_travel > 0.0;
    return fmt::format(
        "  scan: {} runs, about {:.2g} CPU seconds each (the bed as written), {:.2g} in all ({:.2g} "
        "hours){}\n  output of a run: {}\n",
        scan::size(design), one, all, all / 3600.0,
        ends_early ? "; less, as far as runs end at stop_at_travel" : "", assembly::describe_output(first));
}

std::string scan_cost(const assembly::ScanPlan& plan) {
    const double each = seconds_of_point(plan);
    double points = static_cast<double>(scan::size(plan.design));
    if (plan.design.kind == scan::Kind::adaptive) {
        points = 1.0;
        for (const scan::Axis& axis : plan.design.axes)
            points *= static_cast<double>(axis.count + 1);
    }
    return fmt::format("  scan: {:.2g} ms a point, {:.3g} points{}, about {:.2g} CPU seconds{}\n", 1e3 * each,
                       points, plan.design.kind == scan::Kind::adaptive ? " at the start" : "", each * points,
                       plan.design.kind == scan::Kind::adaptive ? ", and more where it refines" : "");
}

} // namespace

std::string expected_cost(const Plan& plan) {
    std::string text;
    if (plan.has(assembly::Stage::granular))
        text += bed_cost(plan);
    if (plan.has(assembly::Stage::measure) && !plan.has(assembly::Stage::granular))
        text += "  measures: about as long as reading the trajectory takes\n";
    if (plan.has(assembly::Stage::fit))
        text += fit_cost(plan);
    if (plan.has(assembly::Stage::field) && !plan.scene.field->x.empty())
        text += field_cost(plan.scene);
    if (plan.has(assembly::Stage::rods))
        text += rods_cost(plan);
    if (plan.scan)
        text += plan.scan->subject == scene::ScanSubject::beds ? bed_scan_cost(plan) : scan_cost(*plan.scan);
    return text.empty() ? "  nothing to compute\n" : text;
}

} // namespace rodwake::stages
