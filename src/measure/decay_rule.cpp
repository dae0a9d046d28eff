#include "decay_rule.hpp"

#include <fmt/format.h>

namespace rodwake::measure {

namespace {

constexpr double hexatic_bound = 0.25;   // eta_6 where the hexatic melts (KTHNY)
constexpr double least_exponent = 0.003; // what a crystal's shells and phonons leave at these distances
constexpr double clear_chi2 = 4.0;       // decides between two models of as many parameters
constexpr double by_chance = 0.01;

} // namespace

void decide(DecayClass& c, double zero_chance, double farthest) {
    const double eta = c.exponent.value, error = c.exponent.error;
    const bool flat = eta < least_exponent || eta < 2.0 * error;
    const std::string shown = fmt::format("eta_6 = {:.4f} +- {:.4f}", eta, error);
    if (zero_chance > by_chance) {
        c.decay = Decay::exponential;
        c.reason = fmt::format("no order is left at these distances: g_B = 0 within errors (P = {:.2g})",
                               zero_chance);
    } else if (!c.exponent.known()) {
        c.reason = "eta_6 is not known: chi2 does not tell how well";
    } else if (eta - error > hexatic_bound) {
        c.decay = Decay::exponential;
        c.reason = shown + " is above 1/4, where a hexatic melts (KTHNY)";
    } else if (flat && eta + 2.0 * error < hexatic_bound) {
        c.decay = Decay::long_range;
        c.reason = fmt::format("{}: {}, so g_B stays at {:.4f}", shown,
                               eta < least_exponent ? "below 0.003" : "0 within 2 errors", c.plateau.value);
    } else if (flat) {
        c.reason = shown + ": neither 0 nor 1/4 can be excluded; more frames or a longer run would tell";
    } else if (c.chi2_algebraic - c.chi2_exponential > clear_chi2 && c.length.known() &&
               c.length.value < farthest) {
        c.decay = Decay::exponential;
        c.reason = fmt::format("the exponential fits better (chi2 {:.3g} against {:.3g})", c.chi2_exponential,
                               c.chi2_algebraic);
    } else {
        c.decay = Decay::algebraic;
        c.reason = shown + ": above 0 and not above 1/4 within its error";
    }
}

const char* to_string(Decay decay) {
    switch (decay) {
    case Decay::exponential:
        return "exponential";
    case Decay::algebraic:
        return "algebraic";
    case Decay::long_range:
        return "long-range";
    case Decay::undetermined:
        break;
    }
    return "undetermined";
}

const char* phase_of(Decay decay) {
    switch (decay) {
    case Decay::exponential:
        return "liquid";
    case Decay::algebraic:
        return "hexatic";
    case Decay::long_range:
        return "crystal";
    case Decay::undetermined:
        break;
    }
    return "undetermined";
}

} // namespace rodwake::measure
