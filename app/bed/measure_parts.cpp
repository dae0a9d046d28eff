#include "measure_parts.hpp"

#include <fmt/format.h>

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
