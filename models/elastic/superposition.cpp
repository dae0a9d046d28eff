#include "rodwake/elastic/superposition.hpp"

#include <cmath>

namespace rodwake::elastic {

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
        const FieldValues one = lab_field(field, source, x, y, request);
        sum.displacement += one.displacement;
        sum.strain += one.strain;
        sum.laplacian += one.laplacian;
        sum.gradient_of_trace += one.gradient_of_trace;
        sum.dipole += one.dipole;
    }
    return sum;
}

} // namespace rodwake::elastic
