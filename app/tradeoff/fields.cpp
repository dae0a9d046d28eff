// Ways to map the field of a rod: exact, or from a table.

#include "rodwake/app/run_folder.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/stopwatch.hpp"
#include "target.hpp"
#include "theory/wake_fields.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rodwake::app {

namespace {

using scene::FieldBackend;

constexpr double budget = 0.1; ///< s, of repeats of a map
/// What the exact field keeps to (docs/validation_elastic.md, "Field of one rod"): no smaller error is
/// quoted.
constexpr double least_error = 2e-13;
constexpr double table_tolerances[] = {1e-4, 1e-6, 1e-8, 1e-10};

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

/// By a table to this tolerance; 0: exact.
scene::Scene mapped_by(scene::Scene scene, double tolerance) {
    scene.medium->field = tolerance > 0.0 ? FieldBackend::table : FieldBackend::exact;
    scene.medium->table.reset();
    if (tolerance > 0.0)
        scene.medium->table = scene::FieldTable{tolerance};
    return scene;
}

/// What a map tells of a place.
struct MapPoint {
    std::array<double, 2> displacement;
    std::array<double, 3> strain;
    std::array<double, 4> gradients;

    static constexpr auto fields() {
        using R = MapPoint;
        return std::tuple{field("displacement", &R::displacement, {"1", "of the medium"}),
                          field("strain", &R::strain, {"1", "of the medium"}),
                          field("gradients", &R::gradients, {"1", "of the strain"})};
    }
};

MapPoint point_of(const elastic::FieldValues& f) {
    return {{f.displacement.x, f.displacement.y},
            {f.strain.xx, f.strain.xy, f.strain.yy},
            {f.laplacian.x, f.laplacian.y, f.gradient_of_trace.x, f.gradient_of_trace.y}};
}

/// Of each result the largest over the places of |a - b|/|b|: near the rod the field is large, far away
/// small, and both are read from a map.
std::vector<Found> errors_of(const std::vector<MapPoint>& map, const std::vector<MapPoint>& reference) {
    std::vector<Found> found;
    for_each_field<MapPoint>([&](const auto& field) {
        double largest = 0.0;
        for (std::size_t i = 0; i < map.size(); ++i) {
            double difference = 0.0, size = 0.0;
            for (std::size_t k = 0; k < (map[i].*field.member).size(); ++k) {
                const double a = (map[i].*field.member)[k], b = (reference[i].*field.member)[k];
                difference += (a - b) * (a - b);
                size += b * b;
            }
            const double error = std::sqrt(difference) / std::sqrt(size);
            if (size > 0.0)
                largest = std::isnan(error) ? HUGE_VAL : std::max(largest, error);
        }
        found.push_back(error_found(field.name, field.info.unit, std::max(least_error, largest)));
    });
    return found;
}

class FieldTarget : public Target {
public:
    FieldTarget(const scene::Scene& scene, const RunContext& context)
        : scene_(scene), places_(places_of(scene)), context_(context),
          fields_(context, {}, make_silent_logger()) {
        table.work = stage_key(mapped_by(scene, 0.0), Stage::field);
        table.reference = "the exact field (docs/validation.md)";
        table.ways.push_back({.keys = {"medium.field=\"exact\""}, .seconds = 0.0});
        const bool square = !scene.medium->periodic || scene.medium->periodic->square();
        for (const double tolerance : square ? std::span(table_tolerances) : std::span<const double>()) {
            tolerances_.push_back(tolerance); // tables know no other box
            table.ways.push_back(
                {.keys = {"medium.field=\"table\"", fmt::format("medium.table.tolerance={:g}", tolerance)},
                 .seconds = 0.0});
        }
    }

    bool attempt(std::size_t k) override {
        if (reference_.empty())
            reference_ = map_of(0.0, nullptr);
        Way& way = table.ways[k];
        const std::vector<MapPoint> map = map_of(tolerances_[k], &way.seconds);
        way.runs = 1;
        way.found = errors_of(map, reference_);
        return !context_.stopped();
    }

private:
    std::vector<MapPoint> map_of(double tolerance, double* seconds) {
        const auto field = fields_.of(mapped_by(scene_, tolerance));
        const auto wake = field->wake(0.0);
        std::vector<elastic::FieldValues> map(places_.size());
        const auto evaluate = [&] {
            for (std::size_t i = 0; i < map.size() && !context_.stopped(); ++i)
                map[i] = wake->at(places_[i].x, places_[i].y,
                                  {.displacement = true, .strain = true, .polar = true});
        };
        if (seconds)
            *seconds = seconds_of(evaluate, budget);
        else
            evaluate();
        std::vector<MapPoint> points(map.size());
        std::ranges::transform(map, points.begin(), point_of);
        return points;
    }

    scene::Scene scene_;
    std::vector<double> tolerances_{0.0};
    std::vector<Place> places_;
    const RunContext& context_;
    WakeFields fields_;
    std::vector<MapPoint> reference_;
};

} // namespace

std::unique_ptr<Target> field_target(const scene::Scene& scene, const std::filesystem::path& /*results*/,
                                     const RunContext& context) {
    if (!scene.field || !scene.medium)
        throw InputError(scene.path + ": no [field] table, so there is no map whose cost and error could be "
                                      "measured");
    if (scene.medium->fitted || scene.medium->field == FieldBackend::measured)
        throw InputError(scene.path + ": the field of this scene is measured or fitted: there is one way to "
                                      "map it; give eta and xi in [medium] to compare the others");
    return std::make_unique<FieldTarget>(scene, context);
}

} // namespace rodwake::app
