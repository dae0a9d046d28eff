#include "rodwake/scene/read.hpp"

#include "apply_overrides.hpp"
#include "check.hpp"
#include "diagnostics.hpp"
#include "fields.hpp"
#include "reader.hpp"
#include "rodwake/scene/set.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>

namespace rodwake::scene {

namespace {

Scene resolve(const Node& root, Diagnostics& diagnostics) {
    Scene scene;
    Reader reader(root, diagnostics);
    fields(reader, scene);
    reader.finish();
    check(scene, &root, diagnostics);
    return scene;
}

void remove_key(Node& root, const std::string& key) {
    std::erase_if(*root.as<Node::Table>(), [&](const Entry& entry) { return entry.key == key; });
}

/// What is wrong beyond what is wrong already.
void add_new(const Diagnostics& own, const std::string& when, Diagnostics& diagnostics) {
    const std::vector<Diagnostic> known = diagnostics.list();
    for (Diagnostic problem : own.list())
        if (std::find(known.begin(), known.end(), problem) == known.end()) {
            problem.message = when + problem.message;
            diagnostics.add(problem);
        }
}

/// Names in a list, or keys of a table, of [fit].
std::vector<std::string> names_in(const Node& fit, std::string_view key) {
    std::vector<std::string> names;
    const Entry* entry = fit.find(key);
    if (const auto* table = entry ? entry->value.as<Node::Table>() : nullptr)
        for (const Entry& item : *table)
            names.push_back(item.key);
    if (const auto* list = entry ? entry->value.as<Node::List>() : nullptr)
        for (const Node& node : *list)
            if (const auto* name = node.as<std::string>())
                names.push_back(*name);
    return names;
}

/// The parameter of a fit that a key of the physics stands for, and its value.
std::optional<std::pair<std::string, double>> held_by(const Override& item) {
    const auto* real = item.value.as<double>();
    const auto* whole = item.value.as<std::int64_t>();
    const auto dot = item.path.find('.');
    if ((!real && !whole) || dot == std::string::npos)
        return std::nullopt;
    const double value = real ? *real : static_cast<double>(*whole);
    const std::string table = item.path.substr(0, dot), name = item.path.substr(dot + 1);
    if (table == "coupling" && (rods::find_coupling(name) || rods::find_other_turning(name)))
        return std::pair(name, value);
    if (table == "medium" && (name == "eta" || name == "alpha"))
        return std::pair(name, value);
    if (table == "medium" && name == "xi" && value > 0.0) // in f/mu, whatever unit the data are in
        return std::pair(std::string("alpha"), 1.0 / value);
    return std::nullopt;
}

/// The document of a rival: its settings made, and [fit] without what it does not use. A number of the medium
/// or a coupling that its fit does not name is held there.
Node model_document(Node root, const std::vector<Override>& set, Diagnostics& diagnostics) {
    remove_key(root, "variants");
    remove_key(root, "figures");
    if (Entry* fit = root.find("fit"))
        remove_key(fit->value, "models");
    for (const Override& item : set) {
        const std::string table = item.path.substr(0, item.path.find('.'));
        if (!held_by(item) || root.find(table))
            apply_override(root, item, diagnostics);
    }
    Entry* fit = root.find("fit");
    if (!fit || !fit->value.as<Node::Table>())
        return root;
    const auto used = [&] {
        std::vector<std::string> names;
        for (const char* key : {"parameters", "fixed", "tied"})
            for (std::string& name : names_in(root.find("fit")->value, key))
                names.push_back(std::move(name));
        return names;
    };
    for (const Override& item : set)
        if (const auto held = held_by(item);
            held && !contains(used(), held->first) && !(held->first == "alpha" && contains(used(), "xi")))
            apply_override(root, {"fit.fixed." + held->first, Node{item.place, held->second}, item.place},
                           diagnostics);
    // Keys of [fit] for parameters that the rival does not have are removed; those that the rival sets itself
    // stay, to be refused.
    Node& own = root.find("fit")->value;
    const auto set_by_rival = [&](const std::string& path) {
        return std::ranges::find(set, path, &Override::path) != set.end();
    };
    for (const char* key : {"start", "bounds", "likelihood"}) {
        const auto unused = [&, names = used()](const std::string& name) {
            return !contains(names, name) && !set_by_rival(fmt::format("fit.{}.{}", key, name));
        };
        Entry* entry = own.find(key);
        if (auto* table = entry ? entry->value.as<Node::Table>() : nullptr)
            std::erase_if(*table, [&](const Entry& item) { return unused(item.key); });
        if (auto* list = entry ? entry->value.as<Node::List>() : nullptr)
            std::erase_if(*list, [&](const Node& node) {
                const auto* name = node.as<std::string>();
                return name && unused(*name);
            });
    }

    // Only what is fitted has a prior.
    const std::vector<std::string> fitted = names_in(own, "parameters");
    Entry* posterior = own.find("posterior");
    Entry* priors = posterior ? posterior->value.find("priors") : nullptr;
    if (auto* table = priors ? priors->value.as<Node::Table>() : nullptr)
        std::erase_if(*table, [&](const Entry& entry) {
            return !contains(fitted, entry.key) && std::ranges::none_of(set, [&](const Override& item) {
                return item.path.starts_with("fit.posterior.priors." + entry.key);
            });
        });
    return root;
}

/// How it is sampled makes no other model.
Fit model_of(Fit fit) {
    fit.models.clear();
    if (fit.posterior)
        fit.posterior = FitPosterior{.priors = fit.posterior->priors};
    return fit;
}

/// Each rival by itself, and against those before it.
void check_models(const Node& root, const Scene& scene, Diagnostics& diagnostics) {
    if (!scene.fit || scene.fit->models.empty())
        return;
    const auto& listed = *root.find("fit")->value.find("models")->value.as<Node::List>();
    std::vector<Fit> seen = {model_of(*scene.fit)};
    for (std::size_t i = 0; i < listed.size(); ++i) {
        const Entry* set = listed[i].find("set");
        if (!set)
            continue;
        Diagnostics own;
        const Scene rival = resolve(model_document(root, variant_overrides(set->value), own), own);
        const std::string path = fmt::format("fit.models[{}]", i);
        add_new(own, "with " + path + " applied: ", diagnostics);
        if (!own.empty() || !rival.fit)
            continue;
        const Fit &fit = *scene.fit, &other = *rival.fit;
        const std::pair<const char*, bool> data[] = {
            {"profiles", fit.profiles != other.profiles},
            {"trajectories", fit.trajectories != other.trajectories},
            {"maps", fit.maps != other.maps},
            {"masks", fit.masks != other.masks},
            {"core", fit.core != other.core},
            {"independent_spacing", fit.independent_spacing != other.independent_spacing},
            {"length_unit", fit.length_unit != other.length_unit}};
        const auto* const changed = std::ranges::find(data, true, &std::pair<const char*, bool>::second);
        if (changed != std::end(data))
            diagnostics.add(
                set->key_place, path + ".set",
                fmt::format("{}.set changes the data (fit.{}): models can only be compared on the "
                            "same data; leave it out, or make a separate fit",
                            path, changed->first));
        const auto same = std::ranges::find(seen, model_of(*rival.fit));
        if (same != seen.end())
            diagnostics.add(
                set->key_place, path + ".set",
                fmt::format("{}.set gives the same model as {}: change a key of [fit] that alters "
                            "the model, such as fit.parameters or fit.fixed",
                            path,
                            same == seen.begin() ? "the fit as written"
                                                 : fmt::format("fit.models[{}]", same - seen.begin() - 1)));
        seen.push_back(model_of(*rival.fit));
    }
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
    Diagnostics diagnostics;
    for (const std::string& setting : settings) {
        const auto item = parse_override(setting, diagnostics);
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
    return parse_scene(text, path.string(), overrides);
}

Scene parse_scene(std::string_view text, std::string name, std::span<const std::string> overrides) {
    if (text.size() > max_scene_bytes)
        throw SceneError({{name, 0, 0, "",
                           fmt::format("larger than {} MiB; a scene may have at most {} rods",
                                       max_scene_bytes >> 20, max_rods)}});
    Diagnostics diagnostics;
    auto root = parse_toml(text, name, diagnostics);
    for (const auto& override_text : overrides)
        if (const auto item = parse_override(override_text, diagnostics); item && root)
            apply_override(*root, *item, diagnostics);
    if (!root)
        diagnostics.throw_if_any();
    Scene scene = resolve(*root, diagnostics);
    // Each variant is applied to the document, and what is wrong with it beyond what is wrong already
    // reported.
    if (!scene.variants.empty()) { // empty: there are none, or too many, which is reported
        Node base = *root;
        remove_key(base, "variants");
        remove_key(base, "figures");
        const auto& listed = *root->find("variants")->value.as<Node::List>();
        for (std::size_t i = 0; i < listed.size(); ++i)
            if (const Entry* set = listed[i].find("set")) {
                Node variant = base;
                Diagnostics own;
                for (const auto& item : variant_overrides(set->value))
                    apply_override(variant, item, own);
                resolve(variant, own);
                add_new(own, fmt::format("with variants[{}] applied: ", i), diagnostics);
            }
    }
    check_models(*root, scene, diagnostics);
    diagnostics.throw_if_any();
    scene.path = std::move(name);
    return scene;
}

Scene apply_model(const Scene& scene, const FitModel& model) {
    Diagnostics diagnostics;
    const auto root = parse_toml(to_toml(scene), scene.path, diagnostics);
    std::vector<Override> set;
    for (const std::string& setting : model.set)
        if (auto item = parse_override(setting, diagnostics))
            set.push_back(*std::move(item));
    Scene rival = root ? resolve(model_document(*root, set, diagnostics), diagnostics) : Scene{};
    diagnostics.throw_if_any();
    rival.path = scene.path;
    rival.fit->name = model.name;
    return rival;
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
