#include "start_file.hpp"

#include "rodwake/app/granular.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/spelling.hpp"
#include "rodwake/store/csv.hpp"
#include "rodwake/store/h5md_reader.hpp"
#include "rodwake/store/track_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <string_view>

namespace rodwake::app {

namespace fs = std::filesystem;

fs::path start_file_of(const scene::Granular& bed, const std::string& scene) {
    const std::string& file = bed.start_file;
    const fs::path beside = (fs::path(scene).parent_path() / file).lexically_normal();
    for (const fs::path& candidate : {beside, fs::path(file)})
        if (fs::is_regular_file(candidate))
            return candidate;
    throw InputError(fmt::format("granular.start_file = \"{}\": there is no such file, neither {} nor {}",
                                 file, fs::absolute(beside).string(),
                                 fs::absolute(fs::path(file)).lexically_normal().string()));
}

namespace {

/// Beads of a film. Between plates that shake heights at one phase mean nothing at another, so they are left
/// out there.
granular::GivenBeads beads_of_frame(const scene::Granular& bed, const fs::path& file) {
    store::H5mdReader reader(file);
    const store::TrajectoryInfo& film = reader.info();
    const auto frame = bed.start_frame ? static_cast<std::size_t>(*bed.start_frame) : film.frames() - 1;
    if (frame >= film.frames())
        throw InputError(fmt::format("granular.start_frame = {}: {} has frames 0 to {}", frame, file.string(),
                                     film.frames() - 1));
    const PeriodicBox box = bed_size(bed).box;
    const auto differs = [](double a, double b) { return std::abs(a - b) > 1e-9 * b; };
    if (differs(film.box[0], box.x) || differs(film.box[1], box.y))
        throw InputError(fmt::format("{}: its box is {:.10g} x {:.10g} m, and the box of the scene {:.10g} x "
                                     "{:.10g} m: a film as start_file needs the same box",
                                     file.string(), film.box[0], film.box[1], box.x, box.y));
    store::StoredFrame found;
    reader.read(frame, found);
    granular::GivenBeads given{found.x, found.y, found.z, found.vx, found.vy, found.vz, film.radius, {}};
    if (bed.plates.gamma > 0.0)
        given.z.clear();
    const granular::BeadMix mix = scene::bead_mix(bed);
    for (const double radius : film.radius)
        given.kind.push_back(static_cast<std::uint8_t>(mix.nearest(radius)));
    return given;
}

} // namespace

granular::GivenBeads read_start_file(const scene::Granular& bed, const std::string& path) {
    static const std::array<std::string, 2> required{"x", "y"};
    static const std::array<std::string, 6> optional{"z", "vx", "vy", "vz", "radius", "kind"};
    static constexpr std::array<std::string_view, 8> known{"x", "y", "z", "vx", "vy", "vz", "radius", "kind"};
    const fs::path file = start_file_of(bed, path);
    if (store::track_format(file) == TrackFormat::h5md)
        return beads_of_frame(bed, file);
    if (bed.start_frame)
        throw InputError(fmt::format("granular.start_frame = {}: {} is a table, which has no frames; leave "
                                     "start_frame out",
                                     *bed.start_frame, file.string()));
    for (const std::string& name : store::csv_names(file)) // a misspelt column would be drawn
        if (!name.empty() && std::ranges::find(known, name) == known.end())
            throw InputError(fmt::format("{}: unknown column \"{}\"{}: columns of a start_file are {}",
                                         file.string(), shown(name), did_you_mean(name, known),
                                         fmt::join(known, ", ")));
    const store::Table table = store::read_csv(file, required, optional);
    const auto take = [&](const std::string& name) {
        const auto* column = table.find(name);
        for (std::size_t i = 0; column && i < table.rows(); ++i)
            if (!std::isfinite((*column)[i]))
                throw InputError(
                    fmt::format("{}:{}: column {} is empty: must be a finite number in every row; "
                                "leave the column out if its values are to be drawn",
                                file.string(), table.lines[i], name));
        return column ? *column : std::vector<double>();
    };
    granular::GivenBeads given{take("x"),  take("y"),  take("z"),      take("vx"),
                               take("vy"), take("vz"), take("radius"), {}};
    // Kinds of the column, or those whose radii are nearest.
    const auto* column = table.find("kind");
    const std::size_t count = std::max<std::size_t>(bed.bead_kinds.size(), 1);
    for (std::size_t i = 0; column && i < table.rows(); ++i) {
        const double kind = (*column)[i];
        if (!(kind >= 0.0 && kind < static_cast<double>(count) && kind == std::floor(kind)))
            throw InputError(
                fmt::format("{}:{}: kind = {}: must be a whole number from 0 to {}, the number of "
                            "one of the [[granular.bead_kinds]]",
                            file.string(), table.lines[i], kind, count - 1));
        given.kind.push_back(static_cast<std::uint8_t>(kind));
    }
    if (!column)
        for (const double radius : given.radius)
            given.kind.push_back(static_cast<std::uint8_t>(scene::bead_mix(bed).nearest(radius)));
    constexpr double furthest = 1e3; // m, as for other lengths of a scene
    for (std::size_t i = 0; i < table.rows(); ++i) {
        const double radius = given.radius.empty() ? bed.bead_radius : given.radius[i];
        if (!(radius > 0.0))
            throw InputError(
                fmt::format("{}:{}: radius = {} m: must be > 0", file.string(), table.lines[i], radius));
        if (std::abs(given.x[i]) > furthest || std::abs(given.y[i]) > furthest)
            throw InputError(fmt::format("{}:{}: x = {} m, y = {} m: must be within {} m of 0", file.string(),
                                         table.lines[i], given.x[i], given.y[i], furthest));
    }
    if (given.x.empty())
        throw InputError(fmt::format("{}: has no rows: must have one for each bead", file.string()));
    return given;
}

} // namespace rodwake::app
