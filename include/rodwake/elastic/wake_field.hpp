#pragma once
// The wakes of rods as other rods meet them, however they are worked out: exactly, on the infinite plane or
// in a periodic box (here), or in another way that implements this interface.
//
// A Wake is the field of one rod of given heading, in that rod's own frame (rod at the origin, heading along
// +x); units and signs are those of elastic/field.hpp. A WakeField gives the wakes of all rods of a medium.
// Places and sums over rods are in the lab frame. Everything is thread-safe.

#include "rodwake/core/periodic.hpp"
#include "rodwake/elastic/field.hpp"
#include "rodwake/elastic/medium_derivatives.hpp"
#include "rodwake/elastic/mutual_wakes.hpp"

#include <memory>
#include <optional>
#include <span>

namespace rodwake::elastic {

/// What a field can be asked for besides strain and polar vectors; the rest throws InputError.
struct FieldCapabilities {
    bool displacement = true, dipole = true;
    bool gradients = true;          ///< FieldRequest::gradients, Wake::heading_derivative
    bool medium_derivatives = true; ///< Wake::medium_derivatives
};

class Wake {
public:
    virtual ~Wake() = default;

    /// At (x, y) in the rod's frame. Throws InputError at the rod and, in a box, at its images.
    virtual FieldValues at(double x, double y, FieldRequest request) const = 0;
    /// What turning the medium's surroundings (a box) against the rod changes: the derivative by the rod's
    /// heading at a fixed place in the rod's frame, components in that frame, of strain and polar vectors.
    /// Zero on the plane.
    virtual FieldValues heading_derivative(double x, double y, FieldRequest request) const;
    /// d/d eta and d/d xi at a fixed place.
    virtual MediumDerivatives medium_derivatives(double x, double y, FieldRequest request) const = 0;

    /// What the rod's own images make where it is, and its derivatives as above. Zero on the plane.
    virtual FieldValues self_image_field(FieldRequest request) const;
    virtual FieldValues own_place_by_heading(FieldRequest request) const;
    virtual MediumDerivatives own_place_by_medium(FieldRequest request) const;
};

class WakeField {
public:
    virtual ~WakeField() = default;

    virtual FieldCapabilities capabilities() const { return {}; }
    virtual const Medium& medium() const = 0;
    /// The periodic box, axes those of the lab; none: infinite plane.
    virtual std::optional<PeriodicBox> box() const { return {}; }

    /// Cheap on the plane, where all headings share one; in a box it is built for the heading.
    virtual std::shared_ptr<const Wake> wake(double heading) const = 0;

    /// At each rod the wakes of all others, and in a box those of its own images, lab components; `sums` is
    /// as long as `rods`. No gradients. Throws InputError if two rods are in the same place.
    virtual void mutual(std::span<const Source> rods, FieldRequest request,
                        std::span<FieldValues> sums) const;
};

/// The exact field: elastic/field.hpp on the plane, elastic/periodic.hpp in a periodic box. Throws
/// InputError for an illegal medium; for an illegal box when a wake is asked for.
/// `sums`: how WakeField::mutual works on the plane (8 rods or more); in a box each pair is exact.
std::shared_ptr<const WakeField> exact_field(const Medium& medium, std::optional<PeriodicBox> box = {},
                                             const MutualWakesOptions& sums = {});

/// Whether (x, y) in the frame of a rod is the rod's own place, or that of an image to 1e-9 of the box: of
/// places given in decimal digits and turned by the heading more cannot be asked.
bool is_singular(double x, double y, std::optional<PeriodicBox> box = {}, double heading = 0.0);

} // namespace rodwake::elastic
