#pragma once
// The table's four groups of functions, in the box's axes.

#include "chebyshev_grid.hpp"
#include "field_algebra.hpp"
#include "rodwake/elastic/periodic.hpp"
#include "rodwake/elastic/periodic_table.hpp"

#include <array>

namespace rodwake::elastic {

struct PeriodicTable::Impl {
    Medium medium;
    double box;
    Field field;
    std::array<ChebyshevGrid, 4> groups; ///< displacement, strain, polar, dipole
    double tolerance = 0.0, error = 0.0;

    Impl(const Medium& m, double side, const Pieces& pieces, std::size_t threads);
    explicit Impl(PeriodicTableData data);

    /// The smooth rest and its derivatives, the former by place in units of the box.
    struct Rest {
        FieldValues value = unrequested(), by_x = unrequested(), by_y = unrequested(),
                    heading_derivative = unrequested();
    };
    /// |x|, |y| <= 1/2 in the box's axes and side, any heading.
    Rest rest(double heading, double x, double y, FieldRequest request, GridRequest derivatives) const;

    FieldValues at(const Source& source, double x, double y, FieldRequest request) const;

    /// At 640 random places and headings, each quantity relative to its largest value at that distance.
    double measured_error() const;

private:
    void fill(const Pieces& pieces, std::size_t angle);
    double error_at(const PeriodicField& exact, Vector lab) const;
};

} // namespace rodwake::elastic
