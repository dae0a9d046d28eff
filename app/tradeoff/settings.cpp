// The ways to solve the rods of a scene: which settings it allows, and the keys that stand for each.

#include "rodwake/app/tradeoff.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/integrate/ode.hpp"
#include "rodwake/rods/separation_record.hpp"
#include "rodwake/scene/scan.hpp"
#include "rodwake/scene/scene.hpp"

#include <fmt/format.h>

namespace rodwake::app {

namespace {

using elastic::Accuracy;
using integrate::Method;
using rods::Form;
using scene::FieldBackend;

/// Newton's dense matrix: beyond this an implicit step costs more than any number of explicit ones.
constexpr std::size_t most_implicit = 320;
constexpr std::size_t least_for_precision = 8; ///< rods whose wakes are added up in tiles

/// rods_run.rtol, each decade.
constexpr double tolerances[] = {1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11};

std::string name_of(Method method) { return integrate::to_string(method); }
std::string name_of(Form form) { return rods::to_string(form); }
std::string name_of(FieldBackend field) {
    return field == FieldBackend::exact ? "exact" : field == FieldBackend::table ? "table" : "measured";
}
std::string name_of(Accuracy precision) {
    return precision == Accuracy::full ? "full" : precision == Accuracy::fine ? "fine" : "single";
}

/// The value whose name this is.
template<class Value>
Value named(const std::string& name, std::initializer_list<Value> values) {
    for (const Value value : values)
        if (name_of(value) == name)
            return value;
    throw InputError("\"" + name + "\" is unknown");
}

/// How the field is worked out, and the tolerances of the solver that go with its error.
struct FieldWay {
    FieldBackend field = FieldBackend::exact;
    double table_tolerance = 0.0;
    Accuracy precision = Accuracy::full;
    double loosest = 1.0, tightest = 0.0;

    /// Decades that differ from a bound by rounding count.
    bool suits(double tolerance) const { return tolerance <= loosest * 1.5 && tolerance >= tightest / 1.5; }
};

std::vector<FieldWay> field_ways(const scene::Scene& scene) {
    if (scene.medium && scene.medium->field == FieldBackend::measured)
        return {{.field = FieldBackend::measured}};
    std::vector<FieldWay> ways{{}};
    if (!scene.medium)
        return ways;
    if (!scene.medium->periodic && scene.rods.size() >= least_for_precision) {
        ways.push_back({.precision = Accuracy::fine, .loosest = 1e-5, .tightest = 1e-9});
        ways.push_back({.precision = Accuracy::single, .loosest = 1e-2, .tightest = 1e-6});
    }
    const bool square = !scene.medium->periodic || scene.medium->periodic->square(); // tables know no other
    if (!scene.scan && square) // scans take the exact field only
        for (const double T : {1e-4, 1e-6, 1e-8})
            ways.push_back({FieldBackend::table, T, Accuracy::full, 10.0 * T, 0.1 * T});
    return ways;
}

struct Solver {
    std::string method;
    Form form;
};

std::vector<Solver> solvers(const scene::Scene& scene) {
    std::vector<Solver> all;
    if (scene.scan) // pairs many at a time
        all.push_back({"auto", Form::angle});
    for (const auto& [method, form] : {std::pair{Method::erk, Form::angle},
                                       {Method::adams, Form::angle},
                                       {Method::erk, Form::director},
                                       {Method::bdf, Form::angle},
                                       {Method::bdf, Form::director},
                                       {Method::bdf, Form::dae}})
        if (method != Method::bdf || rods::state_size(form, scene.rods.size()) <= most_implicit)
            all.push_back({name_of(method), form});
    return all;
}

void refuse_axes(const scene::Scene& scene) {
    for (const scene::ScanAxis& axis : scene.scan->axes)
        for (const std::string& key : axis.keys.empty() ? std::vector<std::string>{axis.key} : axis.keys)
            if (key.starts_with("rods_run.") && key != "rods_run.t_end" && key != "rods_run.contact_distance")
                throw InputError(
                    fmt::format("{}: the scan varies {}, which rodwake tradeoff chooses: leave this "
                                "axis out",
                                scene.path, key));
}

/// What nobody has asked for is not there to be chosen.
void require_rods(const scene::Scene& scene) {
    if (!scene.rods_run)
        throw InputError(scene.path +
                         ": no [rods_run] table, so there are no rods whose cost and error could be "
                         "measured; --of bed, fit or field trades another part of the scene");
    if (scene.medium && scene.medium->fitted)
        throw InputError(scene.path +
                         ": medium.fitted = true takes eta and xi from [fit]: give eta and xi in "
                         "[medium]");
    if (scene.medium && scene.medium->is_dynamic())
        throw InputError(scene.path +
                         ": rods in a dynamic medium are integrated in one way, to rods_run.rtol: there is "
                         "nothing to choose");
    if (scene.scan && scan_subject(scene) == scene::ScanSubject::beds)
        throw InputError(scene.path +
                         ": the scan is one of beds, whose cost and error rodwake tradeoff does not "
                         "measure yet");
}

} // namespace

scene::Scene with(scene::Scene scene, const Setting& s) {
    scene::RodsRun& run = *scene.rods_run;
    run.method.reset();
    if (s.method != "auto")
        run.method = named(s.method, {Method::bdf, Method::adams, Method::erk});
    run.form = named(s.form, {Form::angle, Form::director, Form::dae});
    run.rtol = s.tolerance;
    run.atol = s.tolerance / 100.0;
    run.precision = named(s.precision, {Accuracy::full, Accuracy::fine, Accuracy::single});
    run.turning_tolerance = 0.0;
    if (!scene.medium)
        return scene;
    scene.medium->field = named(s.field, {FieldBackend::exact, FieldBackend::table, FieldBackend::measured});
    if (s.table_tolerance > 0.0)
        scene.medium->table = scene::FieldTable{s.table_tolerance};
    return scene;
}

std::string scene_keys(const scene::Scene& scene, const Setting& s) {
    std::string text = fmt::format("rods_run.method = \"{}\"\nrods_run.form = \"{}\"\nrods_run.rtol = {:g}\n"
                                   "rods_run.atol = {:g}\n",
                                   s.method, s.form, s.tolerance, s.tolerance / 100.0);
    if (scene.rods.size() >= least_for_precision || name_of(scene.rods_run->precision) != s.precision)
        text += fmt::format("rods_run.precision = \"{}\"\n", s.precision);
    if (scene.rods_run->turning_tolerance > 0.0)
        text += "rods_run.turning_tolerance = 0\n";
    if (scene.medium)
        text += fmt::format("medium.field = \"{}\"\n", s.field);
    if (s.table_tolerance > 0.0)
        text += fmt::format("medium.table.tolerance = {:g}\n", s.table_tolerance);
    return text;
}

std::vector<Setting> settings_of(const scene::Scene& scene) {
    require_rods(scene);
    if (scene.scan)
        refuse_axes(scene);
    std::vector<Setting> all;
    for (const double tolerance : tolerances)
        for (const FieldWay& way : field_ways(scene))
            for (const Solver& solver : solvers(scene))
                if (way.suits(tolerance))
                    all.push_back({solver.method, name_of(solver.form), name_of(way.field),
                                   way.table_tolerance, name_of(way.precision), tolerance});
    return all;
}

} // namespace rodwake::app
