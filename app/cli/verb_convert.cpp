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
        const std::pair<std::string_view, std::string*> known[] = {{"frame", &request.columns.frame},
                                                                   {"id", &request.columns.id},
                                                                   {"x", &request.columns.x},
                                                                   {"y", &request.columns.y},
                                                                   {"heading", &request.columns.heading},
                                                                   {"kind", &request.columns.kind}};
        const auto* const at = std::ranges::find(known, std::string_view(column).substr(0, equals),
                                                 &std::pair<std::string_view, std::string*>::first);
        if (at == std::end(known) || equals + 1 >= column.size())
            throw InputError(
                fmt::format("--column {}: expected frame, id, x, y, heading or kind and a name, as "
                            "in id=label",
                            column));
        *at->second = column.substr(equals + 1);
    }
    if (app::convert(request, context_of(options)))
        return 0;
    return signal_exit_code(stop_signal());
}

} // namespace rodwake::cli
