#include "rodwake/elastic/periodic_table.hpp"

#include "field_algebra.hpp"
#include "periodic_impl.hpp"
#include "periodic_table_impl.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/elastic/periodic.hpp"
#include "rodwake/elastic/wake_field.hpp"

#include <cmath>
#include <numbers>
#include <utility>

namespace rodwake::elastic {

namespace {

constexpr double quarter = 0.5 * std::numbers::pi;

FieldValues combined(double a, const FieldValues& f, double b, const FieldValues& g) {
    FieldValues sum{}; // 0 everywhere
    add_times(sum, a, f);
    add_times(sum, b, g);
    return sum;
}

using Group = std::array<GridValue, ChebyshevGrid::most>;

/// One group's functions into the quantities they are.
void put(FieldValues& f, std::size_t group, const Group& v, double GridValue::*part) {
    const auto vector = [&](std::size_t at) { return Vector{v[at].*part, v[at + 1].*part}; };
    switch (group) {
    case 0:
        f.displacement = vector(0);
        return;
    case 1:
        f.strain = {v[0].*part, v[1].*part, v[2].*part};
        return;
    case 2:
        f.laplacian = vector(0);
        f.gradient_of_trace = vector(2);
        return;
    default:
        f.dipole = vector(0);
    }
}

/// The nearest of the source and its images: its place in the box's side, and the offset from it in the lab.
struct Nearest {
    double x, y;
    Vector offset;
};

Nearest nearest(const Source& source, double x, double y, double box) {
    const Vector away{x - source.x, y - source.y};
    if (!std::isfinite(away.x) || !std::isfinite(away.y))
        throw InputError("field of a table: the position and the source must be finite");
    const double i = std::nearbyint(away.x / box), j = std::nearbyint(away.y / box);
    const Vector offset{away.x - i * box, away.y - j * box};
    return {offset.x / box, offset.y / box, offset};
}

void refuse_gradients(FieldRequest request) {
    if (request.gradients)
        throw InputError("gradients of the derivative by heading are not available");
}

} // namespace

/// By quarter turns of the box and its mirror symmetry.
PeriodicTable::Impl::Rest PeriodicTable::Impl::rest(double heading, double x, double y, FieldRequest request,
                                                    GridRequest derivatives) const {
    if (!std::isfinite(heading))
        throw InputError("field of a table: the heading must be finite");
    const double quarters = std::nearbyint(heading / quarter), left = heading - quarters * quarter;
    const double k = quarters - 4.0 * std::floor(0.25 * quarters); // 0 .. 3
    const double cosine = k == 0.0   ? 1.0
                          : k == 2.0 ? -1.0
                                     : 0.0,
                 sine = k == 1.0   ? 1.0
                        : k == 3.0 ? -1.0
                                   : 0.0;
    const double mirror = left < 0.0 ? -1.0 : 1.0;
    const Vector at = turned(Vector{x, y}, cosine, -sine);

    // In the first eighth, 0 <= heading <= pi/4, by the groups of the table.
    const double own_heading = std::abs(left), own_x = at.x, own_y = mirror * at.y;
    const bool own_place = own_x == 0.0 && own_y == 0.0 && !derivatives.by_place;
    const bool wanted[] = {request.displacement, request.strain, request.polar, request.dipole};
    Rest own;
    for (std::size_t g = 0; g < groups.size(); ++g) {
        if (!wanted[g])
            continue;
        const Group v = own_place ? groups[g].at_centre(own_heading)
                                  : groups[g].at(own_x, own_y, own_heading, derivatives);
        put(own.value, g, v, &GridValue::v);
        if (derivatives.by_place) {
            put(own.by_x, g, v, &GridValue::x);
            put(own.by_y, g, v, &GridValue::y);
        }
        if (derivatives.by_angle)
            put(own.heading_derivative, g, v, &GridValue::angle);
    }

    // Back to the heading.
    const auto back = [&](const FieldValues& f) {
        return turned(mirror < 0.0 ? mirrored(f) : f, cosine, sine);
    };
    Rest rest;
    rest.value = back(own.value);
    if (derivatives.by_place) {
        const FieldValues by_x = back(own.by_x), by_y = back(own.by_y);
        rest.by_x = combined(cosine, by_x, -sine * mirror, by_y);
        rest.by_y = combined(sine, by_x, cosine * mirror, by_y);
    }
    if (derivatives.by_angle)
        rest.heading_derivative = combined(mirror, back(own.heading_derivative), 0.0, own.value);
    return rest;
}

FieldValues PeriodicTable::Impl::at(const Source& source, double x, double y, FieldRequest request) const {
    const Nearest p = nearest(source, x, y, box);
    const double cosine = std::cos(source.heading), sine = std::sin(source.heading);
    const Vector offset = turned(p.offset, cosine, -sine);
    const FieldValues own = field.at(offset.x, offset.y, request);
    const Rest smooth = rest(source.heading, p.x, p.y, request, {.by_place = request.gradients});
    FieldValues f = turned(own, cosine, sine);
    add(f, smooth.value);
    if (!request.gradients)
        return f;
    const FieldValues along_x = turned(gradient_x(own), cosine, sine),
                      along_y = turned(gradient_y(own), cosine, sine);
    FieldValues by_x = combined(cosine, along_x, -sine, along_y),
                by_y = combined(sine, along_x, cosine, along_y);
    add_times(by_x, 1.0 / box, smooth.by_x);
    add_times(by_y, 1.0 / box, smooth.by_y);
    set_gradients(f, by_x, by_y);
    return f;
}

FieldValues PeriodicTable::at(const Source& source, double x, double y, FieldRequest request) const {
    return impl_->at(source, x, y, request);
}

FieldValues PeriodicTable::self_image_field(double heading, FieldRequest request) const {
    const auto rest = impl_->rest(heading, 0.0, 0.0, request, {.by_place = request.gradients});
    FieldValues f = rest.value;
    if (request.gradients)
        set_gradients(f, combined(1.0 / impl_->box, rest.by_x, 0.0, rest.by_x),
                      combined(1.0 / impl_->box, rest.by_y, 0.0, rest.by_y));
    return f;
}

FieldValues PeriodicTable::heading_derivative(const Source& source, double x, double y,
                                              FieldRequest request) const {
    refuse_gradients(request);
    const Nearest p = nearest(source, x, y, impl_->box);
    const double cosine = std::cos(source.heading), sine = std::sin(source.heading);
    const Vector offset = turned(p.offset, cosine, -sine);
    // The infinite plane's field turns, and the place turns back in the rod's frame.
    FieldValues own = turning(impl_->field.at(offset.x, offset.y, request));
    add(own, along(impl_->field, offset, {offset.y, -offset.x}, request));
    FieldValues f = turned(own, cosine, sine);
    add(f, impl_->rest(source.heading, p.x, p.y, request, {.by_angle = true}).heading_derivative);
    return f;
}

FieldValues PeriodicTable::own_place_by_heading(double heading, FieldRequest request) const {
    refuse_gradients(request);
    return impl_->rest(heading, 0.0, 0.0, request, {.by_angle = true}).heading_derivative;
}

const Medium& PeriodicTable::medium() const { return impl_->medium; }
double PeriodicTable::box() const { return impl_->box; }
double PeriodicTable::error() const { return impl_->error; }
std::size_t PeriodicTable::bytes() const {
    std::size_t sum = 0;
    for (const ChebyshevGrid& group : impl_->groups)
        sum += group.bytes();
    return sum;
}

// A PeriodicTable behind elastic/wake_field.hpp. The table speaks in the lab's axes, a Wake in the rod's.

namespace {

class BoxTableWake final : public Wake {
public:
    BoxTableWake(PeriodicTable table, double heading)
        : table_(std::move(table)), source_{0.0, 0.0, heading}, cosine_(std::cos(heading)),
          sine_(std::sin(heading)) {}

