#include "measured_file.hpp"

#include "fit/fit_data.hpp"
#include "rodwake/app/plan.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/store/hdf5_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace rodwake::app {

namespace {

namespace fs = std::filesystem;
using scene::MeasuredMedium, scene::Scene;

bool is_measured(const Scene& scene) {
    return scene.medium && scene.medium->field == scene::FieldBackend::measured && scene.medium->measured;
}

/// Whether the measure stage of this scene writes the file.
bool is_own(const Scene& scene) {
    const fs::path file = scene.medium->measured->file;
    const bool in_run =
        file == "measure.h5" || (file.filename() == "measure.h5" && *file.begin() == "variants");
    return in_run && scene.measure && scene.measure->displacement;
}

[[noreturn]] void refuse(const fs::path& file, const std::string& why) {
    throw InputError(fmt::format("{}: medium.measured.file: {}", file.string(), why));
}

constexpr const char* how_to_make = "rodwake run of a scene with [granular] and measure.displacement = "
                                    "\"phase\" makes a file that has one (scenes/wake.toml)";

fs::path find(const Scene& scene, const fs::path& run_directory) {
    const std::string& file = scene.medium->measured->file;
    std::string looked;
    for (const fs::path& candidate : data_file_places(file, scene, run_directory)) {
        if (fs::is_regular_file(candidate))
            return candidate;
        looked += (looked.empty() ? "" : ", ") + fs::absolute(candidate).lexically_normal().string();
    }
    throw InputError(fmt::format(
        "{}: medium.measured.file = \"{}\": no such file; looked for {}; {}", scene.path, file, looked,
        is_own(scene) ? "rodwake run makes what this scene measures before its rods" : how_to_make));
}

std::vector<double> layer(const store::Hdf5Reader& h5, const fs::path& file, const char* name,
                          std::size_t side, bool or_unknown = false) {
    const std::string path = std::string("/displacement/") + name;
    if (!h5.has(path))
        refuse(file, fmt::format("has no {}; {}", path, how_to_make));
    store::Hdf5Dataset data = h5.dataset(path, or_unknown);
    if (data.shape != std::vector<std::size_t>{side, side})
        refuse(file, fmt::format("{} is not {} bins a side as /displacement/x is", path, side));
    return data.values;
}

/// Where no error is known, that of every bin is taken to be the field's root mean square: all count alike.
void require_errors(const fs::path& file, const std::vector<double>& values, std::vector<double>& sigma) {
    if (std::ranges::all_of(sigma, [](double s) { return std::isnan(s); })) {
        const double squares = std::inner_product(values.begin(), values.end(), values.begin(), 0.0);
        std::ranges::fill(sigma, std::sqrt(squares / static_cast<double>(values.size())));
    }
    if (std::ranges::any_of(sigma, [](double s) { return !(s > 0.0); }))
        refuse(file, "a sigma_x or sigma_y of /displacement is not above 0");
}

} // namespace

bool measures_own_field(const Scene& scene) {
    return std::ranges::any_of(
        cases_of(scene), [](const Case& case_) { return is_measured(case_.scene) && is_own(case_.scene); });
}

MeasuredInput read_measured(const Scene& scene, const fs::path& run_directory) {
    const MeasuredMedium& keys = *scene.medium->measured;
    const fs::path file = find(scene, run_directory);
    const store::Hdf5Reader h5(file);
    if (!h5.has("/displacement/x"))
        refuse(file, fmt::format("has no displacement field (/displacement); {}", how_to_make));
    if (h5.has_attribute("/displacement", "window_margin"))
        refuse(file, "was measured in a window of a film, and a measured medium needs a periodic box");
    const std::vector<double> x = h5.dataset("/displacement/x").values,
                              y = h5.dataset("/displacement/y").values;
    const std::size_t side = x.size();
    if (y.size() != side || std::abs(x.front() - y.front()) > 1e-9 * std::abs(x.front()))
        refuse(
            file,
            "was measured in a rectangular box; a measured field is taken from a square one: measure it in a "
            "bed whose granular.box is one length");
    const double a = h5.real("/", "bead_radius") / scene.scales->f_over_mu; // in f/mu
    const auto scaled = [&](const char* name, bool or_unknown = false) {
        std::vector<double> values = layer(h5, file, name, side, or_unknown);
        for (double& value : values)
            value *= a;
        return values;
    };
    MeasuredInput input{file,
                        {side, h5.real("/displacement", "spacing") * a, scaled("Ux"), scaled("Uy"),
                         scaled("sigma_x", true), scaled("sigma_y", true)},
                        {}};
    for (const double count : layer(h5, file, "count", side))
        input.grid.known.push_back(count > 0.0);
    if (std::ranges::none_of(input.grid.known, [](bool known) { return known; }))
        refuse(file, "no bin of /displacement has data (count is 0 everywhere): measure longer");
    if (const std::int64_t blocks = h5.integer("/displacement", "blocks"); keys.samples > 0 && blocks < 2)
        refuse(file,
               fmt::format("the errors of its field are unknown, because it was measured in {} block of "
                           "time. Measure more runs, longer, or with a shorter measure.block; or set "
                           "medium.measured.samples = 0 for a run without errors",
                           blocks));
    require_errors(file, input.grid.Ux, input.grid.sigma_x);
    require_errors(file, input.grid.Uy, input.grid.sigma_y);
    constexpr double window = 0.71; // of the cell over which a value is a mean, in lattice spacings
    const double radius =
        window * std::sqrt(2.0 * std::numbers::pi / (std::numbers::sqrt3 * h5.real("/", "phi_b"))) * a;
    input.options = {.core = keys.core.value_or(4.0 * a),
                     .edge = keys.edge.value_or(input.grid.place(side - 1)),
                     .blend = keys.blend.value_or(6.0 * a),
                     .window = radius,
                     .correlation = keys.correlation.value_or(radius),
                     .smoothing = keys.smoothing};
    try {
        elastic::validate(input.grid, input.options, scene.medium->periodic);
    } catch (const InputError& error) {
        throw InputError(
            fmt::format("{}: [medium.measured] with {}: {}", scene.path, file.string(), error.what()));
    }
    return input;
}

void require_measured(const Scene& scene, const fs::path& run_directory, bool made_later) {
    for (const Case& case_ : cases_of(scene))
        if (is_measured(case_.scene) && !(made_later && is_own(case_.scene)))
            read_measured(case_.scene, run_directory);
}

} // namespace rodwake::app
