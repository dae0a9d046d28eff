#include "film_rods.hpp"

#include "rodwake/core/error.hpp"
#include "run/record_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace rodwake::app {

namespace {

struct FilmTime {
    double t;

    static constexpr auto fields() { return std::tuple{field("t", &FilmTime::t, {"s", "of the frame"})}; }
};

struct FilmPose {
    double x, y, heading, speed;

    static constexpr auto fields() {
        using R = FilmPose;
        return std::tuple{
            field("x", &R::x, {"m", "position of the rod, unwrapped (empty: it is not seen)"}),
            field("y", &R::y, {"m", "position of the rod, unwrapped (empty: it is not seen)"}),
            field("theta", &R::heading,
                  {"rad", "heading of the thin end from +x, without jumps (empty: unknown)"}),
            field("speed", &R::speed,
                  {"m/s", "along the heading, mean since the frame before (empty: not known in both)"})};
    }
};

} // namespace

std::vector<FilmRod> film_rods(const measure::Tracks& tracks) {
    std::vector<FilmRod> rods;
    for (const measure::RodTrack& rod : tracks.rods) {
        const auto known =
            std::ranges::count_if(rod.heading, [](double heading) { return !std::isnan(heading); });
        rods.push_back({rod.number, rod.frame.size(), static_cast<std::size_t>(known),
                        tracks.time[rod.frame.front()], tracks.time[rod.frame.back()]});
    }
    return rods;
}

void require_rods(const scene::Scene& scene, const measure::Tracks& tracks, const std::string& file) {
    const scene::Measure& m = *scene.measure;
    // These measures need rods.
    std::vector<std::string_view> wanted;
    const auto add = [&](bool asked, const char* name) {
        if (asked)
            wanted.emplace_back(name);
    };
    add(m.displacement.has_value(), "displacement");
    add(m.flow, "flow");
    add(m.heading_diffusion, "heading_diffusion");
    add(m.from_travel.has_value(), "from_travel");
    add(m.pairs, "pairs");
    if (wanted.empty())
        return;
    const std::string of = fmt::format("{}: {} in [measure] needs rods, and the file has ", file, wanted[0]);
    if (tracks.rods.empty())
        throw InputError(
            of +
            "none: mark them in a column kind (bead, rod), see tracks.columns, or give tracks.rods_file");
    const std::size_t last = std::max(static_cast<std::size_t>(m.rod), std::size_t{m.pairs ? 1U : 0U});
    if (last >= tracks.rods.size())
        throw InputError(
            fmt::format("{}no rod {}: it has {}, numbered from 0 in the order in which they come", of, last,
                        tracks.rods.size()));
    const std::vector<FilmRod> rods = film_rods(tracks);
    if (rods[last].known == 0)
        throw InputError(
            fmt::format("{}no frame in which the heading of rod {} is known: name its column in "
                        "tracks.columns = {{ heading = \"...\" }}, or give ends. With thin_end = \"ahead\" "
                        "the rod must move by at least one bead radius in one unbroken track",
                        of, last));
}

FilmRods::FilmRods(const measure::Tracks& tracks) {
    for (std::size_t rod = 0; rod < tracks.rods.size(); ++rod)
        poses_.push_back(measure::poses_of(tracks, rod));
}

RunTables FilmRods::tables() const {
    return {[](const std::string&, const std::string& what) -> double {
                throw InputError("a film has no " + what);
            },
            [rods = poses_](const std::vector<std::string>& names) {
                std::vector<Column> columns;
                for (const std::string& name : names) { // "t", "x0", "theta12"
                    const std::size_t digits = name.find_first_of("0123456789");
                    std::size_t number = name == "t" ? 0 : rods.size();
                    if (digits != std::string::npos)
                        std::from_chars(name.data() + digits, name.data() + name.size(), number);
                    if (number >= rods.size())
                        throw InputError(fmt::format("the film has no {}: it has {} rods, numbered from 0",
                                                     name, rods.size()));
                    const measure::HeadingTrack& rod = rods[number];
                    columns.push_back(name == "t"      ? rod.time
                                      : name[0] == 'x' ? rod.x
                                      : name[0] == 'y' ? rod.y
                                                       : rod.heading);
                }
                return columns;
            }};
}

std::string FilmRods::csv() const {
    RecordTable table;
    std::vector<FilmTime> times;
    for (const double t : poses_.at(0).time)
        times.push_back({t});
    table.add(times);
    for (std::size_t rod = 0; rod < poses_.size(); ++rod) {
        std::vector<FilmPose> rows;
        for (std::size_t f = 0; f < poses_[rod].time.size(); ++f) {
            double speed = std::nan("");
            if (f > 0) {
                const double heading = 0.5 * (poses_[rod].heading[f - 1] + poses_[rod].heading[f]);
                speed = (std::cos(heading) * (poses_[rod].x[f] - poses_[rod].x[f - 1]) +
                         std::sin(heading) * (poses_[rod].y[f] - poses_[rod].y[f - 1])) /
                        (poses_[rod].time[f] - poses_[rod].time[f - 1]);
            }
            rows.push_back({poses_[rod].x[f], poses_[rod].y[f], poses_[rod].heading[f], speed});
        }
        table.add(rows, std::to_string(rod));
    }
    return table.csv();
}

std::span<const ColumnInfo> film_rod_columns() { return columns_of<FilmTime, Each<FilmPose>>(); }

} // namespace rodwake::app
