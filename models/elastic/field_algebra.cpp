#include "field_algebra.hpp"

#include <array>

namespace rodwake::elastic {

namespace {

constexpr std::array vectors = {&FieldValues::displacement,        &FieldValues::laplacian,
                                &FieldValues::gradient_of_trace,   &FieldValues::dipole,
                                &FieldValues::laplacian_x,         &FieldValues::laplacian_y,
                                &FieldValues::gradient_of_trace_x, &FieldValues::gradient_of_trace_y};
constexpr std::array tensors = {&FieldValues::strain, &FieldValues::strain_x, &FieldValues::strain_y};
constexpr std::size_t plain_vectors = 4;

/// The plain quantities, each by its own rule.
template<class OfVector, class OfTensor>
FieldValues mapped(const FieldValues& f, OfVector of_vector, OfTensor of_tensor) {
    FieldValues g = unrequested();
    for (std::size_t q = 0; q < plain_vectors; ++q)
        g.*vectors[q] = of_vector(f.*vectors[q]);
    g.strain = of_tensor(f.strain);
    return g;
}

} // namespace

void add_times(FieldValues& sum, double factor, const FieldValues& f) {
    for (const auto q : vectors) {
        (sum.*q).x += factor * (f.*q).x;
        (sum.*q).y += factor * (f.*q).y;
    }
    for (const auto q : tensors) {
        (sum.*q).xx += factor * (f.*q).xx;
        (sum.*q).xy += factor * (f.*q).xy;
        (sum.*q).yy += factor * (f.*q).yy;
    }
}

FieldValues turned(const FieldValues& f, double cosine, double sine) {
    return mapped(
        f, [&](const Vector& v) { return turned(v, cosine, sine); },
        [&](const SymmetricTensor& t) { return turned(t, cosine, sine); });
}

FieldValues turning(const FieldValues& f) {
    return mapped(
        f,
        [](const Vector& v) {
            return Vector{-v.y, v.x};
        },
        [](const SymmetricTensor& t) {
            return SymmetricTensor{-2.0 * t.xy, t.xx - t.yy, 2.0 * t.xy};
        });
}

FieldValues mirrored(const FieldValues& f) {
    return mapped(
        f,
        [](const Vector& v) {
            return Vector{v.x, -v.y};
        },
        [](const SymmetricTensor& t) {
            return SymmetricTensor{t.xx, -t.xy, t.yy};
        });
}

FieldValues gradient_x(const FieldValues& f) {
    FieldValues g = unrequested();
    g.strain = f.strain_x;
    g.laplacian = f.laplacian_x;
    g.gradient_of_trace = f.gradient_of_trace_x;
    return g;
}

FieldValues gradient_y(const FieldValues& f) {
    FieldValues g = unrequested();
    g.strain = f.strain_y;
    g.laplacian = f.laplacian_y;
    g.gradient_of_trace = f.gradient_of_trace_y;
    return g;
}

void set_gradients(FieldValues& f, const FieldValues& by_x, const FieldValues& by_y) {
    f.strain_x = by_x.strain;
    f.laplacian_x = by_x.laplacian;
    f.gradient_of_trace_x = by_x.gradient_of_trace;
    f.strain_y = by_y.strain;
    f.laplacian_y = by_y.laplacian;
    f.gradient_of_trace_y = by_y.gradient_of_trace;
}

} // namespace rodwake::elastic
