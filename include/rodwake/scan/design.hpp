#pragma once
// Where the points of a scan lie: axes, and the designs whose points are known beforehand (grid, list, Latin
// hypercube, Sobol). The adaptive design, whose points follow from results, is in refinement.hpp.

#include "rodwake/scan/point.hpp"

#include <algorithm>
#include <functional>
#include <optional>

namespace rodwake::scan {

enum class Spacing { linear, log, listed };

struct Axis {
    std::string name; ///< the key that varies; of several the first
    Spacing spacing = Spacing::linear;
    double from = 0.0, to = 1.0;
    bool whole = false;             ///< values are rounded to whole numbers
    long count = 2;                 ///< grid: points, both ends included; adaptive: cells at the start
    std::vector<double> values;     ///< listed
    std::vector<std::string> words; ///< listed words: values are their indices

    /// The value at a fraction u of the axis, 0 <= u <= 1: `from` and `to` themselves at the ends. Of a
    /// listed axis the value whose turn it is.
    double at(double u) const;
};

enum class Kind { grid, list, lhs, sobol, adaptive };
const char* to_string(Kind kind);

/// A continuous observable that drives refinement beside the outcome.
struct RefinementCriterion {
    std::size_t observable = 0; ///< index into Columns::observables
    double step = 0.0;          ///< largest change over a cell
};
using Driver [[deprecated("it is RefinementCriterion")]] = RefinementCriterion;

struct Design {
    Kind kind = Kind::grid;
    std::vector<Axis> axes;
    long samples = 0;                         ///< lhs, sobol
    std::vector<std::vector<double>> rows;    ///< list: the values of each point
    std::uint64_t seed = 1;                   ///< of lhs and of the audit
    long resolution = 0;                      ///< adaptive: cells a side at the finest
    long audit = 0;                           ///< adaptive: points tried at random where nothing was refined
    std::vector<RefinementCriterion> drivers; ///< adaptive
    /// Adaptive, beside the outcome: where a result stands to a thin region that may lie alone, by sign; NaN:
    /// far from any. Cells over which it changes sign are halved. Empty: no such region is known.
    std::function<double(const Result&)> side;
    double boundary_tolerance = 0.0; ///< adaptive, of the axis; 0: boundaries are not bisected
    /// Not adaptive: each place is evaluated so many times, as runs that differ in their random numbers
    /// (point.hpp has their ids); 0: once, and the id of a point is its place.
    long runs = 0;
    /// What a run at each place costs, in any unit: the dearest places come first, so that a scan does not
    /// end with a long one. Empty: places come in their order.
    std::vector<double> costs;
};

/// A list of more columns than a point holds: the first value of a point is the number of its row.
inline bool is_long_list(const Design& design) {
    return design.kind == Kind::list && design.axes.size() > max_axes;
}

/// The value of a point on each axis.
inline std::span<const double> values_of(const Design& design, const Point& point) {
    if (is_long_list(design))
        return design.rows[static_cast<std::size_t>(point.at[0])];
    return std::span(point.at).first(std::min(design.axes.size(), max_axes));
}

/// Places that the design asks for: of an adaptive one those of the full lattice at its resolution. Throws
/// InputError if they cannot be counted in 62 bits.
std::int64_t places(const Design& design);
/// Points: places times runs. Throws as `places`.
std::int64_t size(const Design& design);

/// The points of a design that is not adaptive, in the order in which they are evaluated.
class PointList {
public:
    explicit PointList(const Design& design);

    std::int64_t size() const { return size_; }
    Point operator[](std::int64_t number) const;
    /// The number of the point of this id; nothing if the design has none.
    std::optional<std::int64_t> number_of(std::int64_t id) const;
    /// The point of a place, whose id is the place.
    Point at_place(std::int64_t index) const;

private:
    const Design& design_;
    std::int64_t size_ = 0;
    std::vector<std::int64_t> order_, rank_; ///< by cost: the places, and where each stands; empty: in order
    std::vector<double> fractions_;          ///< lhs, sobol: of each axis, place by place
};

} // namespace rodwake::scan
