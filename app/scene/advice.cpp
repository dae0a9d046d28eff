#include "rodwake/scene/read.hpp"

#include "rodwake/scene/document.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace rodwake::scene {

namespace {

constexpr double turn = 2.0 * std::numbers::pi;

class Advice {
public:
    void angle(const std::string& key, double radians) {
        if (std::abs(radians) > turn)
            list.push_back(
                fmt::format("{0} = {1:.6g} rad is {2:.3g} turns; a plain number is in rad, degrees are "
                            "written as \"90 deg\"",
                            key, radians, radians / turn));
    }

    /// The ends and the values of an axis, which are as a scene file has them.
    void axis(std::size_t index, const ScanAxis& axis) {
        const auto info = key_info(axis.name());
        if (!info || info->unit_reduced != "rad")
            return;
        const std::string key = fmt::format("scan.axes[{}]", index);
        value(key + ".from", axis.from);
        value(key + ".to", axis.to);
        for (std::size_t i = 0; i < axis.values.size(); ++i)
            value(fmt::format("{}.values[{}]", key, i), axis.values[i]);
    }

    /// Beads and rods that the gap between shaken plates stops are named (findings.md, section 13): beads
    /// revive from 2.5 radii on; a rod walks at a tenth of its speed where its thick end fills 0.7 of the
    /// gap, at a third for 0.84. From four radii on small beads stack, which a gap for large ones may allow.
    void gap(const Granular& bed) {
        constexpr double dead = 2.5, thin = 0.8, stacked = 4.0;
        const granular::BeadMix mix = bead_mix(bed);
        const double width = bed.plates.gap, largest = mix.largest(),
                     smallest = granular::BeadMix{mix.radius, mix.kinds}.smallest(); // a spread aside
        if (bed.plates.gamma == 0.0)
            return;
        if (width < dead * largest)
            list.push_back(
                fmt::format("granular.plates.gap = {:g} m is {:.2f} radii of the largest beads ({:g} m), "
                            "which hardly move below {:g}; 2.7 to 2.8 keep them moving",
                            width, width / largest, largest, dead));
        if (!mix.equal() && width > stacked * smallest)
            list.push_back(fmt::format("granular.plates.gap = {:g} m is {:.2f} radii of the smallest beads "
                                       "({:g} m), which stack from {:g} on: this bed is not one layer",
                                       width, width / smallest, smallest, stacked));
        for (std::size_t i = 0; i < bed.rods.size(); ++i) {
            const granular::RodShape& shape = bed.rods[i].shape;
            if (shape.kind == granular::RodKind::motile && !bed.rods[i].imposed_speed &&
                shape.thick_diameter < thin * width)
                list.push_back(fmt::format(
                    "granular.rods[{}].thick_diameter = {:g} m is {:.2f} of "
                    "granular.plates.gap = {:g} m; a rod hardly walks below {:g} of it, "
                    "so try {:.2g} m",
                    i, shape.thick_diameter, shape.thick_diameter / width, width, thin, 0.9 * width));
        }
    }

    std::vector<std::string> list;

private:
    void value(const std::string& key, const std::optional<Value>& written) {
        if (!written)
            return;
        if (const auto* real = std::get_if<double>(&*written))
            angle(key, *real);
        else if (const auto* whole = std::get_if<std::int64_t>(&*written))
            angle(key, static_cast<double>(*whole));
    }
};

} // namespace

std::vector<std::string> advice(const Scene& scene) {
    Advice advice;
    if (scene.rods_random)
        advice.angle("rods_random.heading", scene.rods_random->heading);
    else
        for (std::size_t i = 0; i < scene.rods.size(); ++i)
            advice.angle(fmt::format("rods[{}].heading", i), scene.rods[i].heading);
    if (scene.granular) {
        advice.gap(*scene.granular);
        advice.angle("granular.orientation", scene.granular->orientation);
        for (std::size_t i = 0; i < scene.granular->rods.size(); ++i)
            advice.angle(fmt::format("granular.rods[{}].heading", i), scene.granular->rods[i].heading);
    }
    if (scene.fit)
        advice.angle("fit.heading", scene.fit->heading);
    if (scene.scan)
        for (std::size_t i = 0; i < scene.scan->axes.size(); ++i)
            advice.axis(i, scene.scan->axes[i]);
    return advice.list;
}

} // namespace rodwake::scene
