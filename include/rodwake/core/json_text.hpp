#pragma once
// The one place that turns JSON into text.

#include <string>

namespace rodwake {

/// UTF-8, whatever the strings hold: bytes that are not, of names of folders and of files of others, become
/// U+FFFD. `Json` is one of nlohmann's classes; without an indent the text is one line.
template<class Json>
std::string json_text(const Json& json, int indent = -1) {
    return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

} // namespace rodwake
