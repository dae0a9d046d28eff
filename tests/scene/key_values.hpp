#pragma once
// Values of a key made from its description alone: what must be refused, with what the message must say, and
// what must not be.

#include "support.hpp"

namespace scene_test {

struct Refused {
    std::string value;  ///< TOML
    std::string said;   ///< by the message
    std::string item{}; ///< which part of the value is wrong: "[0]", ".eta"; empty: the value
    std::size_t at = 0; ///< where that part begins in `value`
};

/// Of another type than the key's.
std::vector<Refused> wrong_types(const KeyInfo& info);

/// Of the right type, but outside the range, no choice, not a finite number, too few or too many.
/// A boolean has none: what is neither true nor false stands for it.
std::vector<Refused> refused_values(const KeyInfo& info);

/// The bounds where they are legal, every choice, true and false.
std::vector<std::string> accepted_values(const KeyInfo& info);

/// The complete scene with this value in place of the key's own, and where the value is.
struct Placed {
    std::string text;
    std::size_t line = 0, column = 0;
};
Placed placed(const KeyInfo& info, const std::string& value);

/// Whether the message has the text and no more of it: a part of a list or of a number is not enough.
bool has_whole(const std::string& message, const std::string& said);

/// Whether the value is refused with its file, line and column, the key and what must be said.
bool is_refused(const KeyInfo& info, const Refused& refused);

/// Whether the problem is one of those that the key's description tells.
bool is_reported(const KeyInfo& info, const Diagnostic& problem);

} // namespace scene_test
