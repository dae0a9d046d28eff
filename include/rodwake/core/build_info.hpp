#pragma once
// What this program is and what it was built with, for provenance records and `rodwake info`.

#include <string>
#include <utility>
#include <vector>

namespace rodwake {

struct BuildInfo {
    std::string version;  ///< of rodwake, "major.minor.patch"
    std::string git;      ///< commit the tree was built from, with "-dirty" if changed; "unknown" outside git
    std::string compiler; ///< name and version
    std::string flags;    ///< build type and its flags
    std::vector<std::pair<std::string, std::string>> libraries; ///< name, version
};

BuildInfo build_info();

/// CPU model name and the vector extensions it offers, "unknown" where the system does not tell.
std::string cpu_model();
std::vector<std::string> cpu_features();

} // namespace rodwake