    FieldValues at(double x, double y, FieldRequest request) const override;
    FieldValues heading_derivative(double x, double y, FieldRequest request) const override;
    FieldValues self_image_field(FieldRequest request) const override {
        return to_rod(table_.self_image_field(source_.heading, request));
    }
    FieldValues own_place_by_heading(FieldRequest request) const override;
    MediumDerivatives medium_derivatives(double x, double y, FieldRequest request) const override {
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
    const Vector position = to_lab(x, y);
    const FieldValues lab = table_.at(source_, position.x, position.y, request);
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
FieldValues BoxTableWake::heading_derivative(double x, double y, FieldRequest request) const {
    request.displacement = request.dipole = request.gradients = false;
    const Vector position = to_lab(x, y);
    FieldValues change = table_.heading_derivative(source_, position.x, position.y, request);
    request.gradients = true;
    const FieldValues lab = table_.at(source_, position.x, position.y, request);
    add_times(change, -position.y, gradient_x(lab));
    add_times(change, position.x, gradient_y(lab));
    FieldValues f = to_rod(change);
    add_times(f, -1.0, turning(to_rod(lab)));
    return f;
}

FieldValues BoxTableWake::own_place_by_heading(FieldRequest request) const {
    FieldValues f = to_rod(table_.own_place_by_heading(source_.heading, request));
    add_times(f, -1.0, turning(self_image_field(request)));
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
        sums[a] = table_.self_image_field(rods[a].heading, request);
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
