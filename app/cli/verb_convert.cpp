// rodwake convert: tracks and trajectories from one format into another.

#include "rodwake/app/convert.hpp"
#include "rodwake/core/error.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace rodwake::cli {

int verb_convert(const Options& options) {
    app::ConvertRequest request = options.convert;
    request.in = options.target;
    request.out = options.output;
    request.force = options.force;
    const auto format = std::ranges::find(track_format_names, options.format);
    if (format != std::end(track_format_names))
        request.format = static_cast<TrackFormat>(format - std::begin(track_format_names));
    for (const std::string& column : options.columns) {
        const std::size_t equals = std::min(column.find('='), column.size());
        app::name_column(request, std::string_view(column).substr(0, equals),
                         column.substr(std::min(equals + 1, column.size())));
    }
    if (app::convert(request, context_of(options)))
        return 0;
    return signal_exit_code(stop_signal());
}

} // namespace rodwake::cli
