#pragma once
// Values with units: numbers in the scene's unit system, or strings such as "0.4 mm". All become reduced
// here.

#include "rodwake/scene/scene.hpp"

#include <optional>
#include <string>
#include <string_view>

namespace rodwake::scene {

/// Density and acceleration have no reduced unit: they are SI in every scene.
enum class Dimension { none, length, time, speed, rate, angle, density, acceleration, diffusion, wavenumber };

/// How numbers and unit words of a scene are to be understood.
struct Units {
    UnitSystem system = UnitSystem::reduced;
    std::optional<Scales> scales;
    bool reduced_words =
        true; ///< "f/mu", "v0" may be used; not in [scales], which defines them, nor in [granular]
    bool bead_words = true;  ///< "a", "a/s" may be used; not by the key that says what "a" is
    std::string_view own{};  ///< in words, a unit of length that data files have; empty: none such
    std::string_view word{}; ///< its name: lengths in it stay as they are

    bool is_own() const { return !own.empty(); }
};

/// "a length"
std::string name_of(Dimension dimension);
/// "f/mu", SI unit "m": what a plain number means.
std::string reduced_unit(Dimension dimension);
std::string si_unit(Dimension dimension);

/// SI in every scene, one metre being 1: for the tables that have their own scale. "a" is `bead_radius`.
inline Units si_units(double bead_radius) {
    return {UnitSystem::si, Scales{1.0, 1.0, bead_radius}, false, true, ""};
}

/// What a unit of length is worth; nothing for a word that is none, or none of a known size.
std::optional<double> metres(std::string_view word, double bead_radius);

/// Plain lengths are in the unit of measured files, `word`; strings with a unit become that, or are refused
/// if nothing is known of it.
inline Units file_units(double bead_radius, std::string_view word) {
    return {UnitSystem::reduced,
            Scales{metres(word, bead_radius).value_or(1.0), 1.0, bead_radius},
            false,
            true,
            "of the profiles",
            word};
}

/// A value read from a string: reduced, or the reason why it could not be.
struct Quantity {
    std::optional<double> value;
    bool needs_scales = false; ///< the unit is physical and there is no [scales]
    std::string why;           ///< "unknown unit \"parsec\"..."
};

/// Reads "78 a", "2.8 mm/s", "30 deg", "2.2 f/mu".
Quantity parse_quantity(const std::string& text, Dimension dimension, const Units& units);

/// A plain number of the scene's unit system, reduced.
double to_reduced(double value, Dimension dimension, const Units& units);

/// TOML for a reduced value in the scene's unit system; reading it gives the same double.
std::string quantity_text(double reduced, Dimension dimension, const Units& units);

} // namespace rodwake::scene
