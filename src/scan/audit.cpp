#include "rodwake/scan/audit.hpp"

#include "rodwake/core/rng.hpp"
#include "rodwake/scan/proportion.hpp"

#include <algorithm>
#include <unordered_set>

namespace rodwake::scan {

double Audit::rate() const {
    return tried > 0 ? static_cast<double>(missed) / static_cast<double>(tried) : 0.0;
}

double Audit::upper_bound() const { return Proportion{missed, tried}.high(0.05); }

std::vector<Point> audit_points(const Refinement& refinement, const Design& design, std::uint32_t round) {
    constexpr std::uint32_t stream = 0x61756474; // no other random numbers of a scan
    RandomStream random(design.seed, stream, round);
    const Lattice& lattice = refinement.lattice();
    const std::int64_t side = lattice.stride(lattice.levels());
    std::vector<Point> points;
    std::unordered_set<std::int64_t> taken;
    for (long tries = 0; tries < 20 * design.audit && static_cast<long>(points.size()) < design.audit;
         ++tries) {
        Lattice::Place place{};
        for (std::size_t k = 0; k < lattice.axes(); ++k) {
            const std::int64_t cells = lattice.steps(k) / side;
            place[k] = static_cast<std::int64_t>(random.uniform() * static_cast<double>(cells + 1)) * side;
        }
        const std::int64_t id = lattice.id(place);
        if (!refinement.knows(id) && !refinement.leaf_at(place).mixed && taken.insert(id).second)
            points.push_back(lattice.point(place));
    }
    std::ranges::sort(points, {}, &Point::id);
    return points;
}

bool is_missed(const Refinement& refinement, const Result& result) {
    const Leaf leaf = refinement.leaf_at(refinement.lattice().place(result.point.id));
    return (result.ok() ? result.outcome : -1) != leaf.outcome;
}

} // namespace rodwake::scan
