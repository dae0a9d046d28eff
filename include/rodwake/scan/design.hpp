#pragma once
// Where the points of a scan lie: axes, and the designs whose points are known beforehand (grid, list, Latin
// hypercube, Sobol). The adaptive design, whose points follow from results, is in refinement.hpp.

#include "rodwake/scan/point.hpp"

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
struct Driver {
    std::size_t observable = 0; ///< index into Columns::observables
    double step = 0.0;          ///< largest change over a cell
};

struct Design {
    Kind kind = Kind::grid;
    std::vector<Axis> axes;
    long samples = 0;                      ///< lhs, sobol
    std::vector<std::vector<double>> rows; ///< list: the values of each point
    std::uint64_t seed = 1;                ///< of lhs and of the audit
    long resolution = 0;                   ///< adaptive: cells a side at the finest
    long audit = 0;                        ///< adaptive: points tried at random where nothing was refined
    std::vector<Driver> drivers;           ///< adaptive
    double boundary_tolerance = 0.0;       ///< adaptive, of the axis; 0: boundaries are not bisected
};

/// Points that the design asks for: of an adaptive one those of the full lattice at its resolution. Throws
/// InputError if they cannot be counted in 62 bits.
std::int64_t size(const Design& design);

/// The points of a design that is not adaptive, by their number.
class PointList {
public:
    explicit PointList(const Design& design);

    std::int64_t size() const { return size_; }
    Point operator[](std::int64_t id) const;

private:
    const Design& design_;
    std::int64_t size_ = 0;
    std::vector<double> fractions_; ///< lhs, sobol: of each axis, point by point
};

} // namespace rodwake::scan
