#pragma once
// Values of a scene set without text, as scans and variants do: the keys are looked up once, and setting one
// takes less than a microsecond (bench/set_bench.cpp).
//
//     const ValueSetter kappa = compile_setter(scene, "coupling.kappa");
//     if (const auto wrong = kappa.set(scene, 0.5)) ...
//
// What is checked when:
//   compile_setter  the keys exist in this scene, hold one value each, and alternatives among them go
//   together
//                   (phi_b or beads, not both).
//   set             type, nan and inf, legal range, choices, and what follows within the table: xi from
//   alpha,
//                   atol from rtol, output times from t_end, the alternative that is dropped.
//   validate        whether tables and values fit each other: rods at one point, a contact distance that is
//                   not there at the start, a figure or a measure without what it shows. It looks at the
//                   whole scene; call it once all values are set.

#include "rodwake/scene/read.hpp"
#include "rodwake/scene/scan.hpp"
#include "rodwake/scene/scene.hpp"

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace rodwake::scene {

struct SetterTarget;

/// Sets the values of one key or of several at once. Threads may share it.
class ValueSetter {
public:
    /// Sets the keys in the order in which they were compiled. Numbers are as the scene holds them: reduced,
    /// in [granular] and [measure] SI, in [fit] in the profiles' unit. The scene has the tables and list
    /// entries of the one that the setter was compiled for. Nothing: done. Else what is wrong
    /// ("coupling.kappa = nan: must be a finite number"), and keys that are not at fault may have their new
    /// values; of a single key the scene is as it was.
    [[nodiscard]] std::optional<std::string> set(Scene& scene, std::span<const Value> values) const;
    /// The same for a setter of one key.
    [[nodiscard]] std::optional<std::string> set(Scene& scene, const Value& value) const;

    /// A value as a scene file has it, in the unit that plain numbers have there or a string such as "5 s",
    /// as `set` takes it. Throws InputError for a string that is no such quantity.
    Value held(const Value& written, std::size_t which = 0) const;

private:
    friend ValueSetter compile_setter(const Scene& scene, std::span<const std::string> keys);
    using Targets = std::shared_ptr<const std::vector<SetterTarget>>;
    explicit ValueSetter(Targets targets) : targets_(std::move(targets)) {}

    Targets targets_;
};

/// Looks up keys such as "coupling.kappa", "rods.1.position.0", "fit.start.eta". Throws InputError for one
/// that the scene has not, that is a table or a list, or that says what numbers mean (units, scales).
ValueSetter compile_setter(const Scene& scene, std::span<const std::string> keys);
ValueSetter compile_setter(const Scene& scene, std::string_view key);

/// What does not fit together in a scene whose values have been set; empty: nothing. As reading reports it,
/// without lines.
std::vector<Diagnostic> validate(const Scene& scene);

} // namespace rodwake::scene
