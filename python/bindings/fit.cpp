// Least squares on arrays: the problems, searches and reports of [fit], without files.

#include "fit.hpp"

#include "bind.hpp"
#include "callbacks.hpp"
#include "rodwake/app/fit_results.hpp"
#include "rodwake/app/run.hpp"
#include "rodwake/core/stopwatch.hpp"
#include "signals.hpp"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <atomic>
#include <cmath>

namespace rodwake::python {

namespace {

std::string place_name(const std::string& name, std::size_t i) {
    return name + "[" + std::to_string(i) + "]";
}

app::FitProfileData profile_of(const scene::FitProfile& keys, const ProfileTuple& given,
                               std::optional<double> independent_spacing) {
    const auto& [place, value, sigma] = given;
    app::FitProfileData out{keys.name, keys.name, {}, 0};
    out.data = {keys.name,
                keys.component == "Ux" ? fitting::Component::Ux : fitting::Component::Uy,
                keys.along == "x" ? fitting::Axis::x : fitting::Axis::y,
                keys.at,
                copied(place),
                copied(value),
                sigma ? copied(*sigma) : std::vector<double>{}};
    for (std::size_t i = 0; i < out.data.place.size(); ++i)
        out.data.where.push_back(place_name(keys.name, i));
    if (independent_spacing)
        fitting::share_data(out.data, *independent_spacing);
    return out;
}

app::FitTrackData track_of(const scene::FitTrajectory& keys, const TrackTuple& given,
                           std::optional<PeriodicBox> box) {
    const auto& [t, poses, independent] = given;
    if (poses.ndim() != 3 || poses.shape(2) != 3 || poses.shape(0) != t.size())
        throw InputError(keys.name + ": expected t (T,) and poses (T, N, 3)");
    const auto rods = static_cast<std::size_t>(poses.shape(1));
    app::FitTrackData out{keys.name, keys.name, rods, 1.0, 1.0, keys.sigma_position.has_value(), false, {}};
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
    data.free_start = scene::fits_start(keys);
    data.contact_distance = keys.contact_distance;
    data.contact_time = keys.contact_time;
    data.sigma_contact = keys.sigma_contact.value_or(1.0);
    data.independent = independent;
    app::settle_track(out, box);
    return out;
}

app::FitMapData map_of(const std::string& name, std::size_t table, const MapTuple& given,
                       std::optional<double> independent_spacing) {
    const auto& [arrays, box, speed] = given;
    app::FitMapData out{name, name, table, {}, 0, false, 0};
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
    app::settle_map(out, independent_spacing);
    return out;
}

} // namespace

app::FitPlan fit_plan(const scene::Scene& scene, const std::vector<ProfileTuple>& profiles,
                      const std::vector<TrackTuple>& tracks, const std::vector<MapTuple>& maps) {
    const scene::Fit& keys = scene.fit.value();
    if (!keys.fixed_errors.empty() || keys.masks.size() > 1)
        throw InputError("fixed_errors and more masks than one are worked out by rodwake fit alone: write "
                         "the scene and use rodwake.Scene.run");
    const bool moving =
        scene::fit_has(keys, "zeta") || scene::fit_has(keys, "rho") || scene::fit_has(keys, "eta_s");
    for (const scene::FitMap& map : keys.maps)
        if (moving && !map.speed)
            throw InputError(map.name + ": zeta, rho and eta_s go with the rod's speed: give speed");
    app::FitInputs inputs;
    for (std::size_t i = 0; i < profiles.size(); ++i)
        inputs.profiles.emplace_back(profile_of(keys.profiles.at(i), profiles[i], keys.independent_spacing));
    for (std::size_t i = 0; i < tracks.size(); ++i)
        inputs.tracks.emplace_back(track_of(keys.trajectories.at(i), tracks[i], keys.box));
    for (std::size_t i = 0; i < maps.size(); ++i)
        inputs.maps.emplace_back(map_of(keys.maps.at(i).name, i, maps[i], keys.independent_spacing));
    return app::fit_plan(keys, std::move(inputs));
}

namespace {

struct FitResult {
    app::FitPlan plan;
    app::FitResults results;
    double seconds = 0.0; ///< CPU time of the search and of profile likelihoods on this thread
};

FitResult fit(app::FitPlan plan, std::size_t threads, double limit) {
    FitResult result{std::move(plan), {}};
    std::atomic<bool> stopped = false;
    const auto start = std::chrono::steady_clock::now();
    const auto elapsed = [&] { return std::chrono::steady_clock::now() - start; };
    fitting::Method method = result.plan.method;
    method.threads = std::max<std::size_t>(threads, 1);
    method.stop_requested = [&] { return stopped || elapsed() > std::chrono::duration<double>(limit); };
    // The search, and what the program makes of its end; of one that failed the report alone.
    const auto search = [&] {
        const fitting::Problem& problem = result.plan.problem;
        const Stopwatch watch;
        fitting::Fit found = fitting::fit(problem, method);
        result.seconds = watch.seconds();
        if (found.termination == fitting::Termination::failed || !std::isfinite(found.chi2)) {
            result.results.report = fitting::report(problem, found);
            result.results.fit = std::move(found);
            return;
        }
        result.results = app::fit_results(result.plan, std::move(found));
        const Stopwatch more;
        for (const std::string& name : result.plan.keys.likelihood) {
            const auto at = std::ranges::find(problem.parameters, name, &fitting::Parameter::name);
            result.results.likelihood.emplace(
                name, fitting::profile_likelihood(problem, method, result.results.fit,
                                                  static_cast<std::size_t>(at - problem.parameters.begin())));
        }
        result.seconds += more.seconds();
    };
    attended(
        search, [] {}, [&] { stopped = true; });
    return result;
}

FitResult fit_arrays(const scene::Scene& scene, const std::vector<ProfileTuple>& profiles,
                     const std::vector<TrackTuple>& tracks, const std::vector<MapTuple>& maps,
                     std::size_t threads) {
    return fit(fit_plan(scene, profiles, tracks, maps), threads, HUGE_VAL);
}

/// The fit of a scene, its data read from `folder` or beside the scene; interrupted after `limit` seconds.
FitResult fit_scene(const scene::Scene& scene, const std::filesystem::path& folder, std::size_t threads,
                    double limit) {
    const auto required = app::OwnFiles::required;
    return fit(app::fit_plan(scene.fit.value(), app::read_fit_inputs(scene, folder, required)), threads,
               limit);
}

py::list estimates_of(const FitResult& result, const py::object& make) {
    py::list all;
    for (const fitting::ParameterEstimate& e : result.results.report.estimates) {
        const py::object bound = e.at_lower   ? py::object(py::str("lower"))
                                 : e.at_upper ? py::object(py::str("upper"))
                                              : py::none();
        const double error = has_error(result.results.report, e) ? e.standard_error : unknown_error;
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
    for (const std::size_t i : result.results.report.free)
        names.push_back(result.results.report.estimates[i].name);
    return names;
}

Array column(const std::vector<double>& values) {
    return array_of(std::vector<double>(values), {static_cast<py::ssize_t>(values.size())});
}

/// (data - model)/sigma of all that was fitted; NaN where the model is not finite.
Array residuals_of(const FitResult& result) {
    const fitting::Problem& problem = result.plan.problem;
    Eigen::VectorXd r = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(problem.residuals), std::nan(""));
    if (std::isfinite(result.results.fit.chi2))
        problem.evaluate(result.results.fit.values, r, nullptr);
    r = -r;
    return column({r.begin(), r.end()});
}

/// Of each profile: name, role, place, value, sigma, model, its error, residual, used, chi2, excess and its
/// error.
py::list profiles_of(const FitResult& result, const py::object& make) {
    py::list all;
    for (std::size_t i = 0; i < result.results.profiles.size(); ++i) {
        const app::FitProfileResult& item = result.results.profiles[i];
        const app::FitProfileData& data = result.plan.profiles[i];
        const bool predicted = result.plan.keys.profiles[i].role == scene::FitRole::predict;
        std::vector<double> sigma = item.sigma;
        std::ranges::replace(sigma, 0.0, std::nan(""));
        const auto excess = item.scale_factor.value_or(fitting::ScaleFactor{std::nan(""), std::nan("")});
        all.append(make(data.name, predicted ? "predict" : "fit", column(data.data.place),
                        column(data.data.value), column(sigma), column(item.model), column(item.band),
                        column(item.residual), py::array(py::cast(item.used)), item.chi2, excess.scale,
                        excess.standard_error));
    }
    return all;
}

/// Of each track: name, model (T, N, 3), rms of positions and headings.
py::list tracks_of(const FitResult& result, const py::object& make) {
    py::list all;
    for (std::size_t i = 0; i < result.results.tracks.size(); ++i) {
        const app::FitTrackResult& item = result.results.tracks[i];
        std::vector<double> poses;
        for (const std::vector<double>& state : item.model)
            poses.insert(poses.end(), state.begin(), state.end());
        const auto rods = static_cast<py::ssize_t>(result.plan.tracks[i].rods);
        all.append(make(result.plan.tracks[i].name,
                        array_of(std::move(poses), {static_cast<py::ssize_t>(item.model.size()), rods, 3}),
                        item.rms_position, item.rms_heading));
    }
    return all;
}

/// Of each map: name, model of Ux and Uy, used, chi2.
py::list maps_of(const FitResult& result, const py::object& make) {
    py::list all;
    for (std::size_t i = 0; i < result.results.maps.size(); ++i) {
        const app::FitMapResult& item = result.results.maps[i];
        const std::pair shape{result.plan.maps[i].data.y.size(), result.plan.maps[i].data.x.size()};
        const auto grid = [&](const py::object& values) { return values.attr("reshape")(shape); };
        all.append(make(result.plan.maps[i].name, grid(column(item.model.Ux)), grid(column(item.model.Uy)),
                        grid(py::array(py::cast(item.used))), item.chi2));
    }
    return all;
}

py::dict likelihood_of(const FitResult& result, const py::object& make) {
    py::dict all;
    for (const auto& [name, one] : result.results.likelihood)
        all[py::str(name)] = make(column(one.value), column(one.chi2), one.low, one.high);
    return all;
}

} // namespace

void bind_fit(py::module_& module) {
    py::class_<FitResult>(module, "FitResult")
        .def("estimates", &estimates_of)
        .def("free", &free_names)
        .def("residuals", &residuals_of)
        .def("profiles", &profiles_of)
        .def("tracks", &tracks_of)
        .def("maps", &maps_of)
        .def("likelihood", &likelihood_of)
        .def("covariance", [](const FitResult& r) { return rows_of(r.results.report.covariance); })
        .def("correlation", [](const FitResult& r) { return rows_of(r.results.report.correlation); })
        .def_readonly("seconds", &FitResult::seconds)
        .def_property_readonly("objective", [](const FitResult& r) { return r.results.fit.objective; })
        .def_property_readonly("chi2", [](const FitResult& r) { return r.results.report.chi2; })
        .def_property_readonly("dof", [](const FitResult& r) { return r.results.report.dof; })
        .def_property_readonly("probability", [](const FitResult& r) { return r.results.report.probability; })
        .def_property_readonly("termination",
                               [](const FitResult& r) { return to_string(r.results.fit.termination); })
        .def_property_readonly("reason", [](const FitResult& r) { return r.results.fit.reason; })
        .def_property_readonly("diagnostics", [](const FitResult& r) { return r.results.report.diagnostics; })
        .def_property_readonly("evaluations", [](const FitResult& r) { return r.results.fit.evaluations; })
        .def("text", [](const FitResult& r) {
            return fitting::to_text(r.plan.problem, r.results.fit, r.results.report);
        });
    module.def("fit", &fit_arrays);
    module.def("fit_scene", &fit_scene);
}

} // namespace rodwake::python
