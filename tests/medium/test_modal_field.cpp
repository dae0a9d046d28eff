// The field of a rod that has always walked straight against the closed form of elastic/periodic.hpp, which
// is of a point force: for w -> 0 they are the same. Away from the rod the difference is a series in w^2, as
// of any smoothing; what the modes leave out is below 1e-12 here, exp(-(pi modes w/box)^2/2) with 2.4 box/w
// modes.

#include "rodwake/core/error.hpp"
#include "rodwake/elastic/periodic.hpp"
#include "rodwake/medium/modal_field.hpp"

#include <catch2/catch.hpp>

#include <array>
#include <cmath>

using namespace rodwake;
using namespace rodwake::medium;

namespace {

constexpr double box = 10.0;
constexpr rods::Pose rod{1.0, -2.0, 0.6};
constexpr elastic::FieldRequest request{.displacement = true, .strain = true, .polar = true};

using Numbers = std::array<double, 9>;

Numbers numbers(const elastic::FieldValues& f) {
    return {f.displacement.x, f.displacement.y, f.strain.xx,           f.strain.xy,          f.strain.yy,
            f.laplacian.x,    f.laplacian.y,    f.gradient_of_trace.x, f.gradient_of_trace.y};
}

/// At (x, y) in the rod's frame, components in the lab frame.
Numbers modal(const elastic::Medium& elastic, double width, elastic::Vector at) {
    DynamicMedium medium{
        .box = box, .force_width = width, .modes = static_cast<std::size_t>(2.4 * box / width) + 1};
    const ModalField modes(elastic, medium);
    std::vector<double> field(4 * modes.size());
    modes.add_steady(rod, field);
    const elastic::Vector d = elastic::turned(at, std::cos(rod.heading), std::sin(rod.heading));
    return numbers(modes.at(rod.x + d.x, rod.y + d.y, request, field));
}

Numbers closed(const elastic::Medium& elastic, elastic::Vector at) {
    elastic::FieldValues f = elastic::PeriodicField(elastic, box, rod.heading).at(at.x, at.y, request);
    const double c = std::cos(rod.heading), s = std::sin(rod.heading);
    f.displacement = turned(f.displacement, c, s);
    f.strain = turned(f.strain, c, s);
    f.laplacian = turned(f.laplacian, c, s);
    f.gradient_of_trace = turned(f.gradient_of_trace, c, s);
    return numbers(f);
}

/// w^2 = first/2^k, k = 0 ... 6, extrapolated to 0 (Neville).
Numbers extrapolated(const elastic::Medium& elastic, double first, elastic::Vector at) {
    constexpr std::size_t levels = 7;
    std::array<Numbers, levels> table;
    for (std::size_t k = 0; k < levels; ++k) {
        table[k] = modal(elastic, std::sqrt(first / static_cast<double>(1u << k)), at);
        for (std::size_t j = k; j-- > 0;)
            for (std::size_t i = 0; i < table[j].size(); ++i)
                table[j][i] = table[j + 1][i] +
                              (table[j + 1][i] - table[j][i]) / (std::exp2(static_cast<double>(k - j)) - 1.0);
    }
    return table[0];
}

} // namespace

TEST_CASE("the steady field of a narrow force is the closed form's to 1e-10 of the largest displacement") {
    for (const elastic::Medium& elastic : {elastic::Medium{1.0, 1.0}, elastic::Medium{0.3, 10.0}}) {
        const double largest = std::abs(closed(elastic, {-0.4, 0.0})[0]); // of what this box resolves
        for (const elastic::Vector at : {elastic::Vector{-4.0, 2.5}, {3.0, 3.5}, {0.5, -4.2}}) {
            const Numbers exact = closed(elastic, at), found = extrapolated(elastic, 0.25, at);
            for (std::size_t i = 0; i < exact.size(); ++i) {
                CAPTURE(elastic.xi, at.x, at.y, i, exact[i]);
                CHECK(std::abs(found[i] - exact[i]) < 1e-10 * largest);
            }
        }
    }
}

TEST_CASE("the error of a force's width is w^2 lap U/2, and of order 4 beside that") {
    const elastic::Medium elastic{1.0, 1.0};
    const elastic::Vector at{-4.0, 2.5};
    const Numbers exact = closed(elastic, at);
    const auto errors = [&](double width) {
        const Numbers found = modal(elastic, width, at);
        const double whole = found[1] - exact[1];
        return std::array{whole, whole - 0.5 * width * width * exact[6]};
    };
    const auto wide = errors(0.4), narrow = errors(0.2);
    CHECK(std::log2(wide[0] / narrow[0]) == Approx(2.0).margin(0.1));
    CHECK(std::log2(wide[1] / narrow[1]) == Approx(4.0).margin(0.1));
}

TEST_CASE("a field's derivatives are those of its displacement") {
    const ModalField modes({1.0, 0.5}, {.box = box, .force_width = 0.6, .modes = 40});
    std::vector<double> field(4 * modes.size()), none(field.size());
    modes.add_steady(rod, field);
    constexpr double h = 1e-3;
    const auto u = [&](double x, double y) { return modes.at(x, y, request, field); };
    const auto here = u(2.0, 1.0), east = u(2.0 + h, 1.0), west = u(2.0 - h, 1.0), north = u(2.0, 1.0 + h),
               south = u(2.0, 1.0 - h);
    constexpr double second_order = 1e-5; // h^2 times a derivative of order 1, over 6
    CHECK(std::abs((east.displacement.x - west.displacement.x) / (2.0 * h) - here.strain.xx) < second_order);
    CHECK(std::abs((north.displacement.y - south.displacement.y) / (2.0 * h) - here.strain.yy) <
          second_order);
    const double xy =
        (east.displacement.y - west.displacement.y + north.displacement.x - south.displacement.x) / (4.0 * h);
    CHECK(std::abs(xy - here.strain.xy) < second_order);
    const auto trace = [](const elastic::FieldValues& f) { return f.strain.xx + f.strain.yy; };
    CHECK(std::abs((trace(east) - trace(west)) / (2.0 * h) - here.gradient_of_trace.x) < second_order);
    CHECK(std::abs((trace(north) - trace(south)) / (2.0 * h) - here.gradient_of_trace.y) < second_order);
    // relative to another field: here to none and to itself
    CHECK(modes.at(2.0, 1.0, request, field, none).laplacian.x == here.laplacian.x);
    CHECK(modes.at(2.0, 1.0, request, field, field).laplacian.x == 0.0);
    CHECK_THROWS_AS(modes.at(0.0, 0.0, {.dipole = true}, field), InputError);
}
