// How well the outcomes of a scan of rods are known: its points, and of an adaptive one its cells.

#include "rodwake/scan/lattice.hpp"
#include "scan_parts.hpp"
#include "scan_values.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <unordered_map>

namespace rodwake::app {

namespace {

/// Of points that did not fail, by id.
using Known = std::unordered_map<std::int64_t, Certificate>;

std::optional<std::size_t> certificate_number(const scan::Columns& columns) {
    const auto at = std::ranges::find(columns.observables, certificate_column);
    if (at == columns.observables.end())
        return std::nullopt;
    return static_cast<std::size_t>(at - columns.observables.begin());
}

/// The worst of the cell's corners; open where outcomes differ or one is not known.
Certificate worst_corner(const scan::Lattice& lattice, const scan::Leaf& leaf, const Known& known) {
    if (leaf.mixed || leaf.outcome < 0)
        return Certificate::open;
    Certificate worst = Certificate::checked; // of what lies between them nothing is proved
    for (std::size_t which = 0; which < std::size_t{1} << lattice.axes(); ++which) {
        scan::Lattice::Place corner = leaf.low;
        for (std::size_t k = 0; k < lattice.axes(); ++k)
            corner[k] += (which >> k & 1u) != 0 ? leaf.side : 0;
        const auto at = known.find(lattice.id(corner));
        worst = std::max(worst, at == known.end() ? Certificate::open : at->second);
    }
    return worst;
}

double area_of(const scan::Lattice& lattice, const scan::Leaf& leaf) {
    double area = 1.0;
    for (std::size_t k = 0; k < lattice.axes(); ++k)
        area *= lattice.fraction(k, leaf.side);
    return area;
}

} // namespace

ScanCertificates certificates_of(const ScanPlan& plan, const scan::Ledger& ledger,
                                 const scan::Summary& summary) {
    ScanCertificates found;
    const auto column = certificate_number(plan.columns);
    if (!column)
        return found;
    Known known;
    ledger.for_each([&](const scan::Result& result) {
        if (!result.ok())
            return;
        const auto certificate = static_cast<Certificate>(result.values[*column]);
        ++found.points[static_cast<std::size_t>(certificate)];
        if (!summary.leaves.empty())
            known.emplace(result.point.id, certificate);
    });
    if (summary.leaves.empty())
        return found;
    const scan::Lattice lattice(plan.design);
    for (const scan::Leaf& leaf : summary.leaves)
        found.cells.push_back(worst_corner(lattice, leaf, known));
    for (std::size_t i = 0; i < found.cells.size(); ++i)
        found.area[static_cast<std::size_t>(found.cells[i])] += area_of(lattice, summary.leaves[i]);
    return found;
}

std::string certificates_text(const ScanCertificates& certificates) {
    const auto& [points, area, cells] = certificates;
    std::string text = fmt::format("{} points proved, {} checked, {} open", points[0], points[1], points[2]);
    if (!cells.empty())
        text += fmt::format("; of the area {:.1f} % proved, {:.1f} % checked, {:.1f} % open", 100.0 * area[0],
                            100.0 * area[1], 100.0 * area[2]);
    return text;
}

} // namespace rodwake::app
