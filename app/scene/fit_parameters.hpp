#pragma once
// The parameters that [fit] knows, by name; what [fit] says of one is in rodwake/scene/fit.hpp.

#include <string>
#include <vector>

namespace rodwake::scene {

struct FitParameter {
    std::string name, symbol, meaning; ///< symbol: TeX without dollars
};

const std::vector<FitParameter>& fit_parameter_list();

} // namespace rodwake::scene
