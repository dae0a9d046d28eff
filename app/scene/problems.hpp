#pragma once

#include "node.hpp"
#include "rodwake/scene/problem.hpp"

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

} // namespace rodwake::scene
