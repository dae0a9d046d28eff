// The quantities that are compared, from the oracle and from the field under test.

#include "oracle.hpp"

namespace rodwake::oracle {

namespace {

// Derivative i, j of one quantity; the gradients are i, j = 1, 0 and 0, 1 of the quantities themselves.

std::vector<Real> strain(const Field& f, int i, int j) {
    const Real xy = (f.ux(i, j + 1) + f.uy(i + 1, j)) / 2;
    return {f.ux(i + 1, j), xy, xy, f.uy(i, j + 1)};
}

std::vector<Real> laplacian(const Field& f, int i, int j) {
    return {f.ux(i + 2, j) + f.ux(i, j + 2), f.uy(i + 2, j) + f.uy(i, j + 2)};
}

std::vector<Real> gradient_of_trace(const Field& f, int i, int j) {
    return {f.trace(i + 1, j), f.trace(i, j + 1)};
}

template<class Part>
std::vector<Real> gradients(Part part, const Field& f) {
    std::vector<Real> both = part(f, 1, 0);
    for (const Real& value : part(f, 0, 1))
        both.push_back(value);
    return both;
}

std::vector<double> list(const elastic::Vector& v) { return {v.x, v.y}; }
std::vector<double> list(const elastic::SymmetricTensor& t) { return {t.xx, t.xy, t.xy, t.yy}; }

template<class Part>
std::vector<double> list(const Part& d_x, const Part& d_y) {
    std::vector<double> both = list(d_x);
    for (const double value : list(d_y))
        both.push_back(value);
    return both;
}

} // namespace

std::string name(Quantity q) {
    constexpr const char* names[] = {"displacement",        "strain",         "laplacian",
                                     "gradient of trace",   "dipole",         "strain gradients",
                                     "laplacian gradients", "trace gradients"};
    return names[static_cast<int>(q)];
}

std::vector<Real> components(const Field& f, Quantity q) {
    switch (q) {
    case Quantity::displacement:
        return {f.ux(0, 0), f.uy(0, 0)};
    case Quantity::strain:
        return strain(f, 0, 0);
    case Quantity::laplacian:
        return laplacian(f, 0, 0);
    case Quantity::gradient_of_trace:
        return gradient_of_trace(f, 0, 0);
    case Quantity::dipole: // V(y - d/2) - V(y + d/2) over d
        return {-f.vx(0, 1), -f.vy(0, 1)};
    case Quantity::strain_gradients:
        return gradients(strain, f);
    case Quantity::laplacian_gradients:
        return gradients(laplacian, f);
    default:
        return gradients(gradient_of_trace, f);
    }
}

std::vector<double> components(const elastic::FieldValues& f, Quantity q) {
    switch (q) {
    case Quantity::displacement:
        return list(f.displacement);
    case Quantity::strain:
        return list(f.strain);
    case Quantity::laplacian:
        return list(f.laplacian);
    case Quantity::gradient_of_trace:
        return list(f.gradient_of_trace);
    case Quantity::dipole:
        return list(f.dipole);
    case Quantity::strain_gradients:
        return list(f.strain_x, f.strain_y);
    case Quantity::laplacian_gradients:
        return list(f.laplacian_x, f.laplacian_y);
    default:
        return list(f.gradient_of_trace_x, f.gradient_of_trace_y);
    }
}

} // namespace rodwake::oracle
