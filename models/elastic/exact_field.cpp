// The exact field behind elastic/wake_field.hpp: on the plane one wake for all headings, in a box one each.

#include "rodwake/elastic/periodic.hpp"
#include "rodwake/elastic/wake_field.hpp"

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

    const Medium& medium() const { return field_.medium(); }

private:
    Field field_;
};

class PlaneField final : public WakeField {
public:
    explicit PlaneField(const Medium& medium) : wake_(std::make_shared<const PlaneWake>(medium)) {}

    const Medium& medium() const override { return wake_->medium(); }
    std::shared_ptr<const Wake> wake(double /*heading*/) const override { return wake_; }

private:
    std::shared_ptr<const PlaneWake> wake_;
};

class PeriodicWake final : public Wake {
public:
    PeriodicWake(const Medium& medium, double box, double heading) : field_(medium, box, heading) {}

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
    BoxField(const Medium& medium, double box) : medium_(medium), box_(box) { validate(medium); }

    const Medium& medium() const override { return medium_; }
    std::optional<double> box() const override { return box_; }
    std::shared_ptr<const Wake> wake(double heading) const override {
        return std::make_shared<const PeriodicWake>(medium_, box_, heading);
    }

private:
    Medium medium_;
    double box_;
};

} // namespace

std::shared_ptr<const WakeField> exact_field(const Medium& medium, std::optional<double> box) {
    if (box)
        return std::make_shared<const BoxField>(medium, *box);
    return std::make_shared<const PlaneField>(medium);
}

} // namespace rodwake::elastic
