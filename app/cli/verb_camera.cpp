// rodwake camera: a bed's frames as the tracks that a camera would have of them, and a scene that measures
// them.

#include "definition.hpp"
#include "rodwake/app/camera.hpp"
#include "rodwake/app/run_folder.hpp"
#include "rodwake/core/error.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <filesystem>

namespace rodwake::cli {

namespace {

namespace fs = std::filesystem;

/// "0.05 a", "25 um", "1e-5" (m), in m.
double length_of(const std::string& option, const std::string& text, double bead_radius) {
    const std::pair<std::string_view, double> units[] = {{"", 1.0},    {"m", 1.0},   {"mm", 1e-3},
                                                         {"um", 1e-6}, {"nm", 1e-9}, {"a", bead_radius}};
    double number = 0.0;
    const auto [at, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    std::string_view unit(at, static_cast<std::size_t>(text.data() + text.size() - at));
    unit.remove_prefix(std::min(unit.find_first_not_of(' '), unit.size()));
    const auto known = std::ranges::find(units, unit, &std::pair<std::string_view, double>::first);
    if (error != std::errc{} || !std::isfinite(number) || known == std::end(units))
        throw InputError(fmt::format("{} {}: is not a length such as \"0.05 a\" or \"25 um\"", option, text));
    return number * known->second;
}

measure::Camera camera_of(const Options& options, const measure::Layout& layout) {
    measure::Camera camera = options.camera;
    camera.pixel = length_of("--pixel", options.pixel, layout.bead_radius);
    camera.noise = length_of("--noise", options.localisation, layout.bead_radius);
    camera.turned *= M_PI / 180.0;
    camera.seed = options.seed.value_or(1);
    return camera;
}

fs::path camera_folder(const Options& options) {
    if (!options.output.empty())
        return options.output;
    const fs::path run = options.target;
    return (fs::is_directory(run) ? run : run.parent_path()) / "camera";
}

} // namespace

int verb_camera(const Options& options) {
    const fs::path folder = camera_folder(options);
    if (options.output.empty()) // a folder that the user names may be a link
        app::refuse_link(folder);
    app::refuse_link(folder / "images");
    for (const char* name : {"tracks.csv", "camera.toml", "images"})
        if (fs::exists(folder / name) && !options.force)
            throw InputError(fmt::format("{}: is there; --force replaces it, or name another folder with -o",
                                         (folder / name).string()));
    const app::Filmed filmed = app::film(
        options.target, [&](const measure::Layout& layout) { return camera_of(options, layout); }, folder,
        options.command, [] { return stop_signal() != 0; });
    if (stop_signal())
        return signal_exit_code(stop_signal());
    if (!options.quiet)
        fmt::print("{}: {} pictures, {} spots{}\n{}: rodwake run {} measures them\n", filmed.tracks.string(),
                   filmed.pictures, filmed.spots,
                   filmed.images > 0 ? fmt::format("; {} drawn in images", filmed.images) : "",
                   filmed.scene.string(), filmed.scene.string());
    return 0;
}

} // namespace rodwake::cli
