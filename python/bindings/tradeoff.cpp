// Work of a scene that `rodwake tradeoff` times (commands/rodwake_commands/tradeoff*.py): prepared once, done
// again and again on the calling thread. Which settings are compared, and how, is decided in Python.

#include "arrays.hpp"
#include "bind.hpp"
#include "rodwake/app/fit.hpp"
#include "rodwake/app/run.hpp"
#include "rodwake/app/run_folder.hpp"
#include "rodwake/app/scan_problem.hpp"
#include "rodwake/app/wake_tables.hpp"
#include "rodwake/core/build_info.hpp"
#include "rodwake/core/stopwatch.hpp"
#include "rodwake/fitting/report.hpp"
#include "signals.hpp"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <atomic>
#include <cmath>

namespace rodwake::python {

namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using Field = std::shared_ptr<const elastic::WakeField>;

struct WakeFieldHandle {
    Field field;
};

/// How a solve ended: a row for the run, or for each point of the sample of a scan.
struct Encounters {
    std::vector<double> solved, ending, contact_time, final_state, path;
    long rhs_evaluations = 0;
    std::string failure;

    void add(bool ok, Ending end, double time) {
        solved.push_back(ok);
        ending.push_back(static_cast<double>(end));
        contact_time.push_back(end == Ending::contact ? time : NAN);
    }
};

/// The rods of a scene, or a thousand points of its scan: an LHS design between the ends of the axes, or the
/// first rows of its list.
class RodsWork {
public:
    RodsWork(scene::Scene scene, const fs::path& folder, const WakeFieldHandle* field) {
        context_.threads = 1;
        context_.stop = [this] { return interrupt_() || Clock::now() > deadline_; };
        if (!scene.scan) {
            problem_ = app::rod_problem(scene);
            if (field && problem_.medium && problem_.couplings.any() &&
                (problem_.rods.size() > 1 || problem_.box))
                problem_.field = field->field;
            options_ = app::rod_options(*scene.rods_run, problem_);
            options_.ode.stop_requested = context_.stop;
            return;
        }
        constexpr app::Stage stage[] = {app::Stage::scan};
        plan_ = app::plan_run(std::move(scene), stage, folder, {});
        evaluate_ = app::point_evaluator(*plan_.scan, folder, context_);
        scan::Design design = plan_.scan->design;
        design.runs = 0;
        design.costs.clear();
        design.kind = design.kind == scan::Kind::list ? design.kind : scan::Kind::lhs;
        design.samples = sampled;
        const scan::PointList list(design);
        for (std::int64_t k = 0; k < std::min<std::int64_t>(list.size(), sampled); ++k)
            points_.push_back(list[k]);
    }
    RodsWork(const RodsWork&) = delete;
    RodsWork& operator=(const RodsWork&) = delete;

    /// CPU seconds and results of one solve, given up after `limit` seconds.
    py::dict solve(double limit) {
        Encounters found;
        double seconds = 0.0;
        interrupt_ = Interrupt();
        deadline_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                       std::chrono::duration<double>(std::min(limit, 1e9)));
        {
            const py::gil_scoped_release release;
            const Stopwatch watch;
            if (evaluate_) {
                std::vector<scan::Result> results(points_.size());
                evaluate_(points_, results);
                seconds = watch.seconds();
                found = of_points(results);
            } else {
                const rods::RodResult run = rods::simulate(problem_, options_);
                seconds = watch.seconds();
                found = of_run(run);
            }
        }
        interrupt_.rethrow();
        const auto rows = static_cast<py::ssize_t>(found.solved.size());
        const auto table = [](std::vector<double>& values, py::ssize_t count) {
            const auto columns = count ? static_cast<py::ssize_t>(values.size()) / count : 0;
            return array_of(std::move(values), {count, columns});
        };
        const auto states = static_cast<py::ssize_t>(found.path.size() / std::max<std::size_t>(width(), 1));
        py::dict answer;
        answer["seconds"] = seconds;
        answer["rhs_evaluations"] = found.rhs_evaluations;
        answer["failure"] = found.failure;
        answer["solved"] = array_of(std::move(found.solved), {rows});
        answer["ending"] = array_of(std::move(found.ending), {rows});
        answer["contact_time"] = array_of(std::move(found.contact_time), {rows});
        answer["final_state"] = table(found.final_state, rows);
        answer["path"] = table(found.path, states);
        return answer;
    }

