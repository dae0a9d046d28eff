// Least squares on arrays: the problems, searches and reports of [fit], without files.

#include "rodwake/assembly/fit.hpp"
#include "bind.hpp"
#include "callbacks.hpp"
#include "rodwake/fitting/report.hpp"
#include "signals.hpp"

#include <pybind11/stl.h>

#include <atomic>
#include <cmath>

namespace rodwake::python {

namespace {

using OptionalArray = std::optional<Array>;
/// place, value, sigma, independent; the rest is in [[fit.profiles]].
using ProfileTuple = std::tuple<Array, Array, OptionalArray, double>;
/// t (T,), poses (T, N, 3), independent; the rest is in [[fit.trajectories]].
using TrackTuple = std::tuple<Array, Array, double>;

std::string place_name(const std::string& name, std::size_t i) {
    return name + "[" + std::to_string(i) + "]";
}

assembly::FitProfileData profile_of(const scene::FitProfile& keys, const ProfileTuple& given) {
    const auto& [place, value, sigma, independent] = given;
    assembly::FitProfileData out{keys.name, keys.name, {}, 0};
    out.data = {keys.name,
                keys.component == "Ux" ? fitting::Component::Ux : fitting::Component::Uy,
                keys.along == "x" ? fitting::Axis::x : fitting::Axis::y,
                keys.at,
                copied(place),
                copied(value),
                sigma ? copied(*sigma) : std::vector<double>{},
                independent,
                {}};
    for (std::size_t i = 0; i < out.data.place.size(); ++i)
        out.data.where.push_back(place_name(keys.name, i));
    return out;
}

assembly::FitTrackData track_of(const scene::FitTrajectory& keys, const TrackTuple& given,
                                std::optional<PeriodicBox> box) {
    const auto& [t, poses, independent] = given;
    if (poses.ndim() != 3 || poses.shape(2) != 3 || poses.shape(0) != t.size())
        throw InputError(keys.name + ": expected t (T,) and poses (T, N, 3)");
    const auto rods = static_cast<std::size_t>(poses.shape(1));
    assembly::FitTrackData out{keys.name, keys.name, rods, 1.0, 1.0, keys.sigma_position.has_value(),
                               false,     {}};
    fitting::Trajectory& data = out.data;
    data.name = keys.name;
    data.times = copied(t);
    for (std::size_t row = 0; row < data.times.size(); ++row) {
        const double* first = poses.data() + row * 3 * rods;
        data.states.emplace_back(first, first + 3 * rods);
        data.where.push_back(place_name(keys.name, row));
    }
    data.sigma_position = keys.sigma_position.value_or(1.0);
    data.sigma_heading = keys.sigma_heading.value_or(1.0);
    data.free_headings = keys.free_headings;
    data.contact_distance = keys.contact_distance;
    data.contact_time = keys.contact_time;
    data.sigma_contact = keys.sigma_contact.value_or(1.0);
    data.box = box;
    data.independent = independent;
    return out;
}

/// x, y, Ux, Uy, sigma_x, sigma_y; sides of the box; speed. The shapes are checked, NaN: not there.
using MapTuple = std::tuple<std::vector<Array>, std::pair<double, double>, double>;

assembly::FitMapData map_of(const std::string& name, std::size_t table, const MapTuple& given,
                            std::optional<double> independent_spacing) {
    const auto& [arrays, box, speed] = given;
    assembly::FitMapData out{name, name, table, {}, 0, false};
    fitting::Map& map = out.data;
    map.name = name;
    map.lx = box.first;
    map.ly = box.second;
    map.speed = speed;
    std::vector<double>* const fields[] = {&map.x, &map.y, &map.Ux, &map.Uy, &map.sigma_x, &map.sigma_y};
    for (std::size_t k = 0; k < std::size(fields); ++k)
        *fields[k] = copied(arrays.at(k));
    for (std::size_t bin = 0; bin < map.bins(); ++bin)
        map.known.push_back(std::isfinite(map.Ux[bin]) && std::isfinite(map.Uy[bin]));
    assembly::settle_map(out, independent_spacing);
    return out;
}

/// What only the program does with maps.
void refuse_systematics(const scene::Fit& keys) {
    if (!keys.fixed_errors.empty() || keys.masks.size() > 1)
        throw InputError("fixed_errors and more masks than one are worked out by rodwake fit alone: write "
                         "the scene and use rodwake.Scene.run");
}

void require_speeds(const scene::Fit& keys) {
    const bool moving =
        scene::fit_has(keys, "zeta") || scene::fit_has(keys, "rho") || scene::fit_has(keys, "eta_s");
    for (const scene::FitMap& map : keys.maps)
        if (moving && !map.speed)
            throw InputError(map.name + ": zeta, rho and eta_s go with the rod's speed: give speed");
}

struct FitResult {
    fitting::Problem problem;
    fitting::Fit fit;
    fitting::Report report;
};

FitResult fit(const scene::Scene& scene, const std::vector<ProfileTuple>& profiles,
              const std::vector<TrackTuple>& tracks, const std::vector<MapTuple>& maps, std::size_t threads) {
    const scene::Fit& keys = scene.fit.value();
    refuse_systematics(keys);
    require_speeds(keys);
    assembly::FitInputs inputs;
    for (std::size_t i = 0; i < profiles.size(); ++i)
        inputs.profiles.emplace_back(profile_of(keys.profiles.at(i), profiles[i]));
    for (std::size_t i = 0; i < tracks.size(); ++i)
        inputs.tracks.emplace_back(track_of(keys.trajectories.at(i), tracks[i], keys.box));
    for (std::size_t i = 0; i < maps.size(); ++i)
        inputs.maps.emplace_back(map_of(keys.maps.at(i).name, i, maps[i], keys.independent_spacing));
    const assembly::FitPlan plan = assembly::fit_plan(keys, std::move(inputs));
    std::atomic<bool> stopped = false;
    fitting::Method method = plan.method;
    method.threads = std::max<std::size_t>(threads, 1);
    method.stop_requested = [&] { return stopped.load(); };
    FitResult result{plan.problem, {}, {}};
    attended(
        [&] {
            result.fit = fitting::fit(plan.problem, method);
            result.report = fitting::report(plan.problem, result.fit);
        },
        [] {}, [&] { stopped = true; });
    return result;
}

py::list estimates_of(const FitResult& result, const py::object& make) {
    py::list all;
    for (const fitting::Estimate& e : result.report.estimates) {
        const py::object bound = e.at_lower   ? py::object(py::str("lower"))
                                 : e.at_upper ? py::object(py::str("upper"))
                                              : py::none();
        const double error = has_error(result.report, e) ? e.standard_error : unknown_error;
        all.append(make(e.name, e.value, error, e.low, e.high, e.free, bound));
    }
    return all;
}

Array rows_of(const Eigen::MatrixXd& m) {
    const Eigen::MatrixXd rows = m.transpose(); // C order
    return array_of({rows.data(), rows.data() + rows.size()}, {m.rows(), m.cols()});
}

std::vector<std::string> free_names(const FitResult& result) {
    std::vector<std::string> names;
    for (const std::size_t i : result.report.free)
        names.push_back(result.report.estimates[i].name);
    return names;
}

} // namespace

void bind_fit(py::module_& module) {
    py::class_<FitResult>(module, "FitResult")
        .def("estimates", &estimates_of)
        .def("free", &free_names)
        .def("covariance", [](const FitResult& r) { return rows_of(r.report.covariance); })
        .def("correlation", [](const FitResult& r) { return rows_of(r.report.correlation); })
        .def_property_readonly("chi2", [](const FitResult& r) { return r.report.chi2; })
        .def_property_readonly("dof", [](const FitResult& r) { return r.report.dof; })
        .def_property_readonly("probability", [](const FitResult& r) { return r.report.probability; })
        .def_property_readonly("termination", [](const FitResult& r) { return to_string(r.fit.termination); })
        .def_property_readonly("reason", [](const FitResult& r) { return r.fit.reason; })
        .def_property_readonly("diagnostics", [](const FitResult& r) { return r.report.diagnostics; })
        .def_property_readonly("evaluations", [](const FitResult& r) { return r.fit.evaluations; })
        .def("text", [](const FitResult& r) { return fitting::to_text(r.problem, r.fit, r.report); });
    module.def("fit", &fit);
}

} // namespace rodwake::python
