#include "interaction.hpp"

namespace rodwake::rods {

std::string coupling_names(bool polar) {
    std::string names;
    for (const Coupling& coupling : coupling_list)
        if (coupling.polar == polar)
            names += (names.empty() ? "" : ", ") + std::string(coupling.name);
    return names;
}

Couplings from_divergence_basis(const Couplings& of_divergence) {
    const auto [kappa, gamma1, gamma2] = of_divergence;
    return {kappa, 0.5 * gamma1, gamma2 + 0.5 * gamma1};
}

Couplings from_divergence_basis(double kappa, double gamma1, double gamma2) {
    return from_divergence_basis({kappa, gamma1, gamma2});
}

namespace {

using elastic::SymmetricTensor;
using elastic::Vector;

/// z.[n x eps.n] = eps_xy cos 2phi + (eps_yy - eps_xx)/2 sin 2phi: only the traceless part turns a rod.
double axis_torque(const SymmetricTensor& e, RelativeHeading n) {
    const double cos2 = n.cosine * n.cosine - n.sine * n.sine, sin2 = 2.0 * n.cosine * n.sine;
    return e.xy * cos2 + 0.5 * (e.yy - e.xx) * sin2;
}

double axis_torque_by_phi(const SymmetricTensor& e, RelativeHeading n) {
    const double cos2 = n.cosine * n.cosine - n.sine * n.sine, sin2 = 2.0 * n.cosine * n.sine;
    return (e.yy - e.xx) * cos2 - 2.0 * e.xy * sin2;
}

/// z.[n x v]
double vector_torque(const Vector& v, RelativeHeading n) { return n.cosine * v.y - n.sine * v.x; }

double vector_torque_by_phi(const Vector& v, RelativeHeading n) { return -n.sine * v.y - n.cosine * v.x; }

Vector polar_vector(const Couplings& c, const Vector& laplacian, const Vector& gradient) {
    const auto& [kappa, gamma1, gamma2] = c;
    return {gamma1 * laplacian.x + gamma2 * gradient.x, gamma1 * laplacian.y + gamma2 * gradient.y};
}

} // namespace

elastic::FieldRequest request_of(const Couplings& couplings, bool gradients) {
    return {.strain = couplings.apolar(), .polar = couplings.polar(), .gradients = gradients};
}

double turning_rate(const elastic::FieldValues& f, const Couplings& c, RelativeHeading n) {
    const auto& [kappa, gamma1, gamma2] = c; // the polar ones: polar_vector
    double rate = 0.0;
    if (c.apolar())
        rate += kappa * axis_torque(f.strain, n);
    if (c.polar())
        rate += vector_torque(polar_vector(c, f.laplacian, f.gradient_of_trace), n);
    return rate;
}

Vector drive(const elastic::FieldValues& f, const Couplings& c, Vector n) {
    const auto& [kappa, gamma1, gamma2] = c;
    Vector h{0.0, 0.0};
    if (c.apolar())
        h = {kappa * (f.strain.xx * n.x + f.strain.xy * n.y),
             kappa * (f.strain.xy * n.x + f.strain.yy * n.y)};
    if (c.polar()) {
        const Vector polar = polar_vector(c, f.laplacian, f.gradient_of_trace);
        h = {h.x + polar.x, h.y + polar.y};
    }
    return h;
}

TurningRate turning_rate_derivatives(const elastic::FieldValues& f, const Couplings& c, RelativeHeading n) {
    const auto& [kappa, gamma1, gamma2] = c;
    TurningRate rate{turning_rate(f, c, n), 0.0, 0.0, 0.0};
    if (c.apolar()) {
        rate.by_x += kappa * axis_torque(f.strain_x, n);
        rate.by_y += kappa * axis_torque(f.strain_y, n);
        rate.by_phi += kappa * axis_torque_by_phi(f.strain, n);
    }
    if (c.polar()) {
        rate.by_x += vector_torque(polar_vector(c, f.laplacian_x, f.gradient_of_trace_x), n);
        rate.by_y += vector_torque(polar_vector(c, f.laplacian_y, f.gradient_of_trace_y), n);
        rate.by_phi += vector_torque_by_phi(polar_vector(c, f.laplacian, f.gradient_of_trace), n);
    }
    return rate;
}

} // namespace rodwake::rods
