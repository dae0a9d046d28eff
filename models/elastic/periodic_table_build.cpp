// How the table of the periodic field is made and judged.

#include "periodic_impl.hpp"
#include "periodic_table_impl.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/parallel.hpp"
#include "rodwake/core/rng.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <sstream>

namespace rodwake::elastic {

namespace {

constexpr FieldRequest everything{true, true, true, true, false};

/// Of each group: displacement, strain, polar vectors, dipole.
constexpr std::size_t functions[] = {2, 3, 4, 2};
/// What a cell of all groups takes, 11 functions.
constexpr std::size_t cell_bytes = 11 * cell_nodes * sizeof(double);

/// Its coefficients are moved out of the data.
ChebyshevGrid read_grid(PeriodicTableData& data, std::size_t group) {
    if (data.place_pieces < 1 || data.angle_pieces < 1)
        throw InputError("table of the periodic field: it has no pieces");
    const Pieces pieces{static_cast<std::size_t>(data.place_pieces),
                        static_cast<std::size_t>(data.angle_pieces)};
    return {pieces, functions[group], std::move(data.coefficients[group])};
}

std::array<double, 5> sizes(const FieldValues& f) {
    const auto& e = f.strain;
    return {std::hypot(f.displacement.x, f.displacement.y),
            std::sqrt(e.xx * e.xx + 2.0 * e.xy * e.xy + e.yy * e.yy),
            std::hypot(f.laplacian.x, f.laplacian.y),
            std::hypot(f.gradient_of_trace.x, f.gradient_of_trace.y), std::hypot(f.dipole.x, f.dipole.y)};
}

/// A NaN is the largest of all, which std::max would lose.
double larger(double worst, double error) {
    return std::isnan(error) ? std::numeric_limits<double>::infinity() : std::max(worst, error);
}

[[noreturn]] void out_of_reach(double box, double tolerance) {
    std::ostringstream message;
    message << "box = " << box << ": a table of the periodic field with the tolerance " << tolerance
            << " would take more than " << PeriodicTable::memory_limit / 1'000'000
            << " MB; raise the tolerance, or use the field itself";
    throw InputError(message.str());
}

} // namespace

/// All places at one of the headings' nodes.
void PeriodicTable::Impl::fill(const Pieces& pieces, std::size_t angle) {
    const std::size_t piece = angle / angle_nodes, k = angle % angle_nodes;
    const double heading = 0.25 * std::numbers::pi * chebyshev_node(piece, pieces.angle, k, angle_nodes);
    const PeriodicField exact(medium, box, heading);
    const double cosine = std::cos(heading), sine = std::sin(heading);
    const std::size_t lines = pieces.place * place_nodes;
    for (std::size_t b = 0; b < lines; ++b)
        for (std::size_t a = 0; a < lines; ++a) {
            const auto index = [&](std::size_t n) {
                return chebyshev_node(n / place_nodes, pieces.place, n % place_nodes, place_nodes) - 0.5;
            };
            const FieldValues f =
                turned(PeriodicInternals::smooth_rest(exact, index(a), index(b), everything), cosine, sine);
            const ChebyshevGrid::ChebyshevNode node{b / place_nodes, a / place_nodes, piece,
                                                    b % place_nodes, a % place_nodes, k};
            const auto set = [&](std::size_t group, std::initializer_list<double> v) {
                std::copy(v.begin(), v.end(), groups[group].values(node));
            };
            set(0, {f.displacement.x, f.displacement.y});
            set(1, {f.strain.xx, f.strain.xy, f.strain.yy});
            set(2, {f.laplacian.x, f.laplacian.y, f.gradient_of_trace.x, f.gradient_of_trace.y});
            set(3, {f.dipole.x, f.dipole.y});
        }
}

PeriodicTable::Impl::Impl(const Medium& m, double side, const Pieces& pieces, std::size_t threads)
    : medium(m), box(side),
      field(m), groups{ChebyshevGrid(pieces, functions[0]), ChebyshevGrid(pieces, functions[1]),
                       ChebyshevGrid(pieces, functions[2]), ChebyshevGrid(pieces, functions[3])} {
    parallel_for(pieces.angle * angle_nodes, threads, [&](std::size_t angle) { fill(pieces, angle); });
    parallel_for(pieces.cells(), threads, [&](std::size_t cell) {
        for (ChebyshevGrid& group : groups)
            group.transform(cell);
    });
    for (ChebyshevGrid& group : groups)
        group.set_centre();
}

PeriodicTable::Impl::Impl(PeriodicTableData data)
    : medium{data.eta, data.xi}, box(data.box),
      field(medium), groups{read_grid(data, 0), read_grid(data, 1), read_grid(data, 2), read_grid(data, 3)},
      tolerance(data.tolerance), error(data.error) {}

PeriodicTable::PeriodicTable(PeriodicTableData data) : impl_(std::make_shared<const Impl>(std::move(data))) {
    const PeriodicField checked(impl_->medium, impl_->box); // throws for an illegal medium or box
}

PeriodicTableData PeriodicTable::data() const {
    const Pieces& pieces = impl_->groups[0].pieces();
    PeriodicTableData data{impl_->medium.eta,
                           impl_->medium.xi,
                           impl_->box,
                           impl_->tolerance,
                           impl_->error,
                           static_cast<std::int32_t>(pieces.place),
                           static_cast<std::int32_t>(pieces.angle),
                           {}};
    for (std::size_t g = 0; g < data.coefficients.size(); ++g)
        data.coefficients[g] = impl_->groups[g].coefficients();
    return data;
}

double PeriodicTable::Impl::error_at(const PeriodicField& exact, Vector lab) const {
    const double cosine = std::cos(exact.heading()), sine = std::sin(exact.heading());
    const Vector position = turned(lab, cosine, -sine);
    FieldValues f = turned(exact.at(position.x, position.y, everything), cosine, sine);
    add_times(f, -1.0, at({0.0, 0.0, exact.heading()}, lab.x, lab.y, everything));

    // Over the largest values at the same distance.
    const double r = std::hypot(lab.x, lab.y);
    std::array<double, 5> scale{};
    for (int k = 0; k < 12; ++k) {
        const double angle = std::numbers::pi * k / 6.0;
        const auto size = sizes(exact.at(r * std::cos(angle), r * std::sin(angle), everything));
        for (std::size_t q = 0; q < size.size(); ++q)
            scale[q] = std::max(scale[q], size[q]);
    }
    const auto off = sizes(f);
    double worst = 0.0;
    for (std::size_t q = 0; q < off.size(); ++q)
        worst = larger(worst, off[q] / scale[q]);
    return worst;
}

double PeriodicTable::Impl::measured_error() const {
    RandomStream random(1);
    double worst = 0.0;
    for (int h = 0; h < 40; ++h) {
        const PeriodicField exact(medium, box, random.uniform(-std::numbers::pi, std::numbers::pi));
        for (int n = 0; n < 16; ++n) {
            const double x = random.uniform(-0.5, 0.5), y = random.uniform(-0.5, 0.5);
            worst = larger(worst, error_at(exact, {x * box, y * box}));
        }
    }
    return worst;
}

PeriodicTable::PeriodicTable(const Medium& medium, double box, double tolerance, std::size_t threads) {
    const PeriodicField checked(medium, box); // throws for an illegal medium or box
    if (!(tolerance >= smallest_tolerance && tolerance <= largest_tolerance))
        throw InputError("tolerance of a table of the periodic field: from 1e-10 to 1e-3");

    // A wave of the box answers to the heading over an angle of pi/c, a wake is 1/sqrt(c) wide: as many
    // pieces as keep the error at 1e-8 (bench/periodic_bench.cpp), and as its order says for another
    // tolerance.
    const double c = 0.5 * box / medium.xi * std::max(1.0, medium.nu()),
                 decades = -std::log(tolerance / 1e-8);
    const auto count = [&](double n, std::size_t order) {
        return static_cast<std::size_t>(std::ceil(n * std::exp(decades / static_cast<double>(order))));
    };
    Pieces pieces{count(std::max(7.0, 1.2 + 2.15 * std::sqrt(c)), place_nodes),
                  count(0.3 + 0.3 * c, angle_nodes)};
    for (int attempt = 0; attempt < 4; ++attempt) {
        if (pieces.cells() > memory_limit / cell_bytes)
            out_of_reach(box, tolerance);
        auto made = std::make_shared<Impl>(medium, box, pieces, threads);
        made->tolerance = tolerance;
        made->error = made->measured_error();
        impl_ = made;
        if (made->error <= tolerance)
            return;
        pieces = {pieces.place + 1 + pieces.place / 4, pieces.angle + 1 + pieces.angle / 4};
    }
    out_of_reach(box, tolerance);
}

} // namespace rodwake::elastic
