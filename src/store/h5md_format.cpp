#include "h5md_format.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <string_view>

namespace rodwake::store {

namespace {

/// "mm" of the base "m".
std::optional<double> prefixed(std::string_view text, std::string_view base) {
    static const std::map<std::string_view, double> prefixes = {
        {"", 1.0},   {"k", 1e3},  {"c", 1e-2}, {"m", 1e-3},  {"u", 1e-6},
        {"µ", 1e-6}, {"μ", 1e-6}, {"n", 1e-9}, {"p", 1e-12}, {"f", 1e-15}};
    if (text == "Angstrom" && base == "m")
        return 1e-10;
    const auto at = text.ends_with(base) ? prefixes.find(text.substr(0, text.size() - 1)) : prefixes.end();
    return at == prefixes.end() ? std::nullopt : std::optional(at->second);
}

std::optional<double> factor(std::string_view text, H5mdUnit kind) {
    if (kind == H5mdUnit::mass) {
        const auto grams = prefixed(text, "g");
        return text == "kg" ? 1.0 : grams ? std::optional(1e-3 * *grams) : std::nullopt;
    }
    if (kind != H5mdUnit::speed)
        return prefixed(text, kind == H5mdUnit::time ? "s" : "m");
    // "mm/s", or "mm s-1" as H5MD has it.
    const auto gap = std::min(text.find_first_of("/ "), text.size());
    std::string_view time = text.substr(gap);
    if (!time.starts_with('/') && !(time.starts_with(' ') && time.ends_with("-1")))
        return std::nullopt;
    time = time.substr(1, time.size() - (time.starts_with('/') ? 1 : 3));
    const auto up = prefixed(text.substr(0, gap), "m"), down = prefixed(time, "s");
    return up && down ? std::optional(*up / *down) : std::nullopt;
}

} // namespace

double si_factor(const Hdf5Input& file, const std::string& path, H5mdUnit kind) {
    constexpr const char* known[] = {"m, mm, um, nm, Angstrom", "s, ms, us, ns, ps", "kg, g, mg",
                                     "m/s, mm s-1"};
    for (const std::string& owner : {path, path.substr(0, path.rfind("/value"))}) {
        if (!file.has(owner) || H5Aexists_by_name(file.get(), owner.c_str(), "unit", H5P_DEFAULT) <= 0)
            continue;
        const std::string unit = text_attribute(file, owner, "unit").front();
        if (const auto value = factor(unit, kind))
            return *value;
        file.refuse(fmt::format("{} is in the unit \"{}\", which is not known; known are {} and the like",
                                path, unit, known[static_cast<int>(kind)]));
    }
    return 1.0;
}

} // namespace rodwake::store
