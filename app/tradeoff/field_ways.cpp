// Ways to map the field of a rod: exact, or from a table.

#include "rodwake/app/run_folder.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/stopwatch.hpp"
#include "theory/wake_fields.hpp"
#include "way_subject.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rodwake::app {

namespace {

using elastic::FieldValues;
using scene::FieldBackend;

constexpr double budget = 0.1; ///< s, of repeats of a map
/// What the exact field keeps to (docs/validation.md, "The exact field"): no smaller error is quoted.
constexpr double least_error = 2e-13;
constexpr double table_tolerances[] = {1e-4, 1e-6, 1e-8, 1e-10};

struct MappedWay {
    FieldBackend field = FieldBackend::exact;
    double tolerance = 0.0;
};

struct Place {
    double x, y;
};

/// The grid and the cuts, without the rod itself.
std::vector<Place> places_of(const scene::Scene& scene) {
    const scene::Field& field = *scene.field;
    std::vector<Place> all;
    const auto at = [](double from, double to, long i, long n) {
        return n < 2 ? from : from + (to - from) * static_cast<double>(i) / static_cast<double>(n - 1);
    };
    for (long row = 0; !field.y.empty() && row < field.ny; ++row)
        for (long column = 0; column < field.nx; ++column)
            all.push_back(
                {at(field.x[0], field.x[1], column, field.nx), at(field.y[0], field.y[1], row, field.ny)});
    for (const scene::Cut& cut : field.cuts)
        for (long i = 0; i < cut.count; ++i) {
            const double s = at(cut.from, cut.to, i, cut.count);
            all.push_back(cut.along == "x" ? Place{s, cut.at} : Place{cut.at, s});
        }
    const auto box = scene.medium->periodic;
    std::erase_if(all, [&](const Place& p) { return elastic::is_singular(p.x, p.y, box); });
    return all;
}

scene::Scene mapped_by(scene::Scene scene, const MappedWay& way) {
    scene.medium->field = way.field;
    scene.medium->table.reset();
    if (way.field == FieldBackend::table)
        scene.medium->table = scene::FieldTable{way.tolerance};
    return scene;
}

struct Component {
    const char* name;
    double (*of)(const FieldValues&);
};
constexpr Component displacement[] = {{"x", [](const FieldValues& f) { return f.displacement.x; }},
                                      {"y", [](const FieldValues& f) { return f.displacement.y; }}};
constexpr Component strain[] = {{"xx", [](const FieldValues& f) { return f.strain.xx; }},
                                {"xy", [](const FieldValues& f) { return f.strain.xy; }},
                                {"yy", [](const FieldValues& f) { return f.strain.yy; }}};
constexpr Component gradients[] = {{"lapx", [](const FieldValues& f) { return f.laplacian.x; }},
                                   {"lapy", [](const FieldValues& f) { return f.laplacian.y; }},
                                   {"gradx_tr", [](const FieldValues& f) { return f.gradient_of_trace.x; }},
                                   {"grady_tr", [](const FieldValues& f) { return f.gradient_of_trace.y; }}};

double size_of(const FieldValues& f, std::span<const Component> components) {
    double sum = 0.0;
    for (const Component& one : components)
        sum += one.of(f) * one.of(f);
    return std::sqrt(sum);
}

double difference(const FieldValues& a, const FieldValues& b, std::span<const Component> components) {
    double sum = 0.0;
    for (const Component& one : components)
        sum += (one.of(a) - one.of(b)) * (one.of(a) - one.of(b));
    return std::sqrt(sum);
}

/// Largest over the places of |a - b|/|b|: near the rod the field is large, far away small, and both are
/// read from a map.
double error_of(const std::vector<FieldValues>& map, const std::vector<FieldValues>& reference,
                std::span<const Component> components) {
    double largest = 0.0;
    for (std::size_t i = 0; i < map.size(); ++i)
        if (const double size = size_of(reference[i], components); size > 0.0) {
            const double error = difference(map[i], reference[i], components) / size;
            largest = std::isnan(error) ? HUGE_VAL : std::max(largest, error);
        }
    return largest;
}

class FieldTrials {
public:
    FieldTrials(scene::Scene scene, std::vector<MappedWay> ways, const RunContext& context)
        : scene_(std::move(scene)), ways_(std::move(ways)), places_(places_of(scene_)), context_(context),
          fields_(context, {}, make_silent_logger()) {}

    bool attempt(std::vector<Way>& all, std::size_t k) {
        if (reference_.empty())
            reference_ = map_of({}, nullptr);
        Way& way = all[k];
        const std::vector<FieldValues> map = map_of(ways_[k], &way.seconds);
        way.runs = 1;
        const auto add = [&](const char* name, std::span<const Component> components) {
            const double error = std::max(least_error, error_of(map, reference_, components));
            way.found.push_back({.name = name, .unit = "1", .value = error, .bias = error});
        };
        add("displacement", displacement);
        add("strain", strain);
        add("gradients", gradients);
        return !context_.stopped();
    }

private:
    std::vector<FieldValues> map_of(const MappedWay& way, double* seconds) {
        const auto field = fields_.of(mapped_by(scene_, way));
        const auto wake = field->wake(0.0);
        std::vector<FieldValues> map(places_.size());
        const auto evaluate = [&] {
            for (std::size_t i = 0; i < map.size() && !context_.stopped(); ++i)
                map[i] = wake->at(places_[i].x, places_[i].y,
                                  {.displacement = true, .strain = true, .polar = true});
        };
        if (seconds)
            *seconds = seconds_of(evaluate, budget);
        else
            evaluate();
        return map;
    }

    scene::Scene scene_;
    std::vector<MappedWay> ways_;
    std::vector<Place> places_;
    const RunContext& context_;
    WakeFields fields_;
    std::vector<FieldValues> reference_;
};

} // namespace

WaySubject field_ways(const scene::Scene& scene, const RunContext& context) {
    if (!scene.field || !scene.medium)
        throw InputError(scene.path + ": no [field] table, so there is no map whose cost and error could be "
                                      "measured");
    if (scene.medium->fitted || scene.medium->field == FieldBackend::measured)
        throw InputError(scene.path + ": the field of this scene is measured or fitted: there is one way to "
                                      "map it; give eta and xi in [medium] to compare the others");
    std::vector<MappedWay> ways{{}};
    const bool square = !scene.medium->periodic || scene.medium->periodic->square(); // tables know no other
    for (const double tolerance : square ? std::span(table_tolerances) : std::span<const double>())
        ways.push_back({FieldBackend::table, tolerance});
    WaySubject subject{
        stage_key(mapped_by(scene, {}), Stage::field), "the exact field (docs/validation.md)", {}, {}};
    for (const MappedWay& way : ways)
        subject.ways.push_back(
            {.keys =
                 way.field == FieldBackend::exact
                     ? std::vector<std::string>{"medium.field=\"exact\""}
                     : std::vector<std::string>{"medium.field=\"table\"",
                                                fmt::format("medium.table.tolerance={:g}", way.tolerance)}});
    const auto trials = std::make_shared<FieldTrials>(scene, std::move(ways), context);
    subject.attempt = [trials](std::vector<Way>& all, std::size_t k) { return trials->attempt(all, k); };
    return subject;
}

} // namespace rodwake::app
