#pragma once
// What is wrong with a scene, collected while it is read, and the words for it.

#include "node.hpp"
#include "rodwake/core/spelling.hpp"
#include "rodwake/scene/problem.hpp"

#include <algorithm>
#include <span>
#include <string>
#include <string_view>

namespace rodwake::scene {

/// Collects problems while a scene is read; storage is capped so that a hopeless file costs little.
class Problems {
public:
    static constexpr std::size_t stored_at_most = 1000;

    void add(const Place& place, std::string key, std::string message);
    void add(Problem problem);
    bool empty() const { return list_.empty(); }
    const std::vector<Problem>& list() const { return list_; }

    /// Throws SceneError with all problems if there are any.
    void throw_if_any() const;

private:
    std::vector<Problem> list_;
    std::size_t unstored_ = 0;
};

using Names = std::span<const std::string_view>;

/// `must be one of x, y (did you mean "x"?)`
std::string one_of_text(Names legal, std::string_view found);

/// `[coupling] unknown key "kapa" (did you mean "kappa"?). Known keys: kappa, gamma1`; for the top level the
/// title is empty.
std::string unknown_key_text(const std::string& title, const std::string& name, Names known);

template<class Strings>
bool contains(const Strings& names, std::string_view name) {
    return std::ranges::find(names, name) != std::ranges::end(names);
}

/// "a, b, c"
template<class Strings>
std::string comma_list(const Strings& names) {
    std::string text;
    for (const std::string_view name : names)
        text.append(text.empty() ? "" : ", ").append(name);
    return text;
}

} // namespace rodwake::scene
