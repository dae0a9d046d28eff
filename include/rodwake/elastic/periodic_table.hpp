#pragma once
// The field of a rod in a periodic box (periodic.hpp) from a table, for rods that turn at every step:
// building a PeriodicField for each heading costs 10 to 50 times what it takes from here.
//
//   u = infinite plane's field of the nearest image (exact) + a smooth rest, tabulated over place and heading
//
// The rest is piecewise polynomial (Chebyshev, degree 8 by place, 11 by heading), in the box's axes and for
// headings of one eighth of a turn: the square's symmetry gives the others. Pieces get smaller as L/xi grows.
//
// Error: `error()`, measured while building at places and headings between the nodes, of each quantity
// relative to its largest value at the same distance from the rod; at most the tolerance asked for.
// Derivatives by place and heading are those of the polynomials and have one to two digits less. Domain: that
// of PeriodicField, and L/xi max(1, nu) up to 70 at a tolerance of 1e-8, where the table takes
// `memory_limit`; beyond it the constructor throws InputError. Continuous to within the error where pieces
// meet.
//
// Cost: docs/validation.md.

#include "rodwake/elastic/field.hpp"
#include "rodwake/elastic/superposition.hpp"

#include <cstddef>
#include <memory>

namespace rodwake::elastic {

class PeriodicTable {
public:
    static constexpr std::size_t memory_limit = 128'000'000; ///< bytes

    /// `box` = L in the unit of medium.xi; `tolerance` from 1e-10 to 1e-3; built on up to `threads` threads,
    /// the same to the bit for any number. Throws InputError, also if the tolerance is out of reach.
    PeriodicTable(const Medium& medium, double box, double tolerance = 1e-8, std::size_t threads = 1);

    /// Field of the source and all its images at (x, y), all in the lab frame, whose axes are the box's
    /// sides. Components in that frame too, and gradients by lab x and y. Throws InputError at the source or
    /// an image.
    FieldValues at(const Source& source, double x, double y, FieldRequest request) const;

    /// What the images alone make at the source's own place.
    FieldValues at_own_place(double heading, FieldRequest request) const;

    /// d/d heading of both, per rad, at a place and in components fixed in the lab frame (PeriodicField's are
    /// fixed in the rod's). Gradients are not available: InputError.
    FieldValues by_heading(const Source& source, double x, double y, FieldRequest request) const;
    FieldValues own_place_by_heading(double heading, FieldRequest request) const;

    const Medium& medium() const;
    double box() const;
    double error() const;      ///< the largest found, as above
    std::size_t bytes() const; ///< of the table

private:
    struct Impl;
    std::shared_ptr<const Impl> impl_; ///< shared: copies are cheap, calls independent and thread-safe
};

} // namespace rodwake::elastic
