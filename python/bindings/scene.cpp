// Scenes: read, described, and run stage by stage as the program does it.

#include "bind.hpp"
#include "rodwake/assembly/describe.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/scene/read.hpp"
#include "rodwake/scene/write.hpp"
#include "rodwake/stages/run.hpp"
#include "signals.hpp"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <atomic>
#include <mutex>

namespace rodwake::python {

namespace {

namespace fs = std::filesystem;
using assembly::Stage;
using Words = std::vector<std::string>;

constexpr Stage all_stages[] = {Stage::granular, Stage::measure, Stage::fit,  Stage::field,
                                Stage::rods,     Stage::order,   Stage::scan, Stage::tradeoff};

Words names_of(const std::vector<Stage>& stages) {
    Words names;
    for (const Stage stage : stages)
        names.emplace_back(assembly::to_string(stage));
    return names;
}

std::vector<Stage> stages_of(const scene::Scene& scene, const std::optional<Words>& names) {
    const std::vector<Stage> named = assembly::stages_of(scene);
    if (!names)
        return named;
    std::vector<Stage> stages;
    for (const Stage stage : all_stages) // in the order in which they are done
        if (std::ranges::find(*names, assembly::to_string(stage)) != names->end())
            stages.push_back(stage);
    for (const std::string& name : *names)
        if (const Words known = names_of(named); std::ranges::find(known, name) == known.end())
            throw InputError(scene.path + ": has no stage '" + name +
                             "'; Scene.stages lists those that it has");
    return stages;
}

/// What a run says while it works, kept for the thread that has the interpreter.
class Reports {
public:
    struct Progress {
        std::string what, unit;
        double value, end;
    };

    void log(stages::Severity severity, const std::string& message) {
        const std::lock_guard lock(mutex_);
        messages_.emplace_back(severity, message);
    }
    void progress(const stages::ProgressReport& report) {
        const std::lock_guard lock(mutex_);
        progress_ = Progress{std::string(report.what), std::string(report.unit), report.value, report.end};
    }

    /// on_log(level, message), on_progress(what, value, end, unit): with the interpreter.
    void deliver(const py::object& on_log, const py::object& on_progress) {
        std::unique_lock lock(mutex_);
        const auto messages = std::exchange(messages_, {});
        const auto progress = std::exchange(progress_, std::nullopt);
        lock.unlock();
        constexpr int levels[] = {10, 20, 30, 40}; // of the module logging: debug, info, warning, error
        for (const auto& [severity, message] : messages)
            on_log(levels[static_cast<int>(severity)], message);
        if (progress && !on_progress.is_none())
            on_progress(progress->what, progress->value, progress->end, progress->unit);
    }

private:
    std::mutex mutex_;
    std::vector<std::pair<stages::Severity, std::string>> messages_;
    std::optional<Progress> progress_;
};

stages::RunContext context_of(std::size_t threads, std::optional<std::uint64_t> seed, bool force,
                              Reports& reports, const std::atomic<bool>& stopped) {
    stages::RunContext context;
    context.threads = threads;
    context.seed = seed;
    context.force = force;
    context.log = [&](stages::Severity severity, const std::string& text) { reports.log(severity, text); };
    context.progress = [&](const stages::ProgressReport& report) { reports.progress(report); };
    context.stop = [&] { return stopped.load(); };
    return context;
}

std::string name_of(stages::StageEnd end) {
    switch (end) {
    case stages::StageEnd::finished:
        return "finished";
    case stages::StageEnd::failed:
        return "failed";
    case stages::StageEnd::interrupted:
        return "interrupted";
    case stages::StageEnd::incomplete:
        break;
    }
    return "incomplete";
}

std::string run(const scene::Scene& scene, const fs::path& folder, const std::optional<Words>& names,
                std::size_t threads, std::optional<std::uint64_t> seed, bool force,
                const std::string& command, const py::object& on_log, const py::object& on_progress) {
    Reports reports;
    std::atomic<bool> stopped = false;
    stages::RunContext context = context_of(threads, seed, force, reports, stopped);
    context.command = command;
    const std::vector<Stage> stages = stages_of(scene, names);
    stages::StageEnd end = stages::StageEnd::failed;
    const auto work = [&] {
        end = stages::run(stages::plan_run(scene, stages, folder, context), folder, context);
    };
    attended(
        work, [&] { reports.deliver(on_log, on_progress); }, [&] { stopped = true; });
    return name_of(end);
}

std::string check(const scene::Scene& scene, const fs::path& folder, std::size_t threads, bool cost) {
    stages::RunContext context;
    context.threads = threads;
    const py::gil_scoped_release release;
    const assembly::Plan plan = stages::plan_check(scene, folder, context);
    const std::vector<assembly::PlanLine> lines = assembly::describe(plan);
    std::string modelled, left_out;
    for (const assembly::PlanLine& line : lines)
        (line.modelled ? modelled : left_out) += "  " + line.text + "\n";
    std::string text = "modelled\n" + modelled + "\nnot modelled\n" + left_out;
    if (cost)
        text += "\nexpected cost\n" + stages::expected_cost(plan, folder, context) + "\n";
    return text;
}

} // namespace

void bind_scene(py::module_& module) {
    py::class_<scene::Scene>(module, "Scene")
        .def_readonly("path", &scene::Scene::path)
        .def_readonly("title", &scene::Scene::title)
        .def("stages", [](const scene::Scene& scene) { return names_of(assembly::stages_of(scene)); })
        .def("to_toml", &scene::to_toml);
    module.def("read_scene",
               [](const fs::path& path, const Words& set) { return scene::read_scene(path, set); });
    module.def("parse_scene", [](const std::string& text, const std::string& name, const Words& set) {
        return scene::parse_scene(text, name, set);
    });
    module.def("check", &check);
    module.def("run", &run);
}

} // namespace rodwake::python
