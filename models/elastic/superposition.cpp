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

Vector turned(const Vector& v, double cosine, double sine) {
    return {cosine * v.x - sine * v.y, sine * v.x + cosine * v.y};
}

SymmetricTensor turned(const SymmetricTensor& t, double cosine, double sine) {
    const double cc = cosine * cosine, ss = sine * sine, cs = cosine * sine;
    return {cc * t.xx - 2.0 * cs * t.xy + ss * t.yy, cs * (t.xx - t.yy) + (cc - ss) * t.xy,
            ss * t.xx + 2.0 * cs * t.xy + cc * t.yy};
}

FieldValues lab_field(const Field& field, const Source& source, double x, double y, Wanted wanted) {
    const double cosine = std::cos(source.heading), sine = std::sin(source.heading);
    const Vector offset = turned(Vector{x - source.x, y - source.y}, cosine, -sine);
    wanted.slopes = false;
    const FieldValues own = field.at(offset.x, offset.y, wanted);
    FieldValues lab;
    lab.displacement = turned(own.displacement, cosine, sine);
    lab.strain = turned(own.strain, cosine, sine);
    lab.laplacian = turned(own.laplacian, cosine, sine);
    lab.gradient_of_trace = turned(own.gradient_of_trace, cosine, sine);
    lab.dipole = turned(own.dipole, cosine, sine);
    return lab;
}

FieldValues superpose(const Field& field, std::span<const Source> sources, double x, double y,
                      Wanted wanted) {
    FieldValues sum;
    for (const Source& source : sources) {
        const FieldValues one = lab_field(field, source, x, y, wanted);
        sum.displacement += one.displacement;
        sum.strain += one.strain;
        sum.laplacian += one.laplacian;
        sum.gradient_of_trace += one.gradient_of_trace;
        sum.dipole += one.dipole;
    }
    return sum;
}

} // namespace rodwake::elastic
