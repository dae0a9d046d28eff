#include "rodwake/scan/run.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <utility>

namespace rodwake::scan {

namespace {

using LatticePoint = Lattice::LatticePoint;
using Pair = std::pair<std::int32_t, std::int32_t>;

struct GridEdge {
    LatticePoint low;
    std::size_t axis;
};

std::int64_t number_of(const Lattice& lattice, const GridEdge& edge) {
    return lattice.id(edge.low) * static_cast<std::int64_t>(lattice.axes()) +
           static_cast<std::int64_t>(edge.axis);
}

GridEdge edge_of(const Lattice& lattice, std::int64_t number) {
    const auto axes = static_cast<std::int64_t>(lattice.axes());
    return {lattice.place(number / axes), static_cast<std::size_t>(number % axes)};
}

/// Edges of a cell, those of axis 0 first: for two axes bottom, top, left, right.
std::vector<GridEdge> edges_of(const Lattice& lattice, const Leaf& cell) {
    std::vector<GridEdge> edges;
    for (std::size_t axis = 0; axis < lattice.axes(); ++axis)
        for (std::size_t which = 0; which < std::size_t{1} << lattice.axes(); ++which) {
            if (which >> axis & 1U)
                continue;
            LatticePoint low = cell.low;
            for (std::size_t k = 0; k < lattice.axes(); ++k)
                if (which >> k & 1U)
                    low[k] += cell.side;
            edges.push_back({low, axis});
        }
    return edges;
}

std::vector<Leaf> finest_mixed(const Refinement& refinement) {
    const std::int64_t side = refinement.lattice().stride(refinement.lattice().levels());
    std::vector<Leaf> cells = refinement.leaves();
    std::erase_if(cells, [&](const Leaf& cell) { return cell.side != side || !cell.mixed; });
    return cells;
}

Pair pair_of(const OutcomeChange& crossing) {
    return std::minmax(crossing.outcome_low, crossing.outcome_high);
}

/// Which crossings are joined within a cell, as indices.
using Links = std::map<std::size_t, std::vector<std::size_t>>;

/// The crossings of a cell between two outcomes, in an order in which neighbours can be joined.
std::map<Pair, std::vector<std::size_t>> crossings_in(const Lattice& lattice, const Leaf& cell,
                                                      std::span<const OutcomeChange> crossings) {
    std::map<Pair, std::vector<std::size_t>> found;
    const std::vector<GridEdge> edges = edges_of(lattice, cell);
    for (const std::size_t which : {0, 2, 1, 3}) {
        const auto at =
            std::ranges::lower_bound(crossings, number_of(lattice, edges[which]), {}, &OutcomeChange::id);
        if (at != crossings.end() && at->id == number_of(lattice, edges[which]))
            found[pair_of(*at)].push_back(static_cast<std::size_t>(at - crossings.begin()));
    }
    return found;
}

BoundaryPoint point_of(const Lattice& lattice, const OutcomeChange& crossing) {
    const GridEdge edge = edge_of(lattice, crossing.id);
    const double middle = 0.5 * (crossing.u_low + crossing.u_high);
    return {lattice.point_on(edge.low, edge.axis, middle).at, 0.5 * (crossing.u_high - crossing.u_low)};
}

/// Joins the crossings of two axes from cell to cell.
std::vector<Curve> joined(const Refinement& refinement, std::span<const OutcomeChange> crossings) {
    const Lattice& lattice = refinement.lattice();
    std::map<Pair, Links> all_links;
    for (const Leaf& cell : finest_mixed(refinement))
        for (const auto& [pair, inside] : crossings_in(lattice, cell, crossings)) {
            if (pair.first < 0)
                continue;
            // Two crossings between the same outcomes are joined; one alone may be joined in the next cell.
            // Four (a saddle): lower with left and upper with right, which for the shortest curves is as good
            // as the other way.
            Links& links = all_links[pair];
            for (const std::size_t crossing : inside)
                links.try_emplace(crossing);
            for (std::size_t i = 0; i + 1 < inside.size(); i += 2) {
                links[inside[i]].push_back(inside[i + 1]);
                links[inside[i + 1]].push_back(inside[i]);
            }
        }
    std::vector<Curve> curves;
    for (const auto& [pair, links] : all_links) {
        std::set<std::size_t> seen;
        for (const bool open : {true, false}) // open ones first, from their ends
            for (const auto& [start, others] : links) {
                if (seen.contains(start) || (open && others.size() != 1))
                    continue;
                Curve curve{pair.first, pair.second, {}};
                const std::vector<std::size_t>* neighbours = nullptr;
                for (std::optional<std::size_t> at = start; at;) {
                    curve.points.push_back(point_of(lattice, crossings[*at]));
                    seen.insert(*at);
                    neighbours = &links.at(*at);
                    const auto next =
                        std::ranges::find_if(*neighbours, [&](std::size_t k) { return !seen.contains(k); });
                    at = next == neighbours->end() ? std::nullopt : std::optional(*next);
                }
                if (curve.points.size() > 2 && std::ranges::count(*neighbours, start) > 0)
                    curve.points.push_back(point_of(lattice, crossings[start])); // closed
                curves.push_back(std::move(curve));
            }
    }
    return curves;
}

} // namespace

std::vector<OutcomeChange> crossed_edges(const Refinement& refinement) {
    const Lattice& lattice = refinement.lattice();
    std::map<std::int64_t, OutcomeChange> found;
    for (const Leaf& cell : finest_mixed(refinement))
        for (const GridEdge& edge : edges_of(lattice, cell)) {
            LatticePoint high = edge.low;
            high[edge.axis] += cell.side;
            const std::int32_t a = refinement.outcome(edge.low), b = refinement.outcome(high);
            if (a != b && a >= 0 && b >= 0) {
                const std::int64_t number = number_of(lattice, edge);
                found[number] = {number, a, b, lattice.fraction(edge.axis, edge.low[edge.axis]),
                                 lattice.fraction(edge.axis, high[edge.axis])};
            }
        }
    std::vector<OutcomeChange> edges;
    edges.reserve(found.size());
    for (const auto& [number, crossing] : found)
        edges.push_back(crossing);
    return edges;
}

Point middle(const Refinement& refinement, const OutcomeChange& crossing) {
    const GridEdge edge = edge_of(refinement.lattice(), crossing.id);
    Point point =
        refinement.lattice().point_on(edge.low, edge.axis, 0.5 * (crossing.u_low + crossing.u_high));
    point.id = crossing.id;
    return point;
}

void bisect(OutcomeChange& crossing, const Result& at_middle) {
    const double u = 0.5 * (crossing.u_low + crossing.u_high);
    const std::int32_t outcome = at_middle.ok() ? at_middle.outcome : -1;
    if (outcome == crossing.outcome_low) {
        crossing.u_low = u;
    } else {
        crossing.u_high = u;
        crossing.outcome_high = outcome;
    }
}

std::vector<Curve> boundary_curves(const Refinement& refinement, std::span<const OutcomeChange> crossings) {
    if (refinement.lattice().axes() == 2)
        return joined(refinement, crossings);
    // The points between two outcomes, as they come.
    std::map<Pair, Curve> sets;
    for (const OutcomeChange& crossing : crossings)
        if (const Pair pair = pair_of(crossing); pair.first >= 0) {
            Curve& curve = sets.try_emplace(pair, Curve{pair.first, pair.second, {}}).first->second;
            curve.points.push_back(point_of(refinement.lattice(), crossing));
        }
    std::vector<Curve> curves;
    curves.reserve(sets.size());
    for (auto& [pair, curve] : sets)
        curves.push_back(std::move(curve));
    return curves;
}

} // namespace rodwake::scan
