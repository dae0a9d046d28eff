#include "check_fit.hpp"

#include "fit_plan.hpp"
#include "session.hpp"

#include <fmt/format.h>

namespace rodwake::cli {

namespace {

using Lines = std::vector<CheckLine>;

std::string method_text(const scene::Fit& keys, const Options& options) {
    const fitting::Method method = fit_method(keys, options);
    return fmt::format("{} from {} start{}, seed {}{}", to_string(method.algorithm), method.starts,
                       method.starts == 1 ? "" : "s", method.seed, method.polish ? ", polished" : "");
}

void add_parameters(const scene::Fit& keys, const Options& options, Lines& lines) {
    lines.push_back(
        {true, fmt::format("fit of {}: {}", fmt::join(keys.parameters, ", "), method_text(keys, options))});
    for (const auto& [name, value] : keys.fixed)
        lines.push_back({true, fmt::format("fit: {} = {:g} held", name, value)});
    for (const auto& [name, tie] : keys.tied)
        lines.push_back({true, fmt::format("fit: {} = {:g} {}", name, tie.factor, tie.to)});
}

/// "60 of 79 points", or that the file is still to be made.
std::string points_text(const scene::FitProfile& profile, const scene::Scene& scene,
                        const std::filesystem::path& folder) {
    const scene::Fit& keys = *scene.fit;
    try {
        const FitProfileData data =
            read_fit_profile(profile, find_fit_file(profile.file, scene, folder), keys.independent_spacing);
        const std::size_t used = fitting::outside_core(data.data, keys.core).place.size();
        return fmt::format("{} of {} points of {}", used, data.data.place.size(), data.file.string());
    } catch (const std::exception&) {
        if (!made_by_run(profile.file, scene))
            throw;
        return fmt::format("the points of {}, which the run makes", profile.file);
    }
}

void add_data(const scene::Scene& scene, const std::filesystem::path& folder, Lines& lines) {
    for (const scene::FitProfile& p : scene.fit->profiles)
        lines.push_back({true, fmt::format("fit: {} along {} at {} = {:g} {}: {}", p.component, p.along,
                                           p.along == "x" ? "y" : "x", p.at,
                                           p.role == scene::FitRole::fit ? "fitted" : "predicted",
                                           points_text(p, scene, folder))});
    for (const scene::FitTrajectory& t : scene.fit->trajectories) {
        if (made_by_run(t.file, scene)) {
            lines.push_back({true, fmt::format("fit: rods of {}, which the run makes", t.file)});
            continue;
        }
        const FitTrackData data = read_fit_track(t, find_fit_file(t.file, scene, folder));
        lines.push_back({true, fmt::format("fit: {} rods, {} rows of {}", data.rods, data.data.times.size(),
                                           data.file.string())});
    }
}

void add_term(const scene::Fit& keys, const char* parameter, const char* what, Lines& lines) {
    const bool in = scene::fit_has(keys, parameter);
    lines.push_back({in, in ? fmt::format("fit term: {} ({})", what, parameter)
                            : fmt::format("fit term: no {}: {} is not in fit.parameters, fixed or tied", what,
                                          parameter)});
}

void add_terms(const scene::Fit& keys, Lines& lines) {
    if (!keys.profiles.empty()) {
        add_term(keys, "f_over_mu", "monopole", lines);
        add_term(keys, "f2d_over_mu", "dipole", lines);
        add_term(keys, "x0", "place of the force ahead of the centre", lines);
        add_term(keys, "offset", "offset of Ux", lines);
        add_term(keys, "offset_y", "offset of Uy", lines);
        lines.push_back(
            {keys.box.has_value(), keys.box ? fmt::format("fit term: images in a box of {:g}", *keys.box)
                                            : "fit term: no images: no fit.box, infinite plane"});
        lines.push_back({keys.core > 0.0, keys.core > 0.0
                                              ? fmt::format("fit: |place| < {:g} left out", keys.core)
                                              : "fit core: all points count, fit.core is 0"});
    }
    if (!keys.trajectories.empty()) {
        add_term(keys, "kappa", "turning by strain", lines);
        add_term(keys, "gamma1", "first polar turning", lines);
        add_term(keys, "gamma2", "second polar turning", lines);
    }
}

} // namespace

std::vector<CheckLine> check_fit(const scene::Scene& scene, const Options& options) {
    if (!scene.fit)
        return {{false, "fit: no [fit] table"}};
    const std::filesystem::path folder = output_folder(options);
    require_fit_files(scene, options);
    Lines lines;
    add_parameters(*scene.fit, options, lines);
    add_data(scene, folder, lines);
    add_terms(*scene.fit, lines);
    return lines;
}

} // namespace rodwake::cli
