#include "fit_data.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/store/csv.hpp"
#include "rodwake/store/hdf5_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>

namespace rodwake::app {

namespace {

namespace fs = std::filesystem;
using Column = std::vector<double>;

[[noreturn]] void refuse(const fs::path& file, const std::string& why) {
    throw InputError(fmt::format("{}: fit.maps.files: {}", file.string(), why));
}

double step_between(const Column& positions) { return positions[1] - positions[0]; }

/// Spacing of the even grid of which all positions are roundings; nothing if there is none, or if the
/// rounding might hide that a position is missing.
std::optional<double> rounded_step(const Column& positions) {
    // They are rounded by half the last decimal of all positions, or by half the last digit of each,
    // whichever is larger: programs write as many of the one or of the other. Single precision rounds, too.
    constexpr double single = 6e-8; // 2^-24, relative
    std::vector<int> exponents;
    int decimals = -400, digits = 1;
    for (const double position : positions) {
        std::array<char, 32> text{}; // "1.2346e-01"
        std::to_chars(text.data(), text.data() + text.size(), std::abs(position),
                      std::chars_format::scientific);
        const std::string_view shown(text.data());
        const auto e = shown.find('e');
        exponents.push_back(position == 0.0 ? -400 : std::stoi(text.data() + e + 1));
        const int own = std::max(1, static_cast<int>(e) - 1);
        digits = std::max(digits, own);
        decimals = position == 0.0 ? decimals : std::max(decimals, own - 1 - exponents.back());
    }
    Column half(positions.size());
    for (std::size_t k = 0; k < half.size(); ++k)
        half[k] =
            std::max({0.5001 * std::pow(10.0, -decimals), 0.5001 * std::pow(10.0, exponents[k] - digits + 1),
                      single * std::abs(positions[k])});

    // Each pair bounds the step.
    double least = 0.0, most = HUGE_VAL;
    for (std::size_t j = 1; j < positions.size(); ++j)
        for (std::size_t i = 0; i < j; ++i) {
            const double apart = positions[j] - positions[i], slack = half[i] + half[j];
            least = std::max(least, (apart - slack) / static_cast<double>(j - i));
            most = std::min(most, (apart + slack) / static_cast<double>(j - i));
            if (least > most)
                return std::nullopt;
        }
    const double step = 0.5 * (least + most);
    return std::ranges::max(half) <= step / 8.0 ? std::optional(step) : std::nullopt;
}

/// The places, or the even ones of which they are roundings.
Column even(const fs::path& file, Column positions, const char* axis) {
    if (positions.size() < 2)
        refuse(file, fmt::format("a map needs two {} or more; it has {}", axis, positions.size()));
    const auto uneven = std::ranges::adjacent_find(positions, [&](double a, double b) {
        return std::abs(b - a - step_between(positions)) > 1e-6 * std::abs(step_between(positions));
    });
    if (uneven == positions.end())
        return positions;
    const auto step = rounded_step(positions);
    if (!step)
        refuse(file, fmt::format(
                         "its {} are not evenly spaced: {:g} follows {:g}, and the first two are {:g} apart; "
                         "are rows of the table missing?",
                         axis, uneven[1], uneven[0], step_between(positions)));
    // a grid that is the same on both sides of 0 stays so
    const double start =
        0.5 * (positions.front() + positions.back() - *step * static_cast<double>(positions.size() - 1));
    for (std::size_t k = 0; k < positions.size(); ++k)
        positions[k] = start + static_cast<double>(k) * *step;
    return positions;
}

Column layer(const store::Hdf5Reader& h5, const fs::path& file, const std::string& path,
             const fitting::Map& map, bool or_unknown) {
    if (!h5.has(path))
        refuse(file, "has no " + path);
    store::Hdf5Dataset data = h5.dataset(path, or_unknown);
    if (data.shape != std::vector<std::size_t>{map.y.size(), map.x.size()})
        refuse(file, path + " has another number of bins than its x and y");
    return data.values;
}

fitting::Map of_group(const store::Hdf5Reader& h5, const fs::path& file, const std::string& group) {
    fitting::Map map;
    map.x = h5.dataset(group + "/x").values;
    map.y = h5.dataset(group + "/y").values;
    map.Ux = layer(h5, file, group + "/Ux", map, false);
    map.Uy = layer(h5, file, group + "/Uy", map, false);
    map.sigma_x = layer(h5, file, group + "/sigma_x", map, true);
    map.sigma_y = layer(h5, file, group + "/sigma_y", map, true);
    for (const double count : layer(h5, file, group + "/count", map, false))
        map.known.push_back(count > 0.0);
    map.x = even(file, map.x, "columns x");
    map.y = even(file, map.y, "rows y");
    map.lx = step_between(map.x) * static_cast<double>(map.x.size());
    map.ly = step_between(map.y) * static_cast<double>(map.y.size());
    map.speed = h5.real(group, "mean_speed_a_per_s");
    return map;
}

/// Of each run if the file has them, else of all together.
std::vector<fitting::Map> of_measure(const fs::path& file) {
    const store::Hdf5Reader h5(file);
    if (!h5.has("/displacement/x") || !h5.has("/displacement/y"))
        refuse(file, "has no displacement field (/displacement); rodwake measure writes one with "
                     "measure.displacement = \"phase\"");
    if (h5.has_attribute("/displacement", "window_margin"))
        refuse(file,
               "was measured in a window of a film, and fits of maps need a periodic box; fit its profiles");
    std::vector<fitting::Map> maps;
    for (std::size_t run = 1; h5.has(fmt::format("/runs/{:04}/x", run)); ++run)
        maps.push_back(of_group(h5, file, fmt::format("/runs/{:04}", run)));
    if (maps.empty())
        maps.push_back(of_group(h5, file, "/displacement"));
    return maps;
}

/// The different values, increasing. Places of a column or row may differ in their last bits.
Column places_of(Column values) {
    std::ranges::sort(values);
    const double apart = values.empty() ? 0.0 : 1e-6 * (values.back() - values.front());
    values.erase(
        std::unique(values.begin(), values.end(), [&](double a, double b) { return b - a <= apart; }),
        values.end());
    return values;
}

fitting::Map of_table(const fs::path& file, const scene::ColumnUnits& units) {
    static const std::vector<std::string> required = {"x", "y", "Ux", "Uy"},
                                          optional = {"sigma_x", "sigma_y"};
    const store::Table table = store::read_csv(file, required, optional);
    const Column &x = *table.find("x"), &y = *table.find("y");
    const Column *sigma_x = table.find("sigma_x"), *sigma_y = table.find("sigma_y");
    if ((sigma_x == nullptr) != (sigma_y == nullptr))
        refuse(file, "columns sigma_x and sigma_y come together");
    fitting::Map map;
    const Column columns = places_of(x), rows = places_of(y);
    map.x = even(file, columns, "columns x");
    map.y = even(file, rows, "rows y");
    map.known.assign(map.bins(), false);
    for (Column* values : {&map.Ux, &map.Uy, &map.sigma_x, &map.sigma_y})
        values->assign(map.bins(), std::nan(""));
    for (std::size_t i = 0; i < table.rows(); ++i) {
        const auto slot = [](const Column& positions, double at) {
            return static_cast<std::size_t>(std::ranges::upper_bound(positions, at) - positions.begin()) - 1;
        };
        const std::size_t bin = slot(rows, y[i]) * map.x.size() + slot(columns, x[i]);
        if (map.known[bin])
            throw InputError(fmt::format("{}:{}: x = {:g}, y = {:g} appears twice", file.string(),
                                         table.lines[i], x[i], y[i]));
        map.known[bin] = true;
        map.Ux[bin] = (*table.find("Ux"))[i];
        map.Uy[bin] = (*table.find("Uy"))[i];
        map.sigma_x[bin] = sigma_x ? (*sigma_x)[i] : std::nan("");
        map.sigma_y[bin] = sigma_y ? (*sigma_y)[i] : std::nan("");
    }
    for (Column* places : {&map.x, &map.y})
        std::ranges::for_each(*places, [&](double& position) { position *= units.place_factor; });
    for (Column* values : {&map.Ux, &map.Uy, &map.sigma_x, &map.sigma_y})
        std::ranges::for_each(*values, [&](double& value) { value *= units.value_factor; });
    return map;
}

} // namespace

bool needs_speed(const scene::Fit& keys) {
    return scene::fit_has(keys, "zeta") || scene::fit_has(keys, "rho") || scene::fit_has(keys, "eta_s");
}

std::string FitMapData::label() const {
    return run > 0 ? fmt::format("{}, run {}", file.filename().string(), run) : file.filename().string();
}

std::vector<FitMapData> read_fit_maps(const scene::FitMap& keys, const fs::path& file,
                                      std::optional<double> independent_spacing, bool needs_speed,
                                      const std::string& length_unit) {
    const bool table = file.extension() == ".csv";
    if (!table && (length_unit == "m" || length_unit == "cm" || length_unit == "mm" || length_unit == "um"))
        refuse(file,
               fmt::format(
                   "it is in bead radii and fit.length_unit = \"{}\" is the unit of all lengths here: leave "
                   "length_unit out, strings with a unit are converted to bead radii then",
                   length_unit));
    const std::vector<fitting::Map> maps =
        table ? std::vector{of_table(file, keys.columns)} : of_measure(file);
    if (table && keys.box.empty())
        refuse(file, "a table does not contain the size of its periodic box: give fit.maps.box = [Lx, Ly]");
    if (table && needs_speed && !keys.speed)
        refuse(file, "zeta, rho and eta_s depend on the rod's speed, which a table does not contain: give "
                     "fit.maps.speed");
    const std::string name = keys.name.empty() ? file.filename().string() : keys.name;
    std::vector<FitMapData> out;
    for (const fitting::Map& map : maps) {
        const std::size_t run = maps.size() > 1 ? out.size() + 1 : 0;
        FitMapData read{run > 0 ? fmt::format("{}, run {}", name, run) : name, file, 0, map, 0, false, run};
        fitting::Map& data = read.data;
        data.name = read.label();
        data.speed = keys.speed.value_or(data.speed);

        // A person may give the box of the scene, from which that of granular.box = "fit" differs by up to 1
        // %.
        if (!table && !keys.box.empty() &&
            !(std::abs(keys.box[0] / data.lx - 1.0) < 1e-2 && std::abs(keys.box[1] / data.ly - 1.0) < 1e-2))
            refuse(file,
                   fmt::format(
                       "it was measured in a box of {:g} x {:g}, not {:g} x {:g}: leave fit.maps.box out",
                       data.lx, data.ly, keys.box[0], keys.box[1]));
        if (table) {
            data.lx = keys.box[0];
            data.ly = keys.box[1];
        }
        const double across = data.x.back() - data.x.front(), up = data.y.back() - data.y.front();
        if (across > data.lx * (1.0 + 1e-6) || up > data.ly * (1.0 + 1e-6))
            refuse(file, fmt::format("its grid is {:g} x {:g}, larger than the box of {:g} x {:g}", across,
                                     up, data.lx, data.ly));
        settle_map(read, independent_spacing);
        out.push_back(std::move(read));
    }
    return out;
}

} // namespace rodwake::app
