// The exact field behind elastic/wake_field.hpp: on the plane one wake for all headings, in a box one each.

#include "field_algebra.hpp"
#include "rodwake/elastic/mutual_wakes.hpp"
#include "rodwake/elastic/periodic.hpp"
#include "rodwake/elastic/wake_field.hpp"

#include <cmath>
#include <vector>

namespace rodwake::elastic {

namespace {

class PlaneWake final : public Wake {
public:
    explicit PlaneWake(const Medium& medium) : field_(medium) {}

    FieldValues at(double x, double y, FieldRequest request) const override {
        return field_.at(x, y, request);
    }
    MediumDerivatives by_medium(double x, double y, FieldRequest request) const override {
        return medium_derivatives(field_, x, y, request);
    }

    const Field& field() const { return field_; }

private:
    Field field_;
};

class PlaneField final : public WakeField {
public:
    PlaneField(const Medium& medium, const MutualWakesOptions& sums)
        : wake_(std::make_shared<const PlaneWake>(medium)), kernels_(medium, sums) {}

    const Medium& medium() const override { return wake_->field().medium(); }
    std::shared_ptr<const Wake> wake(double /*heading*/) const override { return wake_; }
    void mutual(std::span<const Source> rods, FieldRequest request,
                std::span<FieldValues> sums) const override;

private:
    void strains(std::span<const Source> rods, std::span<FieldValues> sums) const;

    std::shared_ptr<const PlaneWake> wake_;
    MutualWakes kernels_;
};

/// Columns of sums over rods, one after the other.
class Columns {
public:
    explicit Columns(std::size_t rods) : rods_(rods), numbers_(7 * rods) {}

    StrainSums strain() { return {column(0), column(1), column(2)}; }
    PolarSums polar() { return {column(3), column(4), column(5), column(6)}; }
    FieldValues row(std::size_t a, bool with_polar) const {
        const auto number = [&](std::size_t k) { return numbers_[k * rods_ + a]; };
        FieldValues f = unrequested();
        f.strain = {number(0), number(1), number(2)};
        if (with_polar) {
            f.laplacian = {number(3), number(4)};
            f.gradient_of_trace = {number(5), number(6)};
        }
        return f;
    }

private:
    std::span<double> column(std::size_t k) { return std::span(numbers_).subspan(k * rods_, rods_); }

    std::size_t rods_;
    std::vector<double> numbers_;
};

/// Of few rods, by the shortest way to the strain: the bits of WakeField::mutual.
void PlaneField::strains(std::span<const Source> rods, std::span<FieldValues> sums) const {
    for (FieldValues& sum : sums)
        sum = empty_sum({.strain = true});
    for (std::size_t b = 0; b < rods.size(); ++b) {
        const double cosine = std::cos(rods[b].heading), sine = std::sin(rods[b].heading);
        for (std::size_t a = 0; a < rods.size(); ++a) {
            if (a == b)
                continue;
            const Vector at = turned(Vector{rods[a].x - rods[b].x, rods[a].y - rods[b].y}, cosine, -sine);
            const SymmetricTensor lab = turned(wake_->field().strain(at.x, at.y), cosine, sine);
            SymmetricTensor& sum = sums[a].strain;
            sum = {sum.xx + lab.xx, sum.xy + lab.xy, sum.yy + lab.yy};
        }
    }
}

void PlaneField::mutual(std::span<const Source> rods, FieldRequest request,
                        std::span<FieldValues> sums) const {
    constexpr std::size_t worth_kernels = 8; // fewer fill too little of a tile
    const bool few = rods.size() < worth_kernels;
    if (rods.size() != sums.size() || request.displacement || request.dipole || (few && request.polar))
        return WakeField::mutual(rods, request, sums);
    if (few)
        return strains(rods, sums);
    Columns columns(rods.size());
    if (request.polar)
        kernels_.strain_and_polar(rods, columns.strain(), columns.polar());
    else
        kernels_.strain(rods, columns.strain());
    for (std::size_t a = 0; a < rods.size(); ++a)
        sums[a] = columns.row(a, request.polar);
}

class PeriodicWake final : public Wake {
public:
    PeriodicWake(const Medium& medium, const PeriodicBox& box, double heading)
        : field_(medium, box, heading) {}

    FieldValues at(double x, double y, FieldRequest request) const override {
        return field_.at(x, y, request);
    }
    FieldValues by_heading(double x, double y, FieldRequest request) const override {
        return field_.by_heading(x, y, request);
    }
    MediumDerivatives by_medium(double x, double y, FieldRequest request) const override {
        return field_.medium_derivatives(x, y, request);
    }
    FieldValues at_own_place(FieldRequest request) const override { return field_.at_own_place(request); }
    FieldValues own_place_by_heading(FieldRequest request) const override {
        return field_.own_place_by_heading(request);
    }
    MediumDerivatives own_place_by_medium(FieldRequest request) const override {
        return field_.own_place_by_medium(request);
    }

private:
    PeriodicField field_;
};

class BoxField final : public WakeField {
public:
    BoxField(const Medium& medium, const PeriodicBox& box) : medium_(medium), box_(box) { validate(medium); }

    const Medium& medium() const override { return medium_; }
    std::optional<PeriodicBox> box() const override { return box_; }
    std::shared_ptr<const Wake> wake(double heading) const override {
        return std::make_shared<const PeriodicWake>(medium_, box_, heading);
    }

private:
    Medium medium_;
    PeriodicBox box_;
};

} // namespace

std::shared_ptr<const WakeField> exact_field(const Medium& medium, std::optional<PeriodicBox> box,
                                             const MutualWakesOptions& sums) {
    if (box)
        return std::make_shared<const BoxField>(medium, *box);
    return std::make_shared<const PlaneField>(medium, sums);
}

} // namespace rodwake::elastic
