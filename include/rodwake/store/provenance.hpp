#pragma once
// Who made a result, and how to make it again.

#include <cstdint>
#include <map>
#include <string>

namespace rodwake::store {

struct Provenance {
    std::string command; ///< as a shell takes it
    std::string scene;   ///< file the scene came from
    std::string status;  ///< "unfinished" | "finished" | "interrupted" | "failed"
    std::uint64_t seed = 0;
    double wall_seconds = 0.0;
    std::map<std::string, std::string> stages = {}; ///< status of each
};

/// JSON with the above, rodwake's version and git id, library versions, compiler, CPU, date (UTC).
std::string provenance_json(const Provenance& provenance);

} // namespace rodwake::store
