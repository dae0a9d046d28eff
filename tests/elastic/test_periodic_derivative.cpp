// Derivatives of the periodic field by eta and xi.

#include "periodic_cases.hpp"
#include "stencil.hpp"

#include "rodwake/core/rng.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

using namespace rodwake;
using namespace rodwake::oracle;
using elastic::FieldValues;
using elastic::Medium;
using elastic::PeriodicField;

namespace {

/// Each number by difference quotients over a relative step of 1/50.
FieldValues by_differences(const BoxPoint& p, double Medium::*parameter) {
    const Medium medium{.eta = p.eta, .xi = p.xi};
    const double step = 0.02 * medium.*parameter;
    const auto slope = [&](auto part) {
        return difference_quotient(
            [&](double h) {
                Medium changed = medium;
                changed.*parameter += h;
                return part(PeriodicField(changed, p.box, p.heading).at(p.x, p.y, plain));
            },
            step);
    };
    FieldValues d;
    d.displacement = {slope([](const auto& f) { return f.displacement.x; }),
                      slope([](const auto& f) { return f.displacement.y; })};
    d.strain = {slope([](const auto& f) { return f.strain.xx; }),
                slope([](const auto& f) { return f.strain.xy; }),
                slope([](const auto& f) { return f.strain.yy; })};
    d.laplacian = {slope([](const auto& f) { return f.laplacian.x; }),
                   slope([](const auto& f) { return f.laplacian.y; })};
    d.gradient_of_trace = {slope([](const auto& f) { return f.gradient_of_trace.x; }),
                           slope([](const auto& f) { return f.gradient_of_trace.y; })};
    d.dipole = {slope([](const auto& f) { return f.dipole.x; }),
                slope([](const auto& f) { return f.dipole.y; })};
    return d;
}

/// The field itself over the parameter counts as much as its derivative: a fit's relative steps see no less.
Norms scale_of(const FieldValues& derivative, const FieldValues& field, double parameter) {
    Norms scale = norms(derivative);
    const Norms whole = norms(field);
    for (std::size_t q = 0; q < scale.size(); ++q)
        scale[q] += 0.01 * whole[q] / parameter;
    return scale;
}

} // namespace

TEST_CASE("derivatives of the periodic field by the medium are those of differences") {
    RandomStream random(91);
    constexpr double headings[] = {0.0, 0.3, std::numbers::pi / 4, 1.2, std::numbers::pi / 2, 3.0};
    for (int k = 0; k < 72; ++k) {
        const double ratio = random.log_uniform(0.02, 200.0), eta = random.log_uniform(0.1, 30.0);
        const double r = random.uniform(0.02, 0.6), angle = random.uniform(-3.0, 3.0);
        const BoxPoint p{
            2.0 * r * std::cos(angle), 2.0 * r * std::sin(angle), 2.0 / ratio, eta, 2.0, headings[k % 6]};
        const PeriodicField field({.eta = eta, .xi = p.xi}, p.box, p.heading);
        const FieldValues f = field.at(p.x, p.y, plain);
        const elastic::MediumDerivatives d = field.medium_derivatives(p.x, p.y, plain);
        const FieldValues eta_slope = by_differences(p, &Medium::eta),
                          xi_slope = by_differences(p, &Medium::xi);
        CAPTURE(k, ratio, eta, p.heading, r, angle);
        CHECK(worst(distances(d.by_eta, eta_slope), scale_of(eta_slope, f, eta)) <
              1e-6); // of the differences
        CHECK(worst(distances(d.by_xi, xi_slope), scale_of(xi_slope, f, p.xi)) < 1e-6);
        FieldValues wrong = d.by_xi;
        wrong.strain.xx += 1e-4 * norms(f)[1] / p.xi;
        CHECK(worst(distances(wrong, xi_slope), scale_of(xi_slope, f, p.xi)) > 1e-6);
    }
}

TEST_CASE("only the wanted derivatives of the periodic field are made") {
    const PeriodicField field({}, 2.0, 0.3);
    for (const double x : {0.2, 0.8}) {
        const elastic::MediumDerivatives all = field.medium_derivatives(x, 0.1, plain),
                                         one = field.medium_derivatives(x, 0.1, {.displacement = true});
        CHECK(one.by_xi.displacement.x == all.by_xi.displacement.x);
        CHECK(one.by_eta.displacement.y == all.by_eta.displacement.y);
        CHECK(std::isnan(norms(one.by_xi)[1]));
        CHECK(std::isnan(norms(one.by_eta)[4]));
        CHECK(field.at(x, 0.1, {.displacement = true}).displacement.x ==
              field.at(x, 0.1, plain).displacement.x);
    }
}
