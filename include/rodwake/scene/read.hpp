#pragma once
// Reading a scene: TOML in, a checked Scene in reduced units out, or one SceneError that lists every problem.
//
// Overrides are those of `-s`: "table.key=value". The value is TOML; what is not TOML is taken as a string,
// so quotes may be left out ("rods_run.method=adams", "rods_run.t_end=5 s"). List entries go by index from 0:
// "rods.1.heading=0.3", "rods.1.position.0=2.0". Overriding one of several alternative keys (alpha for xi)
// drops the alternative that the file gives. "table.key=" takes the key out, or a table, or an entry of a
// list.

#include "rodwake/scene/problem.hpp"
#include "rodwake/scene/scene.hpp"

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace rodwake::scene {

/// Largest scene that is read, bytes.
inline constexpr std::size_t max_scene_bytes = std::size_t{16} << 20;

/// Throws SceneError, also when the file is missing, a directory, unreadable or too large.
Scene read_scene(const std::filesystem::path& path, std::span<const std::string> overrides = {});

/// The same for text; `name` stands for the file in messages and becomes Scene::path.
Scene parse_scene(std::string_view text, std::string name, std::span<const std::string> overrides = {});

/// The scene with the variant's settings applied: without variants and figures, everything else as in
/// `scene`. Variants of a scene that was read have been checked already; throws SceneError for one made by
/// hand that is wrong.
Scene apply_variant(const Scene& scene, const Variant& variant);

} // namespace rodwake::scene
