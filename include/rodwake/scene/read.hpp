#pragma once
// Reading a scene: TOML in, a checked Scene in reduced units out, or one SceneError that lists every problem.
//
// Overrides are those of `-s`: "table.key=value". The value is TOML; what is not TOML is taken as a string,
// so quotes may be left out ("rods_run.method=adams", "rods_run.t_end=5 s"). List entries go by index from 0:
// "rods.1.heading=0.3", "rods.1.position.0=2.0". Overriding one of several alternative keys (alpha for xi)
// drops the alternative that the file gives. "table.key=" takes the key out, or a table, or an entry of a
// list.

#include "rodwake/core/error.hpp"
#include "rodwake/scene/scene.hpp"

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace rodwake::scene {

// What is wrong with a scene: every problem of a file is collected and reported at once.

struct Diagnostic {
    std::string file; ///< path of the scene, or "-s table.key=value" for a command-line override
    long line = 0;    ///< from 1; 0: the problem is not at one place (override, unreadable file)
    long column = 0;  ///< from 1, in characters
    std::string key;  ///< "rods[1].position"; empty: the file as a whole
    std::string message;

    /// "file:line:column: message", the form that editors and terminals jump to.
    std::string text() const;
    bool operator==(const Diagnostic&) const = default;
};
using Problem [[deprecated("it is Diagnostic")]] = Diagnostic;

/// The scene cannot be used. what() lists the problems, one a line in order of place, at most
/// `listed_at_most`.
class SceneError : public InputError {
public:
    static constexpr std::size_t listed_at_most = 50;

    /// `unstored` problems were found beyond those given; they are counted in the text.
    explicit SceneError(std::vector<Diagnostic> diagnostics, std::size_t unstored = 0);
    const std::vector<Diagnostic>& diagnostics() const { return diagnostics_; }
    [[deprecated("it is diagnostics()")]] const std::vector<Diagnostic>& problems() const {
        return diagnostics_;
    }

private:
    std::vector<Diagnostic> diagnostics_;
};

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

/// The scene with [fit] as a rival of [[fit.models]] has it, under the rival's name: without models, variants
/// and figures. Throws as apply_variant.
Scene apply_model(const Scene& scene, const FitModel& model);

/// The scene as TOML with every default written out, numbers in the scene's own unit system.
/// parse_scene(to_toml(scene), scene.path) == scene, to the last bit: numbers carry up to 17 digits, and one
/// that SI cannot hold exactly is written in reduced units ("2.5 f/mu").
std::string to_toml(const Scene& scene);

/// The same without comments, but with the gap of the bed that is used: equal for scenes that mean the same,
/// whatever the documentation says of their keys.
std::string to_plain_toml(const Scene& scene);

// What is legal in a scene and yet hardly meant.

/// One sentence each: headings and other angles beyond one turn, which were most likely meant in degrees.
std::vector<std::string> advice(const Scene& scene);

} // namespace rodwake::scene
