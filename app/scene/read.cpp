#include "rodwake/scene/read.hpp"

#include "apply_overrides.hpp"
#include "check.hpp"
#include "fields.hpp"
#include "problems.hpp"
#include "reader.hpp"
#include "rodwake/scene/set.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>

namespace rodwake::scene {

namespace {

Scene resolve(const Node& root, Problems& problems) {
    Scene scene;
    Reader reader(root, problems);
    fields(reader, scene);
    reader.finish();
    check(scene, root, problems);
    return scene;
}

void remove_key(Node& root, const std::string& key) {
    std::erase_if(*root.as<Node::Table>(), [&](const Entry& entry) { return entry.key == key; });
}

/// Applies one variant to the document and reports what is wrong with it beyond what is wrong already.
void check_variant(Node root, const Node& variant, const std::string& path, Problems& problems) {
    const Entry* set = variant.find("set");
    if (!set)
        return;
    Problems own;
    for (const auto& item : variant_overrides(set->value))
        apply_override(root, item, own);
    resolve(root, own);
    const std::vector<Problem> known = problems.list();
    for (Problem problem : own.list())
        if (std::find(known.begin(), known.end(), problem) == known.end()) {
            problem.message = fmt::format("with {} applied: {}", path, problem.message);
            problems.add(problem);
        }
}

void check_variants(const Node& root, const Scene& scene, Problems& problems) {
    if (scene.variants.empty()) // none, or too many: reported
        return;
    const auto& listed = *root.find("variants")->value.as<Node::List>();
    Node base = root;
    remove_key(base, "variants");
    remove_key(base, "figures");
    for (std::size_t i = 0; i < listed.size(); ++i)
        check_variant(base, listed[i], fmt::format("variants[{}]", i), problems);
}

void check_size(std::size_t bytes, const std::string& name) {
    if (bytes > max_scene_bytes)
        throw SceneError({{name, 0, 0, "",
                           fmt::format("larger than {} MiB; a scene may have at most {} rods",
                                       max_scene_bytes >> 20, max_rods)}});
}

std::string read_text(const std::filesystem::path& path) {
    const auto fail = [&](const char* why) { throw SceneError({{path.string(), 0, 0, "", why}}); };
    std::error_code error;
    const auto type = std::filesystem::status(path, error).type();
    if (type == std::filesystem::file_type::not_found)
        fail("no such file");
    if (type == std::filesystem::file_type::directory)
        fail("is a directory, not a scene file");
    std::ifstream in(path, std::ios::binary);
    std::string text(max_scene_bytes + 1, '\0');
    if (!in.is_open() || in.read(text.data(), static_cast<std::streamsize>(text.size())).bad())
        fail("cannot be read");
    text.resize(static_cast<std::size_t>(in.gcount()));
    return text;
}

/// A setting's value if it is a single one, as TOML has it.
std::optional<Value> single_value(const Node& node) {
    if (const auto* flag = node.as<bool>())
        return *flag;
    if (const auto* whole = node.as<std::int64_t>())
        return *whole;
    if (const auto* real = node.as<double>())
        return *real;
    const auto* text = node.as<std::string>();
    return text ? std::optional<Value>(*text) : std::nullopt;
}

/// The scene with the settings made if each is the value of a key that it has and all fit; else nothing.
std::optional<Scene> with_values(Scene scene, const std::vector<std::string>& settings) try {
    std::vector<std::string> keys;
    std::vector<Value> values;
    Problems problems;
    for (const std::string& setting : settings) {
        const auto item = parse_override(setting, problems);
        const auto value = item ? single_value(item->value) : std::nullopt;
        if (!value)
            return std::nullopt;
        keys.push_back(item->path);
        values.push_back(*value);
    }
    const ValueSetter setter = compile_setter(scene, keys);
    for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = setter.held(values[i], i);
    const bool is_right = !setter.set(scene, values) && validate(scene).empty();
    return is_right ? std::optional(std::move(scene)) : std::nullopt;
} catch (const InputError&) {
    return std::nullopt;
}

} // namespace

Scene read_scene(const std::filesystem::path& path, std::span<const std::string> overrides) {
    return parse_scene(read_text(path), path.string(), overrides);
}

Scene parse_scene(std::string_view text, std::string name, std::span<const std::string> overrides) {
    check_size(text.size(), name);
    Problems problems;
    auto root = parse_toml(text, name, problems);
    for (const auto& override_text : overrides)
        if (const auto item = parse_override(override_text, problems); item && root)
            apply_override(*root, *item, problems);
    if (!root)
        problems.throw_if_any();
    Scene scene = resolve(*root, problems);
    check_variants(*root, scene, problems);
    problems.throw_if_any();
    scene.path = std::move(name);
    return scene;
}

Scene apply_variant(const Scene& scene, const Variant& variant) {
    Scene base = scene;
    base.variants.clear();
    base.figures.clear();
    if (auto changed = with_values(base, variant.set))
        return *std::move(changed);
    // More than values (lists, tables that the scene has not), or wrong, which reading says best.
    return parse_scene(to_toml(base), scene.path, variant.set);
}

} // namespace rodwake::scene
