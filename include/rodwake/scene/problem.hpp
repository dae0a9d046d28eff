#pragma once
// What is wrong with a scene: every problem of a file is collected and reported at once.

#include "rodwake/core/error.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace rodwake::scene {

struct Problem {
    std::string file; ///< path of the scene, or "-s table.key=value" for a command-line override
    long line = 0;    ///< from 1; 0: the problem is not at one place (override, unreadable file)
    long column = 0;  ///< from 1, in characters
    std::string key;  ///< "rods[1].position"; empty: the file as a whole
    std::string message;

    /// "file:line:column: message", the form that editors and terminals jump to.
    std::string text() const;
    bool operator==(const Problem&) const = default;
};

/// The scene cannot be used. what() lists the problems, one a line in order of place, at most
/// `listed_at_most`.
class SceneError : public InputError {
public:
    static constexpr std::size_t listed_at_most = 50;

    /// `unstored` problems were found beyond those given; they are counted in the text.
    explicit SceneError(std::vector<Problem> problems, std::size_t unstored = 0);
    const std::vector<Problem>& problems() const { return problems_; }

private:
    std::vector<Problem> problems_;
};

} // namespace rodwake::scene
