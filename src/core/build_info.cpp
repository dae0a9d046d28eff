#include "rodwake/core/build_info.hpp"

#include "build_config.hpp"

#include <Eigen/Core>
#include <boost/version.hpp>

namespace rodwake {

namespace {

std::string dotted(int a, int b, int c) {
    return std::to_string(a) + "." + std::to_string(b) + "." + std::to_string(c);
}

} // namespace

BuildInfo build_info() {
    return {RODWAKE_VERSION,
            RODWAKE_GIT,
            RODWAKE_COMPILER,
            RODWAKE_BUILD_FLAGS,
            {{"SUNDIALS", RODWAKE_SUNDIALS_VERSION},
             {"Eigen", dotted(EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION)},
             {"Boost", dotted(BOOST_VERSION / 100000, BOOST_VERSION / 100 % 1000, BOOST_VERSION % 100)},
             {"HDF5", RODWAKE_HDF5_VERSION},
             {"toml++", RODWAKE_TOMLPLUSPLUS_VERSION},
             {"CLI11", RODWAKE_CLI11_VERSION},
             {"fmt", RODWAKE_FMT_VERSION},
             {"spdlog", RODWAKE_SPDLOG_VERSION},
             {"nlohmann-json", RODWAKE_JSON_VERSION}}};
}

} // namespace rodwake
