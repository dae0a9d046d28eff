#pragma once

#include <string>

namespace rodwake {

/// The first line in which two texts differ, as "duration = 30.0 there, duration = 20.0 here".
std::string first_difference(const std::string& there, const std::string& here);

} // namespace rodwake
