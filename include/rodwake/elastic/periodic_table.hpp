#pragma once
// The field of a rod in a periodic square (periodic.hpp) from a table, for rods that turn at every step: a
// new heading costs nothing here, there 6 to 90 microseconds.
//
//   u = infinite plane's field of the nearest image (exact) + a smooth rest, tabulated over place and heading
//
// The rest is piecewise polynomial (Chebyshev, degree 8 by place, 11 by heading), in the box's axes and for
// headings within an eighth of a turn; the square's symmetry gives the others. Pieces get smaller as L/xi
// grows.
//
// Error of each quantity, relative to its largest value at the same distance from the rod: error(), measured
// while building at 640 places and headings between the nodes, at most the tolerance asked for. At a
// tolerance of 1e-8 gradients are within 1e-7 of the largest gradient there, derivatives by heading within
// 1e-6 of theirs: those of the polynomials, which jump by as much where pieces meet.
//
//
//   tolerance 1e-8, L/xi 0.01 to 50     all quantities 4e-9; gradients of strain 9e-8; strain by heading 3e-7
//   (build/dev/tests/test_elastic "*table*")
//
// Degenerate input, InputError always (tests/elastic/test_plane_table.cpp): an illegal medium; a box <= 0,
// infinite or out of reach; a tolerance outside [1e-10, 1e-3] or NaN; the source or an image; a place, source
// or heading that is not finite; gradients of derivatives by heading; data that are no table's.
//
// Domain: finite places off the rod and its images; L/xi max(1, nu) up to 50 at a tolerance of 1e-8, 100 at
// 1e-6, 150 at 1e-5, where the table reaches memory_limit (beyond: InputError). nu = 1/(1 + eta).
//
// Cost, L/xi 1 to 50: 0.1 to 2 s and 4 to 99 MB to build; 0.9 microseconds a strain, 0.2 at the own place
// (bench/periodic_bench.cpp).

#include "rodwake/elastic/wake_field.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace rodwake::elastic {

/// A table as plain numbers, so that it can be stored. Lengths in the unit of xi.
struct PeriodicTableData {
    double eta = 0.0, xi = 0.0, box = 0.0;
    double tolerance = 0.0;
    double error = 0.0; ///< the largest found when it was made
    std::int32_t place_pieces = 0, angle_pieces = 0;
    std::array<std::vector<double>, 4> coefficients; ///< of displacement, strain, polar vectors, dipole

    bool operator==(const PeriodicTableData&) const = default;
};

class PeriodicTable {
public:
    static constexpr std::size_t memory_limit = 128'000'000; ///< bytes
    static constexpr double smallest_tolerance = 1e-10, largest_tolerance = 1e-3;

    /// `box` = L in the unit of medium.xi; `tolerance` as above; built on up to `threads` threads,
    /// the same to the bit for any number. Throws InputError, also if the tolerance is out of reach.
    PeriodicTable(const Medium& medium, double box, double tolerance = 1e-8, std::size_t threads = 1);

    /// The same table, to the bit, of what data() gave. Throws InputError for numbers that are none's.
    explicit PeriodicTable(PeriodicTableData data);
    PeriodicTableData data() const;

    /// Field of the source and all its images at (x, y), all in the lab frame, whose axes are the box's
    /// sides. Components in that frame too, and gradients by lab x and y. Throws InputError at the source or
    /// an image.
    FieldValues at(const Source& source, double x, double y, FieldRequest request) const;

    /// What the images alone make at the source's own place.
    FieldValues self_image_field(double heading, FieldRequest request) const;

    /// d/d heading of both, per rad, at a place and in components fixed in the lab frame (PeriodicField's are
    /// fixed in the rod's). Gradients are not available: InputError.
    FieldValues heading_derivative(const Source& source, double x, double y, FieldRequest request) const;
    FieldValues own_place_by_heading(double heading, FieldRequest request) const;

    const Medium& medium() const;
    double box() const;
    double error() const;      ///< the largest found, as above
    std::size_t bytes() const; ///< of the table

private:
    struct Impl;
    std::shared_ptr<const Impl> impl_; ///< shared: copies are cheap, calls independent and thread-safe
};

/// The wakes of a medium in its box from the table; derivatives by the medium are exact, at the price of the
/// exact field.
std::shared_ptr<const WakeField> table_field(const PeriodicTable& table);

} // namespace rodwake::elastic
