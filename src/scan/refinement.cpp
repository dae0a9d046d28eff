#include "rodwake/scan/refinement.hpp"

#include "rodwake/core/rng.hpp"
#include "rodwake/scan/proportion.hpp"
#include "rodwake/scan/run.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_set>

namespace rodwake::scan {

Refinement::Refinement(const Design& design)
    : lattice_(design), drivers_(design.drivers), side_(design.side),
      cells_(static_cast<std::size_t>(lattice_.levels()) + 1), divided_(cells_.size()) {
    const std::int64_t side = lattice_.stride(0);
    const auto count = [&](std::size_t k) { return k < lattice_.axes() ? lattice_.steps(k) / side : 1; };
    for (std::int64_t i = 0; i < count(0); ++i)
        for (std::int64_t j = 0; j < count(1); ++j)
            for (std::int64_t k = 0; k < count(2); ++k)
                add({i * side, j * side, k * side}, 0);
}

void Refinement::learn(const Result& result) {
    const auto row = static_cast<std::uint32_t>(drivers_.empty() ? 0 : rows_.size() / drivers_.size());
    for (const RefinementCriterion& driver : drivers_)
        rows_.push_back(result.ok() ? result.values[driver.observable] : std::nan(""));
    const double side = side_ && result.ok() ? side_(result) : 0.0;
    known_[result.point.id] = {result.ok() ? result.outcome : -1, row, (side > 0.0) - (side < 0.0)};
}

std::int32_t Refinement::outcome(const LatticePoint& position) const {
    const auto found = known_.find(lattice_.id(position));
    return found == known_.end() ? -1 : found->second.outcome;
}

std::vector<Point> Refinement::next() {
    std::vector<Point> wanted;
    while (!fresh_.empty()) {
        Cells asked;
        for (const auto& [low, level] : fresh_)
            for (std::size_t c = 0; c < corners(); ++c) {
                const LatticePoint position = corner(low, lattice_.stride(level), c);
                const std::int64_t id = lattice_.id(position);
                if (!known_.contains(id) && asked.insert(id).second)
                    wanted.push_back(lattice_.point(position));
            }
        if (!wanted.empty())
            break;
        const auto seen = std::move(fresh_);
        fresh_.clear();
        for (const auto& [low, level] : seen) {
            const Known& first = known_.at(lattice_.id(low));
            bool mixed = false;
            for (std::size_t c = 1; c < corners() && !mixed; ++c)
                mixed = differ(first, known_.at(lattice_.id(corner(low, lattice_.stride(level), c))));
            if (mixed)
                follow(low, level);
        }
    }
    std::ranges::sort(wanted, {}, &Point::id);
    return wanted;
}

/// What a mixed cell asks of itself and its neighbours.
void Refinement::follow(const LatticePoint& low, int level) {
    const std::int64_t side = lattice_.stride(level);
    if (level < lattice_.levels()) {
        around(low, level, [&](const LatticePoint& cell) { divide(cell, level); });
        return;
    }
    // At the finest the boundary goes on through the faces over which corners differ.
    for (std::size_t k = 0; k < lattice_.axes(); ++k)
        for (const std::size_t upper : {0, 1}) {
            bool differs = false;
            for (std::size_t c = 1; c < corners(); ++c) {
                const std::size_t bit = std::size_t{1} << k;
                const auto on_face = [&](std::size_t which) {
                    return corner(low, side, upper ? which | bit : which & ~bit);
                };
                differs =
                    differs || differ(known_.at(lattice_.id(on_face(c))), known_.at(lattice_.id(on_face(0))));
            }
            LatticePoint next = low;
            next[k] += upper ? side : -side;
            if (differs && holds(next, side))
                ensure(next, level);
        }
}

void Refinement::divide_at(const LatticePoint& position) {
    for (int level = 0; level < lattice_.levels(); ++level)
        divide(low_of(position, level), level);
}

Refinement::LatticePoint Refinement::corner(const LatticePoint& low, std::int64_t side,
                                            std::size_t which) const {
    LatticePoint position = low;
    for (std::size_t k = 0; k < lattice_.axes(); ++k)
        if (which >> k & 1U)
            position[k] += side;
    return position;
}

bool Refinement::holds(const LatticePoint& low, std::int64_t side) const {
    for (std::size_t k = 0; k < lattice_.axes(); ++k)
        if (low[k] < 0 || low[k] + side > lattice_.steps(k))
            return false;
    return true;
}

/// Low corner of the cell of this level that holds a place; at the far end of an axis that of the last.
Refinement::LatticePoint Refinement::low_of(const LatticePoint& position, int level) const {
    const std::int64_t side = lattice_.stride(level);
    LatticePoint low = position;
    for (std::size_t k = 0; k < lattice_.axes(); ++k)
        low[k] = std::min(position[k] / side * side, lattice_.steps(k) - side);
    return low;
}

bool Refinement::differ(const Known& a, const Known& b) const {
    if (a.outcome != b.outcome || a.side * b.side < 0)
        return true;
    for (std::size_t d = 0; d < drivers_.size(); ++d)
        if (std::abs(rows_[a.row * drivers_.size() + d] - rows_[b.row * drivers_.size() + d]) >
            drivers_[d].step)
            return true;
    return false;
}

void Refinement::add(const LatticePoint& low, int level) {
    if (cells_[static_cast<std::size_t>(level)].insert(lattice_.id(low)).second)
        fresh_.emplace_back(low, level);
}

/// Makes the cell by dividing what holds it.
void Refinement::ensure(const LatticePoint& low, int level) {
    if (level > 0 && !cells_[static_cast<std::size_t>(level)].contains(lattice_.id(low)))
        divide(low_of(low, level - 1), level - 1);
}

void Refinement::divide(const LatticePoint& low, int level) {
    ensure(low, level);
    if (!divided_[static_cast<std::size_t>(level)].insert(lattice_.id(low)).second)
        return;
    around(low, level, [&](const LatticePoint& cell) { ensure(cell, level); }); // what touches is not coarser
    for (std::size_t c = 0; c < corners(); ++c)
        add(corner(low, lattice_.stride(level + 1), c), level + 1);
}

/// The cell and those that touch it.
template<class Each>
void Refinement::around(const LatticePoint& low, int level, Each each) {
    const std::int64_t side = lattice_.stride(level);
    const int dims = static_cast<int>(lattice_.axes());
    int count = 1;
    for (int k = 0; k < dims; ++k)
        count *= 3;
    for (int which = 0; which < count; ++which) {
        LatticePoint cell = low;
        for (int k = 0, rest = which; k < dims; ++k, rest /= 3)
            cell[static_cast<std::size_t>(k)] += (rest % 3 - 1) * side;
        if (holds(cell, side))
            each(cell);
    }
}

Leaf Refinement::leaf(const LatticePoint& low, int level) const {
    const std::int64_t side = lattice_.stride(level);
    Leaf leaf{low, side, outcome(low), false};
    for (std::size_t c = 1; c < corners(); ++c)
        leaf.mixed = leaf.mixed || outcome(corner(low, side, c)) != leaf.outcome;
    return leaf;
}

Leaf Refinement::leaf_at(const LatticePoint& position) const {
    int level = 0;
    while (level < lattice_.levels() &&
           divided_[static_cast<std::size_t>(level)].contains(lattice_.id(low_of(position, level))))
        ++level;
    return leaf(low_of(position, level), level);
}

std::vector<Leaf> Refinement::leaves() const {
    std::vector<Leaf> found;
    for (std::size_t level = 0; level < cells_.size(); ++level) {
        const std::size_t first = found.size();
        for (const std::int64_t id : cells_[level])
            if (!divided_[level].contains(id))
                found.push_back(leaf(lattice_.place(id), static_cast<int>(level)));
        std::ranges::sort(found.begin() + static_cast<std::ptrdiff_t>(first), found.end(), {},
                          [&](const Leaf& item) { return lattice_.id(item.low); });
    }
    return found;
}

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
        Lattice::LatticePoint place{};
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
