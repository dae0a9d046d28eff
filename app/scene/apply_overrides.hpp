#pragma once
// Keys set from outside the scene's own tables: by -s, and by `set` of a variant.

#include "diagnostics.hpp"
#include "node.hpp"

#include <optional>
#include <string>
#include <vector>

namespace rodwake::scene {

/// One "table.key=value", read.
struct Override {
    std::string path; ///< "rods.1.position"
    Node value;
    SourcePosition place;
    bool unsets = false; ///< "table.key=": the key is taken out, and its value counts for nothing

    /// "coupling.kappa=-100.0"
    std::string text() const { return path + "=" + to_inline(value); }
};

/// Reads "table.key=value" or "table.key=" as given to -s; nothing, and a problem, if it has no such form.
std::optional<Override> parse_override(const std::string& text, Diagnostics& diagnostics);

/// Puts the value into the document, or takes the key out. Missing tables are made; list entries, and what is
/// to be taken out, must exist.
void apply_override(Node& root, const Override& item, Diagnostics& diagnostics);

/// The entries of a variant's `set` table as overrides. Tables inside it stand for dotted keys.
std::vector<Override> variant_overrides(const Node& set);

/// `set` as a TOML inline table; what variant_overrides would give back as `settings`.
std::string settings_text(const std::vector<std::string>& settings);

} // namespace rodwake::scene
