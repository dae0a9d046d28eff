#include "rodwake/core/build_info.hpp"

#include <fstream>

namespace rodwake {

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
