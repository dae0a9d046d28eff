#include "measure_parts.hpp"

#include <fmt/format.h>

#include <cmath>

namespace rodwake::app {

std::string text(const Estimate& e) {
    if (e.count == 0)
        return "not measured";
    return e.known() ? fmt::format("{:.4g} +- {:.2g}", e.value, e.error)
                     : fmt::format("{:.4g} (error unknown)", e.value);
}

std::vector<double> of_summaries(const MeasuredCase& data, const std::string& name, const std::string& what) {
    std::vector<double> values;
    for (const RunTables& run : data.tables)
        values.push_back(run.summary(name, what));
    return values;
}

measure::HeadingTrack track_of(const scene::Measure& m, const RunTables& run) {
    const auto name = [&](const char* column) { return fmt::format("{}{}", column, m.rod); };
    const std::vector<Column> all = run.tracks({"t", name("x"), name("y"), name("theta")});
    const Column &t = all[0], &x = all[1], &y = all[2], &theta = all[3];
    measure::HeadingTrack track;
    std::size_t start = 0;
    bool travelled = !m.from_travel;
    const auto unknown = [&](std::size_t i) { return std::isnan(x[i]) || std::isnan(theta[i]); };
    while (start < t.size() && (t[start] < -1e-12 || unknown(start))) // the rods are held, or not seen yet
        ++start;
    std::size_t end = t.size();
    while (end > start && unknown(end - 1))
        --end;
    for (std::size_t i = start; i < end; ++i) {
        travelled =
            travelled || (!unknown(i) && std::hypot(x[i] - x[start], y[i] - y[start]) >= *m.from_travel);
        if (!travelled || t[i] < m.from - 1e-12)
            continue;
        track.time.push_back(t[i]);
        track.x.push_back(x[i]);
        track.y.push_back(y[i]);
        track.heading.push_back(theta[i]);
    }
    return track;
}

Column scaled(const Column& values, double scale) {
    Column out = values;
    for (double& value : out)
        value *= scale;
    return out;
}

Column vectors(const Column& x, const Column& y, double scale) {
    Column out;
    for (std::size_t i = 0; i < x.size(); ++i)
        out.insert(out.end(), {x[i] * scale, y[i] * scale, 0.0});
    return out;
}

} // namespace rodwake::app
