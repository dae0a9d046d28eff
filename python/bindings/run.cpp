// Runs of scenes: on a thread of their own, so that Python hears of their progress and they of Ctrl-C.

#include "rodwake/app/run.hpp"
#include "bind.hpp"
#include "rod_problem.hpp"
#include "rodwake/app/convert.hpp"
#include "rodwake/app/run_folder.hpp"
#include "rodwake/core/error.hpp"
#include "signals.hpp"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <atomic>
#include <map>
#include <mutex>

namespace rodwake::python {

namespace {

namespace fs = std::filesystem;
using app::Stage;
using Words = std::vector<std::string>;

/// Of those that the scene has the ones with these names, in the order in which they are done.
std::vector<Stage> stages_of(const scene::Scene& scene, const std::optional<Words>& names) {
    std::vector<Stage> all = app::stages_of(scene);
    if (!names)
        return all;
    const auto named = [](const std::string& name) {
        return [&name](Stage stage) { return name == app::to_string(stage); };
    };
    for (const std::string& name : *names)
        if (std::ranges::none_of(all, named(name)))
            throw InputError(scene.path + ": has no stage '" + name +
                             "'; Scene.stages lists those that it has");
    std::erase_if(
        all, [&](Stage stage) { return std::ranges::find(*names, app::to_string(stage)) == names->end(); });
    return all;
}

/// What a run says while it works, kept for the thread that has the interpreter.
class Reports {
public:
    struct Progress {
        std::string what, unit;
        double value, end;
    };

    void log(app::Severity severity, const std::string& message) {
        const std::lock_guard lock(mutex_);
        messages_.emplace_back(severity, message);
    }
    void progress(const app::ProgressReport& report) {
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
    std::vector<std::pair<app::Severity, std::string>> messages_;
    std::optional<Progress> progress_;
};

app::RunContext context_of(std::size_t threads, std::optional<std::uint64_t> seed, bool force,
                           Reports& reports, const std::atomic<bool>& stopped) {
    app::RunContext context;
    context.threads = threads;
    context.seed = seed;
    context.force = force;
    context.log = [&](app::Severity severity, const std::string& text) { reports.log(severity, text); };
    context.progress = [&](const app::ProgressReport& report) { reports.progress(report); };
    context.stop = [&] { return stopped.load(); };
    return context;
}

std::string name_of(app::StageEnd end) {
    switch (end) {
    case app::StageEnd::finished:
        return "finished";
    case app::StageEnd::failed:
        return "failed";
    case app::StageEnd::interrupted:
        return "interrupted";
    case app::StageEnd::incomplete:
        break;
    }
    return "incomplete";
}

std::string run(const scene::Scene& scene, const fs::path& folder, const std::optional<Words>& names,
                std::size_t threads, std::optional<std::uint64_t> seed, bool force,
                const std::string& command, const py::object& on_log, const py::object& on_progress,
                const py::object& execute, const Words& converter) {
    Reports reports;
    std::atomic<bool> stopped = false;
    app::RunContext context = context_of(threads, seed, force, reports, stopped);
    context.command = command;
    context.converter = converter;
    if (!execute.is_none())
        context.executor = executor_in_python(execute);
    const std::vector<Stage> stages = stages_of(scene, names);
    app::StageEnd end = app::StageEnd::failed;
    const auto work = [&] {
        try {
            end = app::run(app::plan_run(scene, stages, folder, context), folder, context);
        } catch (const app::FinishedRun&) {
            end = app::StageEnd::finished;
        }
    };
    attended(
        work, [&] { reports.deliver(on_log, on_progress); }, [&] { stopped = true; });
    return name_of(end);
}

/// Raises KeyboardInterrupt after Ctrl-C.
void convert(const fs::path& source, const fs::path& target, const std::string& frames,
             const std::string& unit, const std::string& rods, const std::string& group,
             const std::map<std::string, std::string>& columns, const Words& rod_kinds,
             const std::string& time_column, bool force, const Words& converter, const py::object& on_log,
             const py::object& on_progress) {
    app::ConvertRequest request;
    request.in = source;
    request.out = target;
    request.frames = frames;
    request.unit = unit;
    request.rods = rods;
    request.group = group;
    request.columns.rod_kinds = rod_kinds;
    request.columns.time = time_column;
    for (const auto& [role, name] : columns)
        app::name_column(request, role, name);
    request.force = force;
    Reports reports;
    std::atomic<bool> stopped = false;
    app::RunContext context = context_of(1, {}, force, reports, stopped);
    context.converter = converter;
    attended([&] { app::convert(request, context); }, [&] { reports.deliver(on_log, on_progress); },
             [&] { stopped = true; });
}

} // namespace

void bind_run(py::module_& module) {
    module.def("run", &run);
    module.def("convert", &convert);
    module.def("manifest", [](const fs::path& folder) { return app::manifest_json(folder); });
}

} // namespace rodwake::python
