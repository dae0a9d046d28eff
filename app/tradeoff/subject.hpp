#pragma once
// The work that is solved by each setting: the rods of a scene once, or a sample of its scan.

#include "answer.hpp"
#include "run/session.hpp"

#include <functional>

namespace rodwake::app {

struct Subject {
    std::string unit;
    std::vector<Setting> settings;
    std::array<integrate::Method, 2> reference; ///< methods that suit the work
    /// Sets the work up; what it returns does it, again and again, until `stop`. Both throw InputError for
    /// what the setting cannot do.
    using Work = std::function<Answer()>;
    std::function<Work(const Setting&, std::function<bool()> stop)> prepare;
};

/// Of the scene as written, without its variants. The session must outlive it.
Subject subject_of_rods(const Session& session);
/// A thousand points at random between the ends of the axes; of a list its rows, a thousand at most.
Subject subject_of_scan(const Session& session);

} // namespace rodwake::app
