#pragma once
// How a type of value stands in a scene: each has one codec, from which it is read, written, documented and
// set. The visitors know of no type; a new one takes a codec.

#include "key.hpp"
#include "node.hpp"
#include "rodwake/core/periodic.hpp"
#include "rodwake/scene/scene.hpp"

#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace rodwake::scene {

/// What begins at a time, or when something has come so far, whichever is given; in the scene's written form
/// each has a key of its own.
struct TimeOrTravel {
    double& time;
    std::optional<double>& travel;
    Range travel_range;
};

/// A table of "path.to.key" = value, held as "path.to.key=value".
struct Settings {
    std::vector<std::string>& list;
};

/// One name or index of "rods.1.position.0".
struct PathSegment {
    std::string name;
    long index = -1; ///< of an entry of a list; -1: a name
};

/// As in messages: "rods[1].position".
std::string path_text(std::span<const PathSegment> path);

/// Receives the diagnostics of values.
class Faults {
public:
    virtual ~Faults() = default;
    /// `below` leads from the key to what is wrong ("[1]", ".eta"); the message goes on after the path (":
    /// expected...").
    virtual void add(const SourcePosition& position, const std::string& below,
                     const std::string& message) = 0;
    /// As `add`, of a physical unit in a scene without [scales].
    virtual void add_missing_scales(const SourcePosition& place, const std::string& below,
                                    const std::string& message) {
        add(place, below, message);
    }
};

/// The node that a value is read from, and the receiver of its diagnostics.
struct Input {
    const Key& key;
    const Node& node;
    const Units* units; ///< null: numbers are as the scene holds them, and no words for them
    Faults& faults;
    std::string below{}; ///< from the key to this node

    Input at(const Node& item, const std::string& name) const {
        return {key, item, units, faults, below + name};
    }
    Input with(const Key& other) const { return {other, node, units, faults, below}; }
    /// " = value: message". Always false, so that a reader can return it.
    bool wrong(const std::string& message) const;
    /// ": expected, found value (type): why"
    bool wrong_type(const std::string& expected, const std::string& why = "") const;
};

/// What the reference says of a key's value.
struct Description {
    std::string type, fallback, legal; ///< `fallback` is empty for a key without default
    bool has_range = false;            ///< `legal` is that of the key's range
    std::vector<std::string> choices{};
};

class Codec {
public:
    virtual ~Codec() = default;

    /// What the absence of its key leaves in a scene that is read; most values stay as they are.
    virtual void clear(void* value) const = 0;
    virtual bool is_present(const void* value) const = 0;
    /// Whether the value is legal. If not, a diagnostic was added, and a single value is unchanged.
    virtual bool parse(const Input& input, void* value) const = 0;
    /// TOML; empty: there is nothing to write.
    virtual std::string print(const Key& key, const void* value, const Units& units) const = 0;
    virtual Description describe(const Key& key, const void* value) const = 0;

    // Of values that are set without text.

    /// Numbers in the scene's units.
    virtual bool is_quantity() const = 0;
    /// Segments below the key that lead to a single value; -1: none can be set.
    virtual int depth() const = 0;
    /// What is wrong with the last `depth()` segments of this path; empty: nothing.
    virtual std::string misses(const Key& key, const void* value,
                               std::span<const PathSegment> path) const = 0;
    /// As `parse`, of the value that the path leads to.
    virtual bool set(const Input& input, void* value, std::span<const PathSegment> path) const = 0;
};

/// Of a type that a scene may hold: those instantiated at the ends of codecs.cpp and codec_lists.cpp.
template<class T>
const Codec& codec_of();

} // namespace rodwake::scene