    std::size_t points() const { return points_.size(); }
    double stiffness() const { return rods::stiffness(problem_); }
    /// What tells samples of scans apart: the values on the axes.
    py::bytes sample() const {
        return {reinterpret_cast<const char*>(points_.data()), points_.size() * sizeof(scan::Point)};
    }

private:
    static constexpr long sampled = 1000;
    static constexpr const char* too_long = "took too long";

    std::size_t width() const { return 3 * problem_.rods.size(); }

    static Encounters of_run(const rods::RodResult& run) {
        const integrate::Status& status = run.solution.status;
        const bool interrupted = status.termination == integrate::Termination::interrupted;
        Encounters found;
        found.add(status.ok() && !interrupted, run.outcome.ending, run.outcome.time);
        found.final_state = run.solution.final_state;
        for (const std::vector<double>& state : run.solution.states)
            found.path.insert(found.path.end(), state.begin(), state.end());
        found.rhs_evaluations = run.solution.statistics.rhs_evaluations;
        found.failure = interrupted ? too_long : status.ok() ? "" : "failed: " + status.flag;
        return found;
    }

    /// The state of a point is its last separation and how far each rod turned.
    Encounters of_points(const std::vector<scan::Result>& results) const {
        const std::vector<std::string>& names = plan_.scan->columns.observables;
        const app::OutputUnits units = app::output_units(plan_.scan->base);
        Encounters found;
        for (const scan::Result& point : results) {
            double time = NAN, separation = NAN;
            std::vector<double> turns;
            for (std::size_t k = 0; k < names.size(); ++k) {
                if (names[k] == "time")
                    time = point.values[k] / units.time;
                else if (names[k] == "final_separation")
                    separation = point.values[k] / units.length;
                else if (names[k].starts_with("turn"))
                    turns.push_back(point.values[k]);
                else if (names[k] == "rhs_evaluations" && point.ok())
                    found.rhs_evaluations += static_cast<long>(point.values[k]);
            }
            found.add(point.ok(), static_cast<Ending>(point.outcome), time);
            found.final_state.push_back(separation);
            found.final_state.insert(found.final_state.end(), turns.begin(), turns.end());
            if (point.status == scan::Status::stopped)
                found.failure = too_long;
        }
        return found;
    }

    app::RunContext context_;
    Interrupt interrupt_;
    Clock::time_point deadline_;
    rods::RodProblem problem_;
    rods::RodOptions options_;
    app::Plan plan_;
    scan::Evaluate evaluate_; ///< of a scan
    std::vector<scan::Point> points_;
};

/// The fit of a scene as [fit] has it, its data read from `folder` or beside the scene.
class FitWork {
public:
    FitWork(const scene::Scene& scene, const fs::path& folder)
        : plan_(app::fit_plan(*scene.fit, app::read_fit_inputs(scene, folder, app::OwnFiles::required))) {}

    std::vector<std::string> free() const {
        std::vector<std::string> names;
        for (const std::size_t i : fitting::free_parameters(plan_.problem))
            names.push_back(plan_.problem.parameters[i].name);
        return names;
    }
    /// Every free parameter has both bounds.
    bool bounded() const {
        return std::ranges::all_of(plan_.problem.parameters, [](const fitting::Parameter& p) {
            return !p.free() || (std::isfinite(p.lower) && std::isfinite(p.upper));
        });
    }
    /// What tells data apart: the residuals at the start of the search.
    Array residuals() const {
        std::vector<double> start;
        for (const fitting::Parameter& parameter : plan_.problem.parameters)
            start.push_back(parameter.start);
        Eigen::VectorXd r(static_cast<Eigen::Index>(plan_.problem.residuals));
        plan_.problem.evaluate(start, r, nullptr);
        return array_of({r.begin(), r.end()}, {static_cast<py::ssize_t>(r.size())});
    }

