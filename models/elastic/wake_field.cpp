#include "rodwake/elastic/wake_field.hpp"

#include "field_algebra.hpp"
#include "rodwake/core/error.hpp"

#include <cmath>

namespace rodwake::elastic {

namespace {

constexpr FieldValues nothing{};

/// Adds what was asked for, turned to the lab. The rest is left alone: most sums are of one tensor, and
/// turning them all takes longer than the field.
void add_turned(FieldValues& sum, const FieldValues& f, FieldRequest request, double cosine, double sine) {
    const auto add = [&](Vector& to, const Vector& v) {
        const Vector lab = turned(v, cosine, sine);
        to = {to.x + lab.x, to.y + lab.y};
    };
    if (request.strain) {
        const SymmetricTensor lab = turned(f.strain, cosine, sine);
        sum.strain = {sum.strain.xx + lab.xx, sum.strain.xy + lab.xy, sum.strain.yy + lab.yy};
    }
    if (request.polar) {
        add(sum.laplacian, f.laplacian);
        add(sum.gradient_of_trace, f.gradient_of_trace);
    }
    if (request.displacement)
        add(sum.displacement, f.displacement);
    if (request.dipole)
        add(sum.dipole, f.dipole);
}

} // namespace

FieldValues Wake::heading_derivative(double, double, FieldRequest) const { return nothing; }
FieldValues Wake::self_image_field(FieldRequest) const { return nothing; }
FieldValues Wake::own_place_by_heading(FieldRequest) const { return nothing; }
MediumDerivatives Wake::own_place_by_medium(FieldRequest) const { return {nothing, nothing}; }

void WakeField::mutual(std::span<const Source> rods, FieldRequest request,
                       std::span<FieldValues> sums) const {
    if (rods.size() != sums.size())
        throw InputError("sums over rods: as many results as rods are needed");
    request.gradients = false;
    for (FieldValues& sum : sums)
        sum = empty_sum(request);
    for (std::size_t b = 0; b < rods.size(); ++b) {
        const double cosine = std::cos(rods[b].heading), sine = std::sin(rods[b].heading);
        const auto source = wake(rods[b].heading);
        for (std::size_t a = 0; a < rods.size(); ++a) {
            const Vector at = turned(Vector{rods[a].x - rods[b].x, rods[a].y - rods[b].y}, cosine, -sine);
            if (a != b)
                add_turned(sums[a], source->at(at.x, at.y, request), request, cosine, sine);
            else if (box())
                add_turned(sums[a], source->self_image_field(request), request, cosine, sine);
        }
    }
}

bool is_singular(double x, double y, std::optional<PeriodicBox> box, double heading) {
    if (!box)
        return x == 0.0 && y == 0.0;
    const double unit = box->shorter();
    const Vector lab = turned(Vector{x / unit, y / unit}, std::cos(heading), std::sin(heading));
    const auto off = [](double sides) { return std::abs(sides - std::nearbyint(sides)); };
    constexpr double rounding = 1e-9;
    return off(lab.x / (box->x / unit)) < rounding && off(lab.y / (box->y / unit)) < rounding;
}

namespace {

Vector& operator+=(Vector& a, const Vector& b) {
    a.x += b.x;
    a.y += b.y;
    return a;
}

SymmetricTensor& operator+=(SymmetricTensor& a, const SymmetricTensor& b) {
    a.xx += b.xx;
    a.xy += b.xy;
    a.yy += b.yy;
    return a;
}

} // namespace

FieldValues lab_field(const Field& field, const Source& source, double x, double y, FieldRequest request) {
    const double cosine = std::cos(source.heading), sine = std::sin(source.heading);
    const Vector offset = turned(Vector{x - source.x, y - source.y}, cosine, -sine);
    request.gradients = false;
    const FieldValues own = field.at(offset.x, offset.y, request);
    FieldValues lab = unrequested(); // gradients too
    lab.displacement = turned(own.displacement, cosine, sine);
    lab.strain = turned(own.strain, cosine, sine);
    lab.laplacian = turned(own.laplacian, cosine, sine);
    lab.gradient_of_trace = turned(own.gradient_of_trace, cosine, sine);
    lab.dipole = turned(own.dipole, cosine, sine);
    return lab;
}

FieldValues superpose(const Field& field, std::span<const Source> sources, double x, double y,
                      FieldRequest request) {
    FieldValues sum;
    for (const Source& source : sources) {
        const FieldValues item = lab_field(field, source, x, y, request);
        sum.displacement += item.displacement;
        sum.strain += item.strain;
        sum.laplacian += item.laplacian;
        sum.gradient_of_trace += item.gradient_of_trace;
        sum.dipole += item.dipole;
    }
    return sum;
}

} // namespace rodwake::elastic
