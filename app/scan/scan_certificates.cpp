// How well the outcomes of a scan of rods are known: its points, and of an adaptive one its cells.

#include "rodwake/app/scan_problem.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/parallel.hpp"
#include "rodwake/rods/certificate.hpp"
#include "rodwake/scan/lattice.hpp"
#include "scan_parts.hpp"
#include "scan_values.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <unordered_map>

namespace rodwake::app {

namespace {

std::vector<scan::Lattice::LatticePoint> corners_of(const scan::Lattice& lattice, const scan::Leaf& leaf) {
    std::vector<scan::Lattice::LatticePoint> corners(std::size_t{1} << lattice.axes(), leaf.low);
    for (std::size_t which = 0; which < corners.size(); ++which)
        for (std::size_t k = 0; k < lattice.axes(); ++k)
            corners[which][k] += (which >> k & 1u) != 0 ? leaf.side : 0;
    return corners;
}

/// Whether no pair within the cell can end otherwise than its corners.
bool is_uniform(PointProblem& problem, const scan::Lattice& lattice, const scan::Leaf& leaf) {
    std::vector<rods::PairProblem> pairs;
    for (const scan::Lattice::LatticePoint& corner : corners_of(lattice, leaf)) {
        const auto pair = rods::to_pair_problem(problem.at(lattice.point(corner)));
        if (!pair)
            return false;
        pairs.push_back(*pair); // NOLINT(performance-inefficient-vector-operation): of two, four or eight
    }
    return rods::all_end(pairs, static_cast<Ending>(leaf.outcome), {problem.run().rtol, problem.run().atol});
}

} // namespace

ScanCertificates certificates_of(const ScanPlan& plan, const scan::Ledger& ledger,
                                 const scan::Summary& summary, std::size_t threads) {
    ScanCertificates found;
    const auto& names = plan.columns.observables;
    const auto column =
        static_cast<std::size_t>(std::ranges::find(names, certificate_column) - names.begin());
    if (column == names.size())
        return found;
    std::unordered_map<std::int64_t, Certificate> known; // of points that did not fail, by id
    ledger.for_each([&](const scan::Result& result) {
        if (!result.ok())
            return;
        const auto certificate = static_cast<Certificate>(result.values[column]);
        ++found.points[static_cast<std::size_t>(certificate)];
        if (!summary.leaves.empty())
            known.emplace(result.point.id, certificate);
    });
    if (summary.leaves.empty())
        return found;
    const scan::Lattice lattice(plan.design);
    // A cell is known as well as the worst of its corners; open where outcomes differ or one is not known.
    for (const scan::Leaf& leaf : summary.leaves) {
        const bool uniform = !leaf.mixed && leaf.outcome >= 0;
        Certificate& worst = found.cells.emplace_back(uniform ? Certificate::verified : Certificate::open);
        for (const scan::Lattice::LatticePoint& corner : corners_of(lattice, leaf)) {
            const auto at = known.find(lattice.id(corner));
            worst = std::max(worst, at == known.end() ? Certificate::open : at->second);
        }
    }

    // Cells whose corners are verified are so themselves, or their corners alone are: then they are checked.
    constexpr std::size_t at_once = 64;
    parallel_for((summary.leaves.size() + at_once - 1) / at_once, threads, [&](std::size_t block) {
        PointProblem problem(plan);
        for (std::size_t i = at_once * block; i < std::min(summary.leaves.size(), at_once * (block + 1)); ++i)
            try {
                if (found.cells[i] == Certificate::verified &&
                    !is_uniform(problem, lattice, summary.leaves[i]))
                    found.cells[i] = Certificate::checked;
            } catch (const InputError&) { // values that no point may have
                found.cells[i] = Certificate::checked;
            }
    });
    for (std::size_t i = 0; i < found.cells.size(); ++i) {
        double area = 1.0;
        for (std::size_t k = 0; k < lattice.axes(); ++k)
            area *= lattice.fraction(k, summary.leaves[i].side);
        found.area[static_cast<std::size_t>(found.cells[i])] += area;
    }
    return found;
}

std::string certificates_text(const ScanCertificates& certificates) {
    const auto& [points, area, cells] = certificates;
    std::string text =
        fmt::format("{} points verified, {} checked, {} open", points[0], points[1], points[2]);
    if (!cells.empty())
        text += fmt::format("; of the area {:.1f} % verified, {:.1f} % checked, {:.1f} % open",
                            100.0 * area[0], 100.0 * area[1], 100.0 * area[2]);
    return text;
}

} // namespace rodwake::app
