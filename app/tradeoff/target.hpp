#pragma once
// What is traded: a part of a scene says which ways there are, how one is tried, and how errors follow from
// results that are described (core/record.hpp).

#include "rodwake/app/run_context.hpp"
#include "rodwake/app/tradeoff.hpp"
#include "rodwake/core/encounter.hpp"
#include "rodwake/scene/scene.hpp"

#include <functional>
#include <memory>
#include <span>

namespace rodwake::app {

class Session;

inline constexpr const char* took_too_long = "took too long";

class Target {
public:
    virtual ~Target() = default;

    /// Makes the reference, where the ways have none among them. False if it was stopped.
    virtual bool begin() { return true; }
    /// Fills in what way k finds, given those before it. False if it was stopped. Throws InputError or
    /// RunError for a way that cannot be gone.
    virtual bool attempt(std::size_t k) = 0;
    /// A second look, when all have had their turn.
    virtual void again(Way& /*way*/) {}

    Tradeoff table; ///< at first with the keys of the ways alone
};

using MakeTarget = std::unique_ptr<Target>(const scene::Scene& scene, const std::filesystem::path& results,
                                           const RunContext& context);
// All without the variants of the scene; scene and context must outlive them.
/// Time step, duration, and how often it is measured; the reference is the first way, of the shortest step.
MakeTarget bed_target;
/// Search, polish, number of starts, and intervals from the curvature or the likelihood. The data may be in
/// `results`.
MakeTarget fit_target;
/// The exact field and tables of it, at the points of [field].
MakeTarget field_target;
/// Method, form, field, precision, tolerance; the reference is one on which two independent methods agree.
std::unique_ptr<Target> rods_target(const Session& session);

/// A run of rods, reduced units.
struct Encounter {
    bool solved = false; ///< if not, the rest means nothing
    Ending ending = Ending::undecided;
    double contact_time = 0.0;             ///< NaN: no contact
    std::vector<double> final_state;       ///< of rods.csv; of a scan: separation and turns
    std::vector<std::vector<double>> path; ///< at the output times up to the end; of a scan: none
};

/// Of each run against the other with its number; of many what 95 % keep to.
RodErrors errors_between(const std::vector<Encounter>& runs, const std::vector<Encounter>& others);

/// The one of this name; NaN for a name that is none of them.
inline double error_of(const RodErrors& errors, const std::string& kind) {
    double error = NAN;
    for_each_field<RodErrors>([&](const auto& field) {
        if (field.name == kind)
            error = errors.*field.member;
    });
    return error;
}

/// A quantity that is an error itself.
inline Found error_found(std::string_view name, std::string_view unit, double error) {
    return {.name = std::string(name), .unit = std::string(unit), .value = error, .bias = error};
}

/// A described result for each number of which there is an error.
template<Described Errors>
std::vector<Found> found_of(const Errors& errors) {
    std::vector<Found> found;
    for_each_field<Errors>([&](const auto& field) {
        found.push_back(error_found(field.name, field.info.unit, errors.*field.member));
    });
    return found;
}

// tradeoff.json and ways.json, to go on from; tradeoff.csv, with a row a way, and ways.csv, with a row a way
// and quantity, to read.
std::string tradeoff_json(const Tradeoff& table);
std::string tradeoff_csv(const Tradeoff& table);
std::span<const ColumnInfo> tradeoff_columns();
std::string ways_json(const Tradeoff& table, const std::string& command);
std::string ways_csv(const Tradeoff& table);
std::span<const ColumnInfo> ways_columns();

} // namespace rodwake::app
