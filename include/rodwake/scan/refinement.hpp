#pragma once
// Adaptive placement: a tree of cells (quadtree, octree) whose corners are the points. Cells over which the
// outcome changes, or an observable by more than its step, or Design::side its sign, are halved until the
// resolution is reached, and so are the cells around them: a boundary leaves no cell unseen, and strips
// thinner than a cell of the start are found where they come near anything else. What is thinner and lies
// alone, the audit finds at the rate it prints. Sides of cells that touch differ by a factor of two at most.
//
// Which points are asked for follows from results alone, so a scan that is taken up with the results in its
// ledger asks for the same ones.

#include "rodwake/scan/lattice.hpp"

#include <unordered_map>
#include <unordered_set>

namespace rodwake::scan {

/// A cell that was not divided.
struct Leaf {
    Lattice::LatticePoint low; ///< its corner of the smallest places
    std::int64_t side = 0;
    std::int32_t outcome = -1; ///< of all corners, if they agree
    bool mixed = false;        ///< outcomes of corners differ
};

class Refinement {
public:
    using LatticePoint = Lattice::LatticePoint;

    explicit Refinement(const Design& design);

    /// Points whose results are needed to go on; none: the refinement is complete.
    std::vector<Point> next();
    void learn(const Result& result);

    /// Divides the cells that hold this place down to the finest: something is there.
    void divide_at(const LatticePoint& position);

    const Lattice& lattice() const { return lattice_; }
    bool knows(std::int64_t id) const { return known_.contains(id); }
    /// -1: failed or unknown.
    std::int32_t outcome(const LatticePoint& place) const;
    /// The cell that holds the finest cell at this place.
    Leaf leaf_at(const LatticePoint& place) const;
    std::vector<Leaf> leaves() const;

private:
    using Cells = std::unordered_set<std::int64_t>; ///< by the number of their low corner

    struct Known {
        std::int32_t outcome;
        std::uint32_t row; ///< of driver values
        int side;          ///< sign; 0: none
    };

    std::size_t corners() const { return std::size_t{1} << lattice_.axes(); }
    LatticePoint corner(const LatticePoint& low, std::int64_t side, std::size_t which) const;
    bool holds(const LatticePoint& low, std::int64_t side) const;
    LatticePoint low_of(const LatticePoint& place, int level) const;
    bool differ(const Known& a, const Known& b) const;
    void add(const LatticePoint& low, int level);
    void ensure(const LatticePoint& low, int level);
    void divide(const LatticePoint& low, int level);
    void follow(const LatticePoint& low, int level);
    Leaf leaf(const LatticePoint& low, int level) const;
    template<class Each>
    void around(const LatticePoint& low, int level, Each each);

    Lattice lattice_;
    std::vector<RefinementCriterion> drivers_;
    std::function<double(const Result&)> side_;
    std::unordered_map<std::int64_t, Known> known_;
    std::vector<double> rows_;
    std::vector<Cells> cells_, divided_;              ///< of each level
    std::vector<std::pair<LatticePoint, int>> fresh_; ///< cells that were not looked at yet
};

} // namespace rodwake::scan