    /// CPU seconds of search, report and profile likelihoods, and the free parameters: value, standard error
    /// and both ends of the 95 % interval, a row each.
    py::tuple solve(std::size_t threads, double limit) const {
        std::vector<double> rows;
        std::string failure;
        double seconds = 0.0, objective = HUGE_VAL;
        std::atomic<bool> stopped = false;
        const auto work = [&] {
            const Stopwatch watch;
            fitting::Method method = plan_.method;
            method.threads = std::max<std::size_t>(threads, 1);
            method.stop_requested = [&] { return stopped || watch.seconds() > limit; };
            const fitting::Fit fit = fitting::fit(plan_.problem, method);
            if (fit.termination == fitting::Termination::failed)
                failure = "failed: " + fit.reason;
            else if (fit.termination != fitting::Termination::interrupted) {
                objective = fit.objective;
                const fitting::Report report = fitting::report(plan_.problem, fit);
                for (const std::size_t i : fitting::free_parameters(plan_.problem)) {
                    const fitting::Estimate& e = report.estimates[i];
                    double low = e.low, high = e.high;
                    if (std::ranges::count(plan_.keys.likelihood, e.name)) {
                        const auto profile = fitting::profile_likelihood(plan_.problem, method, fit, i);
                        low = profile.low.value_or(-HUGE_VAL);
                        high = profile.high.value_or(HUGE_VAL);
                    }
                    rows.insert(rows.end(),
                                {e.value, has_error(report, e) ? e.standard_error : HUGE_VAL, low, high});
                }
            }
            seconds = watch.seconds();
        };
        attended(
            work, [] {}, [&] { stopped = true; });
        const auto count = static_cast<py::ssize_t>(rows.size() / 4);
        return py::make_tuple(seconds, failure, objective, array_of(std::move(rows), {count, 4}));
    }

private:
    app::FitPlan plan_;
};

/// Displacement, strain and polar vectors of one rod at (x, y), nine numbers a point and NaN at the rod; and
/// CPU seconds of the map.
py::tuple timed_map(const WakeFieldHandle& handle, const scene::Scene& scene, const Array& x, const Array& y,
                    double budget) {
    const auto wake = handle.field->wake(0.0);
    std::vector<elastic::FieldValues> values(static_cast<std::size_t>(x.size()));
    std::vector<std::size_t> regular;
    for (std::size_t i = 0; i < values.size(); ++i)
        if (!elastic::is_singular(x.data()[i], y.data()[i], scene.medium->periodic))
            regular.push_back(i);
    const double seconds = seconds_of(
        [&] {
            for (const std::size_t i : regular)
                values[i] =
                    wake->at(x.data()[i], y.data()[i], {.displacement = true, .strain = true, .polar = true});
        },
        budget);
    std::vector<double> rows(9 * values.size(), NAN);
    for (const std::size_t i : regular) {
        const elastic::FieldValues& f = values[i];
        std::ranges::copy(std::initializer_list<double>{f.displacement.x, f.displacement.y, f.strain.xx,
                                                        f.strain.xy, f.strain.yy, f.laplacian.x,
                                                        f.laplacian.y, f.gradient_of_trace.x,
                                                        f.gradient_of_trace.y},
                          rows.begin() + static_cast<std::ptrdiff_t>(9 * i));
    }
    return py::make_tuple(seconds, array_of(std::move(rows), {x.size(), 9}));
}

} // namespace

void bind_tradeoff(py::module_& module) {
    py::class_<RodsWork>(module, "RodsWork")
        .def(py::init<scene::Scene, const fs::path&, const WakeFieldHandle*>(), py::arg("scene"),
             py::arg("folder"), py::arg("field") = nullptr)
        .def("solve", &RodsWork::solve)
        .def_property_readonly("points", &RodsWork::points)
        .def_property_readonly("stiffness", &RodsWork::stiffness)
        .def_property_readonly("sample", &RodsWork::sample);
    py::class_<FitWork>(module, "FitWork")
        .def(py::init<const scene::Scene&, const fs::path&>())
        .def_property_readonly("free", &FitWork::free)
        .def_property_readonly("bounded", &FitWork::bounded)
        .def("residuals", &FitWork::residuals)
        .def("solve", &FitWork::solve);
    py::class_<WakeFieldHandle>(module, "WakeField")
        .def(py::init([](const scene::Scene& scene, const fs::path& folder) {
            return WakeFieldHandle{app::wake_field(scene, folder)};
        }));
    module.def("timed_map", &timed_map);
    module.def("bed_time_step", [](const scene::Scene& scene) { return scene::time_step(*scene.granular); });
    module.def("apply_seed", [](scene::Scene scene, std::uint64_t seed) {
        app::apply_seed(scene, seed);
        return scene;
    });
    py::class_<app::FolderLock>(module, "FolderLock").def(py::init<const fs::path&>());
    module.def("refuse_link", &app::refuse_link);
    module.def("write_manifest", &app::write_manifest);
    module.attr("cpu") = cpu_model();
}

} // namespace rodwake::python
