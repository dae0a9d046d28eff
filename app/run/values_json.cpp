#include "record_json.hpp"

#include <algorithm>

namespace rodwake::app {

namespace {

using nlohmann::ordered_json;

struct ToJson {
    ordered_json operator()(std::monostate) const { return nullptr; }
    ordered_json operator()(const Estimate& e) const { return estimate_json(e); }
    ordered_json operator()(const auto& value) const { return value; }
};

} // namespace

ordered_json estimate_json(const Estimate& e) {
    return {{"value", e.count > 0 ? ordered_json(e.value) : ordered_json(nullptr)},
            {"error", e.known() ? ordered_json(e.error) : ordered_json(nullptr)},
            {"samples", e.count}};
}

std::string pointer_to(const std::string& name) {
    std::string path = "/" + name;
    std::ranges::replace(path, '.', '/');
    return path;
}

ordered_json values_json(const Values& values) {
    ordered_json out = ordered_json::object();
    for (const auto& [name, value] : values)
        out[ordered_json::json_pointer(pointer_to(name))] = std::visit(ToJson{}, value);
    return out;
}

} // namespace rodwake::app
