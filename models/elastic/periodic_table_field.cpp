// A PeriodicTable behind elastic/wake_field.hpp. The table speaks in the lab's axes, a Wake in the rod's.

#include "field_algebra.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/elastic/periodic.hpp"
#include "rodwake/elastic/periodic_table.hpp"
#include "rodwake/elastic/wake_field.hpp"

#include <cmath>
#include <utility>

namespace rodwake::elastic {

namespace {

class BoxTableWake final : public Wake {
public:
    BoxTableWake(PeriodicTable table, double heading)
        : table_(std::move(table)), source_{0.0, 0.0, heading}, cosine_(std::cos(heading)),
          sine_(std::sin(heading)) {}

    FieldValues at(double x, double y, FieldRequest request) const override;
    FieldValues by_heading(double x, double y, FieldRequest request) const override;
    FieldValues at_own_place(FieldRequest request) const override {
        return to_rod(table_.at_own_place(source_.heading, request));
    }
    FieldValues own_place_by_heading(FieldRequest request) const override;
    MediumDerivatives by_medium(double x, double y, FieldRequest request) const override {
        return exact().medium_derivatives(x, y, request);
    }
    MediumDerivatives own_place_by_medium(FieldRequest request) const override {
        return exact().own_place_by_medium(request);
    }

private:
    FieldValues to_rod(const FieldValues& lab) const { return turned(lab, cosine_, -sine_); }
    Vector to_lab(double x, double y) const { return turned(Vector{x, y}, cosine_, sine_); }
    PeriodicField exact() const { return {table_.medium(), table_.box(), source_.heading}; }

    PeriodicTable table_;
    Source source_;
    double cosine_, sine_;
};

FieldValues BoxTableWake::at(double x, double y, FieldRequest request) const {
    const Vector place = to_lab(x, y);
    const FieldValues lab = table_.at(source_, place.x, place.y, request);
    FieldValues f = to_rod(lab);
    if (!request.gradients)
        return f;
    const FieldValues gx = to_rod(gradient_x(lab)), gy = to_rod(gradient_y(lab));
    FieldValues by_x{}, by_y{};
    add_times(by_x, cosine_, gx);
    add_times(by_x, sine_, gy);
    add_times(by_y, -sine_, gx);
    add_times(by_y, cosine_, gy);
    set_gradients(f, by_x, by_y);
    return f;
}

/// At a fixed place in the rod's frame the one in the lab's goes around the rod, and the rod's axes turn.
FieldValues BoxTableWake::by_heading(double x, double y, FieldRequest request) const {
    request.displacement = request.dipole = request.gradients = false;
    const Vector place = to_lab(x, y);
    FieldValues change = table_.by_heading(source_, place.x, place.y, request);
    request.gradients = true;
    const FieldValues lab = table_.at(source_, place.x, place.y, request);
    add_times(change, -place.y, gradient_x(lab));
    add_times(change, place.x, gradient_y(lab));
    FieldValues f = to_rod(change);
    add_times(f, -1.0, turning(to_rod(lab)));
    return f;
}

FieldValues BoxTableWake::own_place_by_heading(FieldRequest request) const {
    FieldValues f = to_rod(table_.own_place_by_heading(source_.heading, request));
    add_times(f, -1.0, turning(at_own_place(request)));
    return f;
}

class BoxTableField final : public WakeField {
public:
    explicit BoxTableField(PeriodicTable table) : table_(std::move(table)) {}

    const Medium& medium() const override { return table_.medium(); }
    std::optional<PeriodicBox> box() const override { return table_.box(); }
    std::shared_ptr<const Wake> wake(double heading) const override {
        return std::make_shared<const BoxTableWake>(table_, heading);
    }
    void mutual(std::span<const Source> rods, FieldRequest request,
                std::span<FieldValues> sums) const override;

private:
    PeriodicTable table_;
};

void BoxTableField::mutual(std::span<const Source> rods, FieldRequest request,
                           std::span<FieldValues> sums) const {
    if (rods.size() != sums.size())
        throw InputError("sums over rods: as many results as rods are needed");
    request.gradients = false;
    for (std::size_t a = 0; a < rods.size(); ++a) {
        sums[a] = table_.at_own_place(rods[a].heading, request);
        for (std::size_t b = 0; b < rods.size(); ++b)
            if (b != a)
                add(sums[a], table_.at(rods[b], rods[a].x, rods[a].y, request));
    }
}

} // namespace

std::shared_ptr<const WakeField> table_field(const PeriodicTable& table) {
    return std::make_shared<const BoxTableField>(table);
}

} // namespace rodwake::elastic
