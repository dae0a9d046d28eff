// Scenes: read, written, described.

#include "bind.hpp"
#include "rodwake/app/describe.hpp"
#include "rodwake/app/run.hpp"
#include "rodwake/core/spelling.hpp"
#include "rodwake/scene/read.hpp"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

namespace rodwake::python {

namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

Words stage_names(const scene::Scene& scene) {
    Words names;
    for (const app::Stage stage : app::stages_of(scene))
        names.emplace_back(app::to_string(stage));
    return names;
}

std::string check(const scene::Scene& scene, const fs::path& folder, std::size_t threads, bool cost,
                  const Words& converter) {
    app::RunContext context;
    context.threads = threads;
    context.converter = converter;
    const py::gil_scoped_release release;
    const app::Plan plan = app::plan_check(scene, folder, context);
    const std::vector<app::PlanLine> lines = app::describe(plan);
    std::string modelled, left_out;
    for (const app::PlanLine& line : lines)
        (line.modelled ? modelled : left_out) += "  " + line.text + "\n";
    std::string text = "modelled\n" + modelled + "\nnot modelled\n" + left_out;
    if (cost)
        text += "\nexpected cost\n" + app::expected_cost(plan, folder, context) + "\n";
    return printable(text);
}

} // namespace

void bind_scene(py::module_& module) {
    py::class_<scene::Scene>(module, "Scene")
        .def_property_readonly("path",
                               [](const scene::Scene& scene) {
                                   return py::reinterpret_steal<py::str>(
                                       PyUnicode_DecodeFSDefault(scene.path.c_str()));
                               })
        .def_readonly("title", &scene::Scene::title)
        .def("stages", &stage_names)
        .def("to_toml", &scene::to_toml);
    module.def("read_scene",
               [](const fs::path& path, const Words& set) { return scene::read_scene(path, set); });
    module.def("parse_scene", [](const std::string& text, const fs::path& name, const Words& set) {
        return scene::parse_scene(text, name.string(), set);
    });
    module.def("check", &check);
}

} // namespace rodwake::python
