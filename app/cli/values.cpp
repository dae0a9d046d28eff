#include "definition.hpp"

#include "rodwake/core/spelling.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <utility>

namespace rodwake::cli {

namespace {

/// Empty if the whole word is a number, which is stored; else what is wrong with it.
template<class Number>
std::string read(const std::string& word, const char* what, Number& number) {
    const char* const end = word.data() + word.size();
    const auto [at, error] = std::from_chars(word.data(), end, number);
    if (at != end || error == std::errc::invalid_argument)
        return fmt::format("{} is not {}", word.empty() ? "an empty word" : word, what);
    if (error == std::errc{})
        return "";
    return std::isinf(std::strtod(word.c_str(), nullptr))
               ? word + " is too large for a number, which ends at 1.8e308"
               : word + " is too close to 0; write 0";
}

} // namespace

CLI::Validator number_from(double low, double high) {
    const auto check = [low, high](const std::string& word) -> std::string {
        double number = 0.0;
        std::string wrong = read(word, "a number", number);
        if (!wrong.empty())
            return wrong;
        if (number >= low && number <= high) // not so nan
            return "";
        return high == std::numeric_limits<double>::max()
                   ? fmt::format("{} is not a number >= {:g}", word, low)
                   : fmt::format("{} is not from {:g} to {:g}", word, low, high);
    };
    return {check, "", "number"};
}

CLI::Validator whole_number_from(std::uint64_t low, std::uint64_t high) {
    const auto check = [low, high](const std::string& word) -> std::string {
        std::uint64_t number = 0;
        const bool is_read = read(word, "", number).empty();
        return is_read && number >= low && number <= high
                   ? ""
                   : fmt::format("{} is not a whole number from {} to {}", word, low, high);
    };
    return {check, "", "whole number"};
}

CLI::Validator one_of(const std::vector<std::string>& legal) {
    const auto check = [legal](const std::string& word) -> std::string {
        if (std::ranges::find(legal, word) != legal.end())
            return "";
        const std::vector<std::string_view> names(legal.begin(), legal.end());
        return fmt::format("{} is none of {}{}", word, fmt::join(legal, ", "), did_you_mean(word, names));
    };
    return {check, fmt::format("{{{}}}", fmt::join(legal, ",")), "choice"};
}

CLI::Validator seconds() {
    const auto convert = [](std::string& word) -> std::string {
        static constexpr std::pair<std::string_view, double> units[] = {
            {"", 1.0}, {"us", 1e-6}, {"ms", 1e-3}, {"s", 1.0}, {"min", 60.0}, {"h", 3600.0}};
        double number = 0.0;
        const auto [at, error] = std::from_chars(word.data(), word.data() + word.size(), number);
        const std::string_view rest(at, static_cast<std::size_t>(word.data() + word.size() - at));
        const auto unit =
            std::ranges::find(units, rest.substr(std::min(rest.find_first_not_of(' '), rest.size())),
                              &std::pair<std::string_view, double>::first);
        if (error != std::errc{} || !std::isfinite(number) || number <= 0.0 || unit == std::end(units))
            return word + " is not a time such as 5ms, 2s or 1min";
        word = fmt::format("{}", number * unit->second);
        return "";
    };
    return {convert, "TIME", "time"};
}

} // namespace rodwake::cli
