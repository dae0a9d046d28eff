// The page is a template with places for its parts: styles, scripts, the kernels in base64, and what it
// starts from.

#include "rodwake/app/explore.hpp"

#include "rodwake/app/rods.hpp"
#include "rodwake/core/build_info.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/json_text.hpp"
#include "rodwake/scene/document.hpp"
#include "rodwake/scene/read.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <sstream>

namespace rodwake::app {

namespace {

using nlohmann::ordered_json;

/// In the order in which they are one script.
constexpr const char* scripts[] = {"kernel.js", "rodwake.js", "state.js",   "controls.js", "stage.js",
                                   "wake.js",   "paths.js",   "diagram.js", "files.js",    "page.js"};
/// What the page can do with the keys of [medium], [coupling] and [rods_run]. It starts from those with a
/// number, under their names, and shows their symbols, units and meanings. The others are harmless: they are
/// said in those numbers, or say how the same encounter is solved. Any key that is not here has to keep its
/// default, or there is no page.
struct PageKey {
    std::string_view table, name;
    double (*number)(const rods::RodProblem&) = nullptr;
};
using P = const rods::RodProblem&;
constexpr PageKey page_keys[] = {
    {"medium", "eta", [](P p) { return p.medium->eta; }},
    {"medium", "alpha", [](P p) { return 1.0 / p.medium->xi; }},
    {"rods_run", "t_end", [](P p) { return p.t_end; }},
    {"rods_run", "contact_distance", [](P p) { return p.contact_distance.value_or(0.0); }},
    {"coupling", "kappa", [](P p) { return p.couplings.kappa; }},
    {"coupling", "gamma1", [](P p) { return p.couplings.gamma1; }},
    {"coupling", "gamma2", [](P p) { return p.couplings.gamma2; }},
    {"medium", "xi"},               // which is what a scene has of eta and alpha in all their forms
    {"coupling", "polar_basis"},    // in the numbers of the gammas
    {"coupling", "gamma_flow"},     // likewise
    {"coupling", "rows_direction"}, // without gamma_rows nothing
    {"rods_run", "output_times"},
    {"rods_run", "output_interval"},
    {"rods_run", "method"},
    {"rods_run", "form"},
    {"rods_run", "rtol"},
    {"rods_run", "atol"},
    {"rods_run", "max_steps"},
    {"rods_run", "turning_tolerance"}, // of sums over many rods, as the next
    {"rods_run", "precision"}};

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

void put(std::string& page, std::string_view location, const std::string& what) {
    const std::size_t at = page.find(location);
    if (at == std::string::npos)
        throw RunError(fmt::format("explorer/page.html has no {}; install rodwake anew", location));
    page.replace(at, location.size(), what);
}

} // namespace

std::string explorer_page(const std::filesystem::path& folder, const std::optional<ExplorerStart>& start) {
    ordered_json state;
    if (start) {
        if (const std::vector<std::string> left = left_out_by_explorer(start->scene); !left.empty())
            throw InputError(fmt::format("no page of this scene: {}", fmt::join(left, "; ")));
        const rods::RodProblem problem = rod_problem(start->scene);
        for (const PageKey& key : page_keys)
            if (key.number != nullptr)
                state[std::string(key.name)] = key.number(problem);
        for (const std::size_t rod : {0u, 1u}) {
            const rods::Pose& pose = problem.rods[rod];
            state[fmt::format("x{}", rod)] = pose.x;
            state[fmt::format("y{}", rod)] = pose.y;
            state[fmt::format("theta{}", rod)] = pose.heading;
        }
    }
    ordered_json keys;
    const auto schema = nlohmann::json::parse(scene::schema_json());
    for (const PageKey& shown : page_keys)
        for (const auto& key : schema["keys"])
            if (shown.number != nullptr && key["table"] == shown.table && key["key"] == shown.name)
                keys[std::string(shown.name)] = {{"symbol", key.value("symbol", "")},
                                                 {"unit", key.contains("unit") ? key["unit"]["reduced"] : ""},
                                                 {"meaning", key["meaning"]},
                                                 {"range", key["range"]}};
    const ordered_json setup = {{"version", build_info().version},
                                {"scene", start ? ordered_json(start->name) : ordered_json()},
                                {"state", state},
                                {"keys", keys}};
    std::string setup_text; // JSON that may stand in a script: no "</script>" in it
    for (const char c : json_text(setup))
        setup_text += c == '<' ? std::string("\\u003c") : std::string(1, c);
    std::string code;
    for (const char* script : scripts)
        code += part_of_page(folder / script) + "\n";
    std::string page = part_of_page(folder / "page.html");
    put(page, "{{style}}", part_of_page(folder / "page.css"));
    put(page, "{{setup}}", setup_text);
    put(page, "{{kernel}}", base64(part_of_page(folder / "kernel.wasm")));
    put(page, "{{script}}", code);
    return page;
}

std::vector<std::string> left_out_by_explorer(const scene::Scene& scene) {
    std::vector<std::string> left;
    if (!scene.rods_run)
        left.emplace_back("no [rods_run]: the page shows encounters of two rods of the theory");
    if (scene.rods.size() != 2)
        left.push_back(fmt::format("rods: {}; the page shows encounters of two", scene.rods.size()));
    if (!scene.medium)
        left.emplace_back("no [medium]: rods without one walk straight, and there is no wake to show");
    if (scene.noise)
        left.emplace_back("[noise]: the page has none");
    if (bodies_of(scene).any())
        left.emplace_back("[body]: rods of the page are points");
    std::istringstream written(scene::to_toml(scene)); // every key with its value
    std::string table;
    for (std::string line; std::getline(written, line);) {
        if (line.starts_with('['))
            table = line.substr(1, line.find(']') - 1);
        const std::size_t equals = line.find(" = ");
        if ((table != "medium" && table != "coupling" && table != "rods_run") || equals == std::string::npos)
            continue;
        const std::string name = line.substr(0, equals), key = table + "." + name;
        const bool known = std::ranges::any_of(page_keys, [&](const PageKey& page_key) {
            return page_key.table == table && page_key.name == name;
        });
        if (!known && line.substr(equals + 3) != scene::key_info(key).value().default_value)
            left.push_back(fmt::format("{}: the page has only two rods in the exact steady field on the "
                                       "infinite plane, turned by kappa, gamma1, gamma2 and gamma_flow",
                                       table + "." + line));
    }
    return left;
}

} // namespace rodwake::app
