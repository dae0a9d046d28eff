#include "rodwake/app/scan_problem.hpp"

#include "rodwake/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace rodwake::app {

namespace {

double* of_coupling(const std::string& key, rods::Couplings& couplings) {
    constexpr std::string_view table = "coupling.";
    const rods::Coupling* coupling =
        key.starts_with(table) ? rods::find_coupling(std::string_view(key).substr(table.size())) : nullptr;
    return coupling ? &(couplings.*coupling->number) : nullptr;
}

double* of_rod(const std::string& key, std::vector<rods::Pose>& rods) {
    for (std::size_t k = 0; k < rods.size(); ++k) {
        const std::string rod = fmt::format("rods.{}.", k);
        if (key == rod + "position.0")
            return &rods[k].x;
        if (key == rod + "position.1")
            return &rods[k].y;
        if (key == rod + "heading")
            return &rods[k].heading;
    }
    return nullptr;
}

} // namespace

PointProblem::PointProblem(const ScanPlan& plan)
    : plan_(plan), scene_(std::make_unique<scene::Scene>(plan.base)), problem_(rod_problem(*scene_)) {
    for (const ScanPlan::VariedKey& key : plan.keys)
        direct_.push_back(place_of(key, *scene_, problem_));
    if (std::ranges::count(direct_, nullptr) > 0)
        direct_.clear();
}

double* PointProblem::place_of(const ScanPlan::VariedKey& key, const scene::Scene& scene,
                               rods::RodProblem& problem) {
    if (key.whole || !key.words.empty())
        return nullptr;
    if (scene.coupling && scene.coupling->polar_basis != scene::PolarBasis::divergence)
        if (double* place = of_coupling(key.key, problem.couplings))
            return place;
    return of_rod(key.key, problem.rods);
}

const rods::RodProblem& PointProblem::at(const scan::Point& point) {
    if (direct_.empty()) {
        if (const auto wrong = set_point(plan_, *scene_, point))
            throw InputError(*wrong);
        problem_ = rod_problem(*scene_);
    }
    const std::span<const double> at = values_of(plan_.design, point);
    for (std::size_t k = 0; k < direct_.size(); ++k) // the axes' ends were tried, and ranges are intervals
        *direct_[k] = at[plan_.keys[k].axis] * plan_.keys[k].scale;
    return problem_;
}

} // namespace rodwake::app
