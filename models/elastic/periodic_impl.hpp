#pragma once
// What a periodic field is made of: two potentials, in the rod's axes, and the infinite plane's own field.

#include "field_algebra.hpp"
#include "periodic_local.hpp"
#include "rodwake/elastic/periodic.hpp"

#include <array>
#include <mutex>
#include <optional>

namespace rodwake::elastic {

/// U = (1/2 pi) [A xhat + grad B], div U = (1/2 pi) d_x C: A = G_T, B = xi (G_T - G_L), C = nu G_L, or their
/// derivatives by the medium or the heading. Rod's axes; unit of length: the box's shorter side.
struct JetParts {
    Jet a, b, c;
};

/// The field of these parts. `unit`: of length, the caller's. `uniform`: density of the counterforce, which
/// the Laplacian of the field itself holds; 0 for derivatives.
FieldValues assembled(const JetParts& p, FieldRequest request, double unit, double shear_decay,
                      double uniform);

/// Which derivatives of the potentials a request takes.
Needed needed_for(FieldRequest request);

/// A place in the box's axes and shorter side, in the cell about the nearest of the rod and its images; that
/// one's place and the offset from it in the rod's axes and the caller's unit.
struct NearestImage {
    double x, y;
    Vector shift, offset;
};

/// (d.grad) of the infinite plane's field.
FieldValues along(const Field& field, Vector at, Vector d, FieldRequest request);

struct PeriodicField::Impl {
    Medium medium;
    PeriodicBox box; ///< the caller's unit
    double unit;     ///< of length below: the shorter side
    PeriodicBox sides;
    double heading, cosine, sine;
    Field field;
    double xi, nu;
    PeriodicPotential shear, longitudinal;
    std::optional<std::array<PeriodicPotential, 2>> between; ///< at the nodes of the integral over c

    Impl(const Medium& m, const PeriodicBox& whole, double angle);

    NearestImage nearest(double x, double y) const;
    Jet to_rod(const Jet& box_axes, bool third) const { return from_axes(cosine, -sine, box_axes, third); }

    /// Of the whole field where it is summed as rows, of the rest near the rod.
    JetParts parts(double x, double y, Needed needed) const;
    FieldValues rest(double x, double y, FieldRequest request) const;
    MediumDerivatives rest_derivatives(double x, double y, FieldRequest request) const;
    FieldValues rest_by_heading(const NearestImage& p, FieldRequest request) const;

private:
    Jet b_between(double x, double y, Needed needed) const;
    Jet logarithm(double c, double x, double y, bool third) const;

    /// The potentials with their derivatives by heading, built when first asked for: they cost as much as the
    /// field.
    struct Turning {
        PeriodicPotential shear, longitudinal;
    };
    const Turning& turning() const;
    mutable std::once_flag turning_once_;
    mutable std::optional<Turning> turning_;
};

/// For this part alone.
struct PeriodicInternals {
    /// The field without the infinite plane's field of the rod; in the cell about it, in the box's axes and
    /// shorter side.
    /// Rod's frame. Smooth.
    static FieldValues smooth_rest(const PeriodicField& field, double x, double y, FieldRequest request);
};

} // namespace rodwake::elastic
