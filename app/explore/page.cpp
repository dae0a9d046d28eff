// The page is a template with places for its parts: styles, scripts, the kernels in base64, and what it
// starts from.

#include "rodwake/app/explore.hpp"

#include "rodwake/app/rods.hpp"
#include "rodwake/core/build_info.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/json_text.hpp"
#include "rodwake/scene/document.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cstdint>
#include <fstream>
#include <iterator>

namespace rodwake::app {

namespace {

using nlohmann::ordered_json;

/// In the order in which they are one script.
constexpr const char* scripts[] = {"kernel.js", "rodwake.js", "state.js",   "controls.js", "stage.js",
                                   "wake.js",   "paths.js",   "diagram.js", "files.js",    "page.js"};
/// Keys whose symbols, units and meanings the page shows.
constexpr std::pair<std::string_view, std::string_view> shown_keys[] = {
    {"medium", "eta"},      {"medium", "alpha"},   {"coupling", "kappa"},           {"coupling", "gamma1"},
    {"coupling", "gamma2"}, {"rods_run", "t_end"}, {"rods_run", "contact_distance"}};

std::string part_of_page(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::string text(std::istreambuf_iterator<char>(file), {});
    if (!file.is_open() || file.bad())
        throw RunError(path.string() + ": cannot be read; install rodwake anew");
    return text;
}

std::string base64(std::string_view bytes) {
    constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve(bytes.size() / 3 * 4 + 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t group = 0;
        for (std::size_t k = 0; k < 3; ++k)
            group = group << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
        for (std::size_t k = 0; k < 4; ++k)
            text += i + k <= bytes.size() ? digits[group >> (18 - 6 * k) & 63u] : '=';
    }
    return text;
}

ordered_json described_keys() {
    ordered_json keys;
    const auto schema = nlohmann::json::parse(scene::schema_json());
    for (const auto& [table, name] : shown_keys)
        for (const auto& key : schema["keys"])
            if (key["table"] == table && key["key"] == name)
                keys[std::string(name)] = {{"symbol", key.value("symbol", "")},
                                           {"unit", key.contains("unit") ? key["unit"]["reduced"] : ""},
                                           {"meaning", key["meaning"]},
                                           {"range", key["range"]}};
    return keys;
}

ordered_json start_state(const scene::Scene& scene) {
    if (!scene.rods_run)
        throw InputError("no [rods_run]: the page shows encounters of two rods of the theory");
    const rods::RodProblem problem = rod_problem(scene);
    if (problem.rods.size() < 2)
        throw InputError(fmt::format("rods: {}; the page shows encounters of two", problem.rods.size()));
    if (!problem.medium)
        throw InputError("no [medium]: rods without one walk straight, and there is no wake to show");
    ordered_json state = {{"eta", problem.medium->eta},
                          {"alpha", 1.0 / problem.medium->xi},
                          {"t_end", problem.t_end},
                          {"contact_distance", problem.contact_distance.value_or(0.0)}};
    for (const rods::Coupling& coupling : rods::coupling_list)
        state[std::string(coupling.name)] = problem.couplings.*coupling.number;
    for (const std::size_t rod : {0u, 1u}) {
        const rods::Pose& pose = problem.rods[rod];
        state[fmt::format("x{}", rod)] = pose.x;
        state[fmt::format("y{}", rod)] = pose.y;
        state[fmt::format("theta{}", rod)] = pose.heading;
    }
    return state;
}

/// JSON that may stand in a script: no "</script>" in it.
std::string for_script(const ordered_json& value) {
    std::string text;
    for (const char c : json_text(value))
        text += c == '<' ? std::string("\\u003c") : std::string(1, c);
    return text;
}

void put(std::string& page, std::string_view place, const std::string& what) {
    const std::size_t at = page.find(place);
    if (at == std::string::npos)
        throw RunError(fmt::format("explorer/page.html has no {}; install rodwake anew", place));
    page.replace(at, place.size(), what);
}

} // namespace

std::string explorer_page(const std::filesystem::path& folder, const std::optional<ExplorerStart>& start) {
    ordered_json setup = {{"version", build_info().version},
                          {"scene", start ? ordered_json(start->name) : ordered_json()},
                          {"state", start ? start_state(start->scene) : ordered_json()},
                          {"keys", described_keys()}};
    std::string code;
    for (const char* script : scripts)
        code += part_of_page(folder / script) + "\n";
    std::string page = part_of_page(folder / "page.html");
    put(page, "{{style}}", part_of_page(folder / "page.css"));
    put(page, "{{setup}}", for_script(setup));
    put(page, "{{kernel}}", base64(part_of_page(folder / "kernel.wasm")));
    put(page, "{{script}}", code);
    return page;
}

std::vector<std::string> left_out_by_explorer(const scene::Scene& scene) {
    std::vector<std::string> left;
    if (scene.rods.size() > 2)
        left.push_back(fmt::format("rods: the page shows the first two of {}", scene.rods.size()));
    if (scene.medium && scene.medium->box())
        left.emplace_back("medium.periodic: the page shows the infinite plane");
    if (scene.medium && scene.medium->field != scene::FieldBackend::exact)
        left.emplace_back("medium.field: the page has the exact steady field");
    if (scene.noise)
        left.emplace_back("[noise]: the page has none");
    return left;
}

bool shown_by_explorer(const scene::Scene& scene) {
    return scene.rods_run && scene.rods.size() == 2 && scene.medium && left_out_by_explorer(scene).empty();
}

} // namespace rodwake::app
