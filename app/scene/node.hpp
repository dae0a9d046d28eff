#pragma once
// A TOML document as a plain tree that remembers where each value stands.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace rodwake::scene {

/// Where a value came from: a place in a file, or a command-line override (line 0).
struct SourcePosition {
    std::shared_ptr<const std::string> source;
    long line = 0, column = 0;
    bool overriding = false; ///< set by -s or by a variant: wins over alternatives in the file
};

struct Entry;

struct Node {
    struct Date {};
    using List = std::vector<Node>;
    using Table = std::vector<Entry>;

    SourcePosition place;
    std::variant<bool, std::int64_t, double, std::string, Date, List, Table> value;

    template<class T>
    const T* as() const {
        return std::get_if<T>(&value);
    }
    template<class T>
    T* as() {
        return std::get_if<T>(&value);
    }

    /// Entry of a table by key; null if there is none or this is not a table.
    const Entry* find(std::string_view key) const;
    Entry* find(std::string_view key);
};

struct Entry {
    std::string key;
    SourcePosition key_place;
    Node value;
};

/// Shortest decimal text that reads back to the same double, always recognisable as a TOML float.
std::string number_text(double value);

/// TOML basic string with escapes.
std::string in_quotes(std::string_view text);

/// A bare key where TOML allows it, else quoted.
std::string key_text(const std::string& key);

/// The value as TOML on one line.
std::string to_inline(const Node& node);

/// For messages: `"abc" (string)`, `-2 (integer)`, "a table"; long values are shortened.
std::string describe(const Node& node);

/// The same without the type.
std::string describe_value(const Node& node);

/// Splits "rods.1.position" at the dots.
std::vector<std::string> split_path(const std::string& path);

/// Index for a path segment that is a plain non-negative number below 10^9, else -1.
long list_index(const std::string& segment);

/// Place of the node at `path` ("rods.1.position"), or of its nearest existing parent.
SourcePosition locate(const Node& root, const std::string& path);

} // namespace rodwake::scene
