#include "units.hpp"

#include "node.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

namespace rodwake::scene {

namespace {

enum class UnitKind { physical, beads, reduced };

/// One word is worth numerator/denominator SI units; two numbers, so that "0.4 mm" is 0.4/1000 correctly
/// rounded.
struct UnitWord {
    const char* word;
    Dimension dimension;
    double numerator = 1.0, denominator = 1.0;
    UnitKind kind = UnitKind::physical;
};

constexpr std::array words{
    UnitWord{"m", Dimension::length},
    UnitWord{"cm", Dimension::length, 1.0, 1e2},
    UnitWord{"mm", Dimension::length, 1.0, 1e3},
    UnitWord{"um", Dimension::length, 1.0, 1e6},
    UnitWord{"a", Dimension::length, 1.0, 1.0, UnitKind::beads},
    UnitWord{"f/mu", Dimension::length, 1.0, 1.0, UnitKind::reduced},
    UnitWord{"s", Dimension::time},
    UnitWord{"ms", Dimension::time, 1.0, 1e3},
    UnitWord{"us", Dimension::time, 1.0, 1e6},
    UnitWord{"min", Dimension::time, 60.0},
    UnitWord{"f/(mu v0)", Dimension::time, 1.0, 1.0, UnitKind::reduced},
    UnitWord{"m/s", Dimension::speed},
    UnitWord{"cm/s", Dimension::speed, 1.0, 1e2},
    UnitWord{"mm/s", Dimension::speed, 1.0, 1e3},
    UnitWord{"um/s", Dimension::speed, 1.0, 1e6},
    UnitWord{"a/s", Dimension::speed, 1.0, 1.0, UnitKind::beads},
    UnitWord{"v0", Dimension::speed, 1.0, 1.0, UnitKind::reduced},
    UnitWord{"1/s", Dimension::rate},
    UnitWord{"1/ms", Dimension::rate, 1e3},
    UnitWord{"1/min", Dimension::rate, 1.0, 60.0},
    UnitWord{"Hz", Dimension::rate},
    UnitWord{"kHz", Dimension::rate, 1e3},
    UnitWord{"mu v0/f", Dimension::rate, 1.0, 1.0, UnitKind::reduced},
    UnitWord{"rad", Dimension::angle, 1.0, 1.0, UnitKind::reduced},
    UnitWord{"deg", Dimension::angle, std::numbers::pi, 180.0, UnitKind::reduced},
    UnitWord{"kg/m^3", Dimension::density},
    UnitWord{"g/cm^3", Dimension::density, 1e3},
    UnitWord{"m/s^2", Dimension::acceleration},
    UnitWord{"mm/s^2", Dimension::acceleration, 1.0, 1e3},
    UnitWord{"m^2/s", Dimension::diffusion},
    UnitWord{"mm^2/s", Dimension::diffusion, 1.0, 1e6},
    UnitWord{"um^2/s", Dimension::diffusion, 1.0, 1e12},
    UnitWord{"f v0/mu", Dimension::diffusion, 1.0, 1.0, UnitKind::reduced},
    UnitWord{"1/m", Dimension::wavenumber},
    UnitWord{"1/mm", Dimension::wavenumber, 1e3},
    UnitWord{"mu/f", Dimension::wavenumber, 1.0, 1.0, UnitKind::reduced},
};

bool usable(const UnitWord& unit, const Units& units) {
    if (unit.kind == UnitKind::beads)
        return units.bead_words;
    return units.reduced_words || unit.kind != UnitKind::reduced || unit.dimension == Dimension::angle;
}

double si_to_reduced(double value, Dimension dimension, const Scales& scales) {
    switch (dimension) {
    case Dimension::length:
        return value / scales.f_over_mu;
    case Dimension::time:
        return value / (scales.f_over_mu / scales.v0);
    case Dimension::speed:
        return value / scales.v0;
    case Dimension::rate:
        return value * (scales.f_over_mu / scales.v0);
    case Dimension::diffusion:
        return value / (scales.f_over_mu * scales.v0);
    case Dimension::wavenumber:
        return value * scales.f_over_mu;
    case Dimension::none:
    case Dimension::angle:
    case Dimension::density:
    case Dimension::acceleration:
        break;
    }
    return value;
}

double reduced_to_si(double value, Dimension dimension, const Scales& scales) {
    switch (dimension) {
    case Dimension::length:
        return value * scales.f_over_mu;
    case Dimension::time:
        return value * (scales.f_over_mu / scales.v0);
    case Dimension::speed:
        return value * scales.v0;
    case Dimension::rate:
        return value / (scales.f_over_mu / scales.v0);
    case Dimension::diffusion:
        return value * (scales.f_over_mu * scales.v0);
    case Dimension::wavenumber:
        return value / scales.f_over_mu;
    case Dimension::none:
    case Dimension::angle:
    case Dimension::density:
    case Dimension::acceleration:
        break;
    }
    return value;
}

Quantity failure(std::string why) { return {std::nullopt, false, std::move(why)}; }

} // namespace

std::string name_of(Dimension dimension) {
    static constexpr const char* names[] = {"a number",    "a length",        "a time",
                                            "a speed",     "a rate",          "an angle",
                                            "a density",   "an acceleration", "a diffusion coefficient",
                                            "a wavenumber"};
    return names[static_cast<std::size_t>(dimension)];
}

std::string reduced_unit(Dimension dimension) {
    static constexpr const char* names[] = {"",    "f/mu",   "f/(mu v0)", "v0",      "mu v0/f",
                                            "rad", "kg/m^3", "m/s^2",     "f v0/mu", "mu/f"};
    return names[static_cast<std::size_t>(dimension)];
}

std::string si_unit(Dimension dimension) {
    static constexpr const char* names[] = {"",    "m",      "s",     "m/s",   "1/s",
                                            "rad", "kg/m^3", "m/s^2", "m^2/s", "1/m"};
    return names[static_cast<std::size_t>(dimension)];
}

Quantity parse_quantity(const std::string& text, Dimension dimension, const Units& units) {
    std::string known;
    for (const auto& unit : words)
        if (unit.dimension == dimension && usable(unit, units))
            known += (known.empty() ? "" : ", ") + std::string(unit.word);
    // "12.5 mm" is split into 12.5 and "mm".
    double number = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc{} || !std::isfinite(number))
        return failure("a string must be a finite number and a unit: " + known);
    std::string word(end, text.data() + text.size());
    word.erase(0, word.find_first_not_of(' '));
    word.erase(word.find_last_not_of(' ') + 1);
    if (word.empty())
        return failure("a string needs a unit: " + known);
    const bool of_data = units.is_own() && dimension == Dimension::length;
    if (of_data && word == units.word)
        return {number, false, ""};
    const auto* const unit = std::ranges::find_if(
        words, [&](const UnitWord& one) { return word == one.word && usable(one, units); });
    if (unit == words.end())
        return failure(fmt::format("unknown unit {}; known: {}", in_quotes(word), known));
    if (unit->dimension != dimension)
        return failure(fmt::format("{} is {}; known: {}", in_quotes(word), name_of(unit->dimension), known));
    double value = number * unit->numerator / unit->denominator;
    if (unit->kind == UnitKind::reduced)
        return {value, false, ""};
    if (of_data && !metres(units.word, units.scales->bead_radius))
        return failure(
            fmt::format("cannot convert to \"{0}\": fit.length_unit = \"{0}\" is not a unit rodwake knows. "
                        "Write the value as a plain number in {0}",
                        units.word));
    if (!units.scales)
        return {std::nullopt, true, ""};
    if (unit->kind == UnitKind::beads)
        value *= units.scales->bead_radius;
    return {si_to_reduced(value, dimension, *units.scales), false, ""};
}

std::optional<double> metres(std::string_view word, double bead_radius) {
    for (const auto& unit : words)
        if (word == unit.word && unit.dimension == Dimension::length && unit.kind != UnitKind::reduced)
            return unit.kind == UnitKind::beads ? bead_radius : unit.numerator / unit.denominator;
    return std::nullopt;
}

double to_reduced(double value, Dimension dimension, const Units& units) {
    return units.system == UnitSystem::si && units.scales ? si_to_reduced(value, dimension, *units.scales)
                                                          : value;
}

std::string quantity_text(double reduced, Dimension dimension, const Units& units) {
    if (units.system == UnitSystem::reduced || !units.scales || dimension == Dimension::none ||
        dimension == Dimension::angle)
        return number_text(reduced);
    // Multiplying and dividing by a scale may end one unit in the last place away: try the neighbours.
    const double middle = reduced_to_si(reduced, dimension, *units.scales);
    for (const double si : {middle, std::nextafter(middle, -HUGE_VAL), std::nextafter(middle, HUGE_VAL)})
        if (si_to_reduced(si, dimension, *units.scales) == reduced)
            return number_text(si);
    return in_quotes(fmt::format("{} {}", reduced, reduced_unit(dimension)));
}

} // namespace rodwake::scene
