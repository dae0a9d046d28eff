#include "rodwake/core/build_info.hpp"

#include "build_config.hpp"

#include <Eigen/Core>
#include <boost/version.hpp>

#include <fstream>

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
             {"NLopt", RODWAKE_NLOPT_VERSION},
             {"Eigen", dotted(EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION)},
             {"Boost", dotted(BOOST_VERSION / 100000, BOOST_VERSION / 100 % 1000, BOOST_VERSION % 100)},
             {"HDF5", RODWAKE_HDF5_VERSION},
             {"toml++", RODWAKE_TOMLPLUSPLUS_VERSION},
             {"CLI11", RODWAKE_CLI11_VERSION},
             {"fmt", RODWAKE_FMT_VERSION},
             {"spdlog", RODWAKE_SPDLOG_VERSION},
             {"nlohmann-json", RODWAKE_JSON_VERSION},
             {"MPI", RODWAKE_MPI_VERSION}}};
}

std::string cpu_model() {
    std::ifstream info("/proc/cpuinfo");
    for (std::string line; std::getline(info, line);)
        if (line.starts_with("model name"))
            if (const auto colon = line.find(": "); colon != std::string::npos)
                return line.substr(colon + 2);
    return "unknown";
}

std::vector<std::string> cpu_features() {
    std::vector<std::string> features;
#if defined(__x86_64__) && defined(__GNUC__)
    __builtin_cpu_init();
    if (__builtin_cpu_supports("sse4.2"))
        features.emplace_back("sse4.2");
    if (__builtin_cpu_supports("avx"))
        features.emplace_back("avx");
    if (__builtin_cpu_supports("fma"))
        features.emplace_back("fma");
    if (__builtin_cpu_supports("avx2"))
        features.emplace_back("avx2");
    if (__builtin_cpu_supports("avx512f"))
        features.emplace_back("avx512f");
#endif
    return features;
}

} // namespace rodwake
