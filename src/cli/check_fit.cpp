#include "check_fit.hpp"

#include "fit_plan.hpp"
#include "session.hpp"

#include <fmt/format.h>

namespace rodwake::cli {

namespace {

using Lines = std::vector<CheckLine>;

/// What one evaluation of the model costs: points of files that are there, and pairs of rods that are run.
struct FitSize {
    std::size_t points = 0, pairs = 0, files_to_make = 0;
};

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
                        const std::filesystem::path& folder, FitSize& size) {
    const scene::Fit& keys = *scene.fit;
    try {
        const FitProfileData data =
            read_fit_profile(profile, find_fit_file(profile.file, scene, folder), keys.independent_spacing);
        const std::size_t used = fitting::outside_core(data.data, keys.core).place.size();
        size.points += profile.role == scene::FitRole::fit ? used : 0;
        return fmt::format("{} of {} points of {}", used, data.data.place.size(), data.file.string());
    } catch (const std::exception&) {
        if (!made_by_run(profile.file, scene))
            throw;
        ++size.files_to_make;
        return fmt::format("the points of {}, which the run makes", profile.file);
    }
}

void add_data(const scene::Scene& scene, const std::filesystem::path& folder, Lines& lines, FitSize& size) {
    for (const scene::FitProfile& p : scene.fit->profiles)
        lines.push_back({true, fmt::format("fit: {} along {} at {} = {:g} {}: {}", p.component, p.along,
                                           p.along == "x" ? "y" : "x", p.at,
                                           p.role == scene::FitRole::fit ? "fitted" : "predicted",
                                           points_text(p, scene, folder, size))});
    for (const scene::FitTrajectory& t : scene.fit->trajectories) {
        if (made_by_run(t.file, scene)) {
            ++size.files_to_make;
            lines.push_back({true, fmt::format("fit: rods of {}, which the run makes", t.file)});
            continue;
        }
        const FitTrackData data = read_fit_track(t, find_fit_file(t.file, scene, folder));
        size.pairs += data.rods * (data.rods - 1) / 2;
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

std::string cost_text(const scene::Fit& keys, const FitSize& size) {
    constexpr double evaluations = 50.0;                        // of a start with gradients
    constexpr double point_seconds = 1e-6, pair_seconds = 1e-3; // of one evaluation
    const double all = evaluations * static_cast<double>(keys.starts);
    const double seconds = all * (point_seconds * static_cast<double>(size.points) +
                                  pair_seconds * static_cast<double>(size.pairs));
    std::string what = fmt::format("{} points", size.points);
    if (size.pairs > 0)
        what += fmt::format(" and {} pair{} of rods", size.pairs, size.pairs == 1 ? "" : "s");
    if (size.files_to_make > 0)
        what += fmt::format(" (and {} file{} the run makes)", size.files_to_make,
                            size.files_to_make == 1 ? "" : "s");
    return fmt::format("  fit: {} start{}, {}, about {:.0f} evaluations of the model, about {:.2g} s\n",
                       keys.starts, keys.starts == 1 ? "" : "s", what, all, seconds);
}

} // namespace

FitCheck check_fit(const scene::Scene& scene, const Options& options) {
    if (!scene.fit)
        return {{{false, "fit: no [fit] table"}}, ""};
    const std::filesystem::path folder = output_folder(options);
    require_fit_files(scene, options);
    Lines lines;
    FitSize size;
    add_parameters(*scene.fit, options, lines);
    add_data(scene, folder, lines, size);
    add_terms(*scene.fit, lines);
    return {lines, cost_text(*scene.fit, size)};
}

} // namespace rodwake::cli
