#include "rod_problem.hpp"

#include "bind.hpp"
#include "rodwake/app/plan.hpp"
#include "rodwake/app/scan_problem.hpp"
#include "rodwake/core/error.hpp"

#include <pybind11/functional.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <array>
#include <cstring>
#include <type_traits>

namespace rodwake::python {

namespace {

template<class Record>
py::bytes packed(std::span<const Record> records) {
    static_assert(std::is_trivially_copyable_v<Record>);
    return {reinterpret_cast<const char*>(records.data()), records.size_bytes()};
}

template<class Record>
std::vector<Record> unpacked(const py::bytes& bytes) {
    const std::string_view data = bytes;
    if (data.size() % sizeof(Record) != 0)
        throw InputError("points of a scan: " + std::to_string(data.size()) +
                         " bytes are no records; do all processes run the same version of rodwake?");
    std::vector<Record> records(data.size() / sizeof(Record));
    std::memcpy(records.data(), data.data(), data.size());
    return records;
}

/// What a process needs to evaluate points that it is sent. Pinned: the evaluator refers to the plan.
class PointEvaluator {
public:
    PointEvaluator(const scene::Scene& scene, const std::filesystem::path& folder)
        : plan_(app::make_plan(scene, std::array{app::Stage::scan})) {
        context_.threads = 1;
        evaluate_ = app::point_evaluator(*plan_.scan, folder, context_);
    }
    PointEvaluator(const PointEvaluator&) = delete;
    PointEvaluator& operator=(const PointEvaluator&) = delete;

    py::bytes operator()(const py::bytes& points) const {
        const std::vector<scan::Point> at = unpacked<scan::Point>(points);
        std::vector<scan::Result> results(at.size());
        {
            const py::gil_scoped_release release;
            evaluate_(at, results);
        }
        return packed<scan::Result>(results);
    }

private:
    app::Plan plan_;
    app::RunContext context_;
    scan::Evaluate evaluate_;
};

} // namespace

std::function<scan::Execute(scan::Evaluate, std::function<bool()> stop)>
executor_in_python(py::handle execute) {
    return [execute](const scan::Evaluate&, const std::function<bool()>& stop) {
        return [execute, stop](std::span<const scan::Point> points, const scan::Take& take) {
            const py::gil_scoped_acquire acquire;
            const auto stopped = [&] { return stop && stop(); };
            const auto taken = [&](const py::bytes& results) {
                const std::vector<scan::Result> records = unpacked<scan::Result>(results);
                const py::gil_scoped_release release; // the ledger writes to disk
                take(records);
            };
            execute(packed<scan::Point>(points), py::cpp_function(taken), py::cpp_function(stopped));
            return !stopped();
        };
    };
}

void bind_scan(py::module_& module) {
    module.attr("point_size") = sizeof(scan::Point);
    py::class_<PointEvaluator>(module, "PointEvaluator")
        .def(py::init<const scene::Scene&, const std::filesystem::path&>())
        .def("__call__", &PointEvaluator::operator());
}

} // namespace rodwake::python
