// Work of a scene that `rodwake tradeoff` times (commands/rodwake_commands/tradeoff*.py): prepared once, done
// again and again on the calling thread. Which settings are compared, and how, is decided in Python.

#include "arrays.hpp"
#include "bind.hpp"
#include "rodwake/app/run.hpp"
#include "rodwake/app/run_folder.hpp"
#include "rodwake/app/scan_problem.hpp"
#include "rodwake/app/wake_tables.hpp"
#include "rodwake/core/build_info.hpp"
#include "rodwake/core/stopwatch.hpp"
#include "rodwake/store/atomic_file.hpp"
#include "signals.hpp"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <cmath>

namespace rodwake::python {

namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

struct WakeFieldHandle {
    std::shared_ptr<const elastic::WakeField> field;
};

Array table_of(std::vector<double>&& values, std::size_t rows) {
    const auto columns = rows ? values.size() / rows : 0;
    return array_of(std::move(values), {static_cast<py::ssize_t>(rows), static_cast<py::ssize_t>(columns)});
}

/// The rods of a scene, or a thousand points of its scan: an LHS design between the ends of the axes, or the
/// first rows of its list.
class RodsWork {
public:
    RodsWork(scene::Scene scene, const fs::path& folder, const WakeFieldHandle* field) {
        context_.threads = 1;
        context_.stop = [this] { return interrupt_() || Clock::now() > deadline_; };
        if (!scene.scan) {
            problem_ = app::rod_problem(scene);
            const bool interact = problem_.couplings.any() && (problem_.rods.size() > 1 || problem_.box);
            if (field && problem_.medium && interact)
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
        design.samples = 1000;
        const scan::PointList list(design);
        for (std::int64_t k = 0; k < std::min<std::int64_t>(list.size(), design.samples); ++k)
            points_.push_back(list[k]);
    }
    RodsWork(const RodsWork&) = delete;
    RodsWork& operator=(const RodsWork&) = delete;

    /// CPU seconds and results of one solve, which gives up after `limit` seconds.
    py::dict solve(double limit) {
        std::vector<scan::Result> points(points_.size());
        rods::RodResult run;
        double seconds = 0.0;
        interrupt_ = Interrupt();
        deadline_ = Clock::now() + std::chrono::milliseconds(std::llround(1e3 * std::min(limit, 1e9)));
        {
            const py::gil_scoped_release release;
            const Stopwatch watch;
            if (evaluate_)
                evaluate_(points_, points);
            else
                run = rods::simulate(problem_, options_);
            seconds = watch.seconds();
        }
        interrupt_.rethrow();
        py::dict answer;
        answer["seconds"] = seconds;
        if (!evaluate_) {
            const integrate::Status& status = run.solution.status;
            std::vector<double> path;
            for (const std::vector<double>& state : run.solution.states)
                path.insert(path.end(), state.begin(), state.end());
            answer["stopped"] = status.termination == integrate::Termination::interrupted;
            answer["failure"] = status.ok() ? "" : "failed: " + status.flag;
            answer["ending"] = static_cast<int>(run.outcome.ending);
            answer["time"] = run.outcome.time;
            answer["rhs_evaluations"] = run.solution.statistics.rhs_evaluations;
            answer["final_state"] = table_of(std::vector(run.solution.final_state), 1);
            answer["path"] = table_of(std::move(path), run.solution.states.size());
            return answer;
        }
        std::vector<double> values, good, ending;
        for (const scan::Result& point : points) {
            const auto last =
                static_cast<std::ptrdiff_t>(plan_.scan->columns.observables.size()) + point.values.begin();
            values.insert(values.end(), point.values.begin(), last);
            good.push_back(point.ok());
            ending.push_back(point.outcome);
        }
        answer["stopped"] = std::ranges::any_of(
            points, [](const scan::Result& point) { return point.status == scan::Status::stopped; });
        answer["failure"] = "";
        answer["solved"] = table_of(std::move(good), points.size());
        answer["ending"] = table_of(std::move(ending), points.size());
        answer["values"] = table_of(std::move(values), points.size());
        return answer;
    }

    double stiffness() const { return rods::stiffness(problem_); }
    /// The points of a scan, as records of _core.point_size bytes.
    py::bytes sample() const {
        return {reinterpret_cast<const char*>(points_.data()), points_.size() * sizeof(scan::Point)};
    }
    /// Names of the columns of `values`, and what a unit of lengths and of times in them is.
    py::tuple columns() const {
        const app::OutputUnits units = app::output_units(plan_.scan->base);
        return py::make_tuple(plan_.scan->columns.observables, units.length, units.time);
    }

private:
    app::RunContext context_;
    Interrupt interrupt_;
    Clock::time_point deadline_;
    rods::RodProblem problem_;
    rods::RodOptions options_;
    app::Plan plan_;          ///< of a scan, as what follows
    scan::Evaluate evaluate_; ///< empty: a run
    std::vector<scan::Point> points_;
};

/// CPU seconds of the map of one rod, and displacement, strain and polar vectors at (x, y): nine numbers a
/// point, NaN at the rod.
py::tuple timed_map(const WakeFieldHandle& handle, const scene::Scene& scene, const Array& x, const Array& y,
                    double budget) {
    const auto wake = handle.field->wake(0.0);
    std::vector<elastic::FieldValues> values(static_cast<std::size_t>(x.size()));
    std::vector<std::size_t> regular;
    for (std::size_t i = 0; i < values.size(); ++i)
        if (!elastic::is_singular(x.data()[i], y.data()[i], scene.medium->periodic))
            regular.push_back(i);
    const auto map = [&] {
        for (const std::size_t i : regular)
            values[i] =
                wake->at(x.data()[i], y.data()[i], {.displacement = true, .strain = true, .polar = true});
    };
    const double seconds = seconds_of(map, budget);
    std::vector<double> rows(9 * values.size(), NAN);
    for (const std::size_t i : regular) {
        const auto& [u, e, l, g] = std::tie(values[i].displacement, values[i].strain, values[i].laplacian,
                                            values[i].gradient_of_trace);
        const double row[] = {u.x, u.y, e.xx, e.xy, e.yy, l.x, l.y, g.x, g.y};
        std::ranges::copy(row, &rows[9 * i]);
    }
    return py::make_tuple(seconds, table_of(std::move(rows), values.size()));
}

} // namespace

void bind_tradeoff(py::module_& module) {
    py::class_<WakeFieldHandle>(module, "WakeField")
        .def(py::init([](const scene::Scene& scene, const fs::path& folder) {
            return WakeFieldHandle{app::wake_field(scene, folder)};
        }));
    py::class_<RodsWork>(module, "RodsWork")
        .def(py::init<scene::Scene, const fs::path&, const WakeFieldHandle*>())
        .def("solve", &RodsWork::solve)
        .def("columns", &RodsWork::columns)
        .def_property_readonly("stiffness", &RodsWork::stiffness)
        .def_property_readonly("sample", &RodsWork::sample);
    py::class_<app::FolderLock>(module, "FolderLock").def(py::init<const fs::path&>());
    module.def("timed_map", &timed_map);
    module.def("refuse_link", &app::refuse_link);
    module.def("write_atomically", &store::write_atomically);
    module.def("write_manifest", &app::write_manifest);
    module.def("bed_time_step", [](const scene::Scene& scene) { return scene::time_step(*scene.granular); });
    module.def("apply_seed", [](scene::Scene scene, std::uint64_t seed) {
        app::apply_seed(scene, seed);
        return scene;
    });
    module.attr("cpu") = cpu_model();
}

} // namespace rodwake::python
