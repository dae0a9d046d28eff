// What was measured beyond theory, behind elastic/wake_field.hpp.

#include "field_algebra.hpp"
#include "measured_residual.hpp"
#include "rodwake/core/error.hpp"

#include <cmath>
#include <utility>

namespace rodwake::elastic {

namespace {

/// The places of one rod's residual that a place in its frame stands for: on the plane itself, in a box its
/// images. `visit` gets each with the way there.
class Images {
public:
    Images(std::optional<PeriodicBox> box, double heading)
        : box_(box), cosine_(std::cos(heading)), sine_(std::sin(heading)) {}

    template<class Visit>
    void visit(const MeasuredResidual& residual, double x, double y, Visit visit) const {
        if (!box_) {
            if (residual.reaches(x, y))
                visit(Vector{x, y}, Vector{});
            return;
        }
        const Vector lab = turned(Vector{x, y}, cosine_, sine_);
        const double across = std::nearbyint(lab.x / box_->x), along = std::nearbyint(lab.y / box_->y);
        for (const double i : {-1.0, 0.0, 1.0})
            for (const double j : {-1.0, 0.0, 1.0}) {
                const Vector way =
                    turned(Vector{(i - across) * box_->x, (j - along) * box_->y}, cosine_, -sine_);
                if (const Vector at{x + way.x, y + way.y}; residual.reaches(at.x, at.y))
                    visit(at, way);
            }
    }

private:
    std::optional<PeriodicBox> box_;
    double cosine_, sine_;
};

void refuse_dipole(FieldRequest request) {
    if (request.dipole)
        throw InputError("a measured field has no field of a force dipole");
}

class MeasuredWake final : public Wake {
public:
    MeasuredWake(std::shared_ptr<const Wake> theory, std::shared_ptr<const MeasuredResidual> residual,
                 const Images& images)
        : theory_(std::move(theory)), residual_(std::move(residual)), images_(images) {}

    FieldValues at(double x, double y, FieldRequest request) const override {
        refuse_dipole(request);
        FieldValues f = theory_->at(x, y, request);
        images_.visit(*residual_, x, y, [&](Vector at, Vector) { residual_->add_to(f, at.x, at.y); });
        return f;
    }
    FieldValues heading_derivative(double x, double y, FieldRequest request) const override;
    MediumDerivatives medium_derivatives(double, double, FieldRequest) const override {
        throw InputError("a measured field has no derivatives by the medium");
    }
    FieldValues self_image_field(FieldRequest request) const override {
        return theory_->self_image_field(request);
    }
    FieldValues own_place_by_heading(FieldRequest request) const override {
        return theory_->own_place_by_heading(request);
    }
    MediumDerivatives own_place_by_medium(FieldRequest request) const override {
        return medium_derivatives(0.0, 0.0, request);
    }

private:
    std::shared_ptr<const Wake> theory_;
    std::shared_ptr<const MeasuredResidual> residual_;
    Images images_;
};

/// As the rod turns, the ways to its images turn back in its frame.
FieldValues MeasuredWake::heading_derivative(double x, double y, FieldRequest request) const {
    FieldValues f = theory_->heading_derivative(x, y, request);
    images_.visit(*residual_, x, y, [&](Vector at, Vector way) {
        FieldValues here{};
        residual_->add_to(here, at.x, at.y);
        add_times(f, way.y, gradient_x(here));
        add_times(f, -way.x, gradient_y(here));
    });
    return f;
}

class MeasuredField final : public WakeField {
public:
    MeasuredField(std::shared_ptr<const WakeField> theory, MeasuredResidual residual)
        : theory_(std::move(theory)),
          residual_(std::make_shared<const MeasuredResidual>(std::move(residual))) {}

    FieldCapabilities capabilities() const override {
        return {.displacement = true, .dipole = false, .gradients = true, .medium_derivatives = false};
    }
    const Medium& medium() const override { return theory_->medium(); }
    std::optional<PeriodicBox> box() const override { return theory_->box(); }
    std::shared_ptr<const Wake> wake(double heading) const override {
        return std::make_shared<const MeasuredWake>(theory_->wake(heading), residual_,
                                                    Images(box(), heading));
    }
    void mutual(std::span<const Source> rods, FieldRequest request,
                std::span<FieldValues> sums) const override;

private:
    std::shared_ptr<const WakeField> theory_;
    std::shared_ptr<const MeasuredResidual> residual_;
};

void MeasuredField::mutual(std::span<const Source> rods, FieldRequest request,
                           std::span<FieldValues> sums) const {
    refuse_dipole(request);
    theory_->mutual(rods, request, sums);
    for (const Source& source : rods) {
        const double cosine = std::cos(source.heading), sine = std::sin(source.heading);
        const Images images(box(), source.heading);
        for (std::size_t a = 0; a < rods.size(); ++a) {
            if (&rods[a] == &source)
                continue;
            const Vector at = turned(Vector{rods[a].x - source.x, rods[a].y - source.y}, cosine, -sine);
            images.visit(*residual_, at.x, at.y, [&](Vector position, Vector) {
                FieldValues more{};
                residual_->add_to(more, position.x, position.y);
                add(sums[a], turned(more, cosine, sine));
            });
        }
    }
}

} // namespace

std::shared_ptr<const WakeField> measured_field(std::shared_ptr<const WakeField> theory,
                                                MeasuredResidual residual) {
    return std::make_shared<const MeasuredField>(std::move(theory), std::move(residual));
}

} // namespace rodwake::elastic
