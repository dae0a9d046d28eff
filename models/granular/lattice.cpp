#include "checks.hpp"
#include "fixed_order.hpp"
#include "packing.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace rodwake::granular {

namespace {

using Eigen::Matrix2d;

constexpr double most_sites = 1e9;
constexpr double densest_extra = 0.04; // share of sites beyond those asked for that is searched
constexpr double degree = M_PI / 180.0;
constexpr double cost_of_strain = 0.5; // in the currency of lost spacing
constexpr double cost_of_turn = 0.02;  // the same, of rows turned by one tolerance; grows as the square

/// Spacing of the perfect lattice of the same density.
double perfect_spacing(const PeriodicBox& box, double sites) {
    return box.mean_side() * std::sqrt(2.0 / (std::sqrt(3.0) * sites));
}

/// Columns a1, a2 of the perfect lattice.
Matrix2d perfect_lattice(double spacing, double orientation) {
    const double second = orientation + M_PI / 3.0;
    Matrix2d vectors;
    vectors << direction(orientation), direction(second);
    return spacing * vectors;
}

/// The lattice with these box edges; its vectors are the columns of box N^-1, N = (m1 m2; n1 n2).
LatticeFit measured(int m1, int n1, int m2, int n2, const PeriodicBox& box) {
    LatticeFit fit{m1, n1, m2, n2};
    fit.sites = static_cast<long>(m1) * n2 - static_cast<long>(m2) * n1;
    Matrix2d lattice;
    lattice << n2, -m2, -n1, m1;
    lattice.row(0) *= box.x / static_cast<double>(fit.sites);
    lattice.row(1) *= box.y / static_cast<double>(fit.sites);
    fit.orientation = repeatable::atan2(lattice(1, 0), lattice(0, 0));
    fit.spacing = std::numeric_limits<double>::infinity();
    for (int i = -3; i <= 3; ++i)
        for (int j = -3; j <= 3; ++j)
            if (i != 0 || j != 0)
                fit.spacing = std::min(fit.spacing, product(lattice, Eigen::Vector2d(i, j)).norm());
    const Matrix2d perfect =
        perfect_lattice(perfect_spacing(box, static_cast<double>(fit.sites)), fit.orientation);
    // The larger singular value is half of the sum s1 + s2 and of the difference s1 - s2, neither of which
    // cancels.
    const Matrix2d stretch = product(lattice, Matrix2d(perfect.inverse()));
    fit.strain = 0.5 * (repeatable::length(stretch(0, 0) + stretch(1, 1), stretch(1, 0) - stretch(0, 1)) +
                        repeatable::length(stretch(0, 0) - stretch(1, 1), stretch(1, 0) + stretch(0, 1))) -
                 1.0;
    return fit;
}

long positive_remainder(long number, long divisor) {
    const long rest = number % divisor;
    return rest < 0 ? rest + divisor : rest;
}

} // namespace

LatticeFit fit_lattice(const PeriodicBox& box, long sites, double orientation) {
    Checks checks;
    checks.sides(box);
    checks.number(true, "orientation", orientation, "finite (rad)");
    checks.require(sites >= 1 && static_cast<double>(sites) <= most_sites,
                   fmt::format("sites = {}: must be 1 to {:g}", sites, most_sites));
    checks.finish();
    const double wanted = static_cast<double>(sites), root = std::sqrt(wanted);
    const double most = wanted * (1.0 + densest_extra) + 2.0 * root + 2.0; // small boxes: a few more rows
    const double wanted_orientation = std::remainder(orientation, 2.0 * M_PI),
                 perfect = perfect_spacing(box, wanted);
    LatticeFit best{};
    double best_cost = std::numeric_limits<double>::infinity();
    const auto low = [](double x) { return static_cast<int>(std::floor(x)) - 1; };
    const int densities = 8 + static_cast<int>(2.0 * (std::sqrt(most) - root)); // edges move by half a step
    for (int step = 0; step <= densities; ++step) {
        // All integer box edges next to those of the perfect lattice of this density.
        const double density = wanted + (most - wanted) * step / densities;
        Matrix2d edges = perfect_lattice(perfect_spacing(box, density), wanted_orientation).inverse();
        edges.col(0) *= box.x;
        edges.col(1) *= box.y;
        for (int k = 0; k < 256; ++k) { // four choices for each of the four
            const int m1 = low(edges(0, 0)) + (k & 3), n1 = low(edges(1, 0)) + (k >> 2 & 3),
                      m2 = low(edges(0, 1)) + (k >> 4 & 3), n2 = low(edges(1, 1)) + (k >> 6 & 3);
            const long found = static_cast<long>(m1) * n2 - static_cast<long>(m2) * n1;
            if (found < sites || found > static_cast<long>(most))
                continue;
            // Strain and sites in excess both bring neighbours closer, so lost spacing weighs them; of those
            // equal in it the less strained is better. Rows may turn by a degree, in small boxes by half a
            // spacing in the box.
            const LatticeFit fit = measured(m1, n1, m2, n2, box);
            const double turned = std::remainder(fit.orientation - wanted_orientation, 2.0 * M_PI),
                         turns = turned / std::max(degree, 0.5 * perfect / box.mean_side());
            const double cost =
                1.0 - fit.spacing / perfect + cost_of_strain * fit.strain + cost_of_turn * turns * turns;
            if (cost < best_cost - 1e-12) { // a tie: the first, on every machine
                best = fit;
                best_cost = cost;
            }
        }
    }
    return best;
}

double LatticeBox::row_ratio() const {
    const double along = rows_along_y ? box.y : box.x, across = rows_along_y ? box.x : box.y;
    return across / static_cast<double>(rows) / (along / static_cast<double>(in_row));
}

LatticeBox with_area(LatticeBox shape, double area) {
    const double ratio =
        std::sqrt(0.75) * static_cast<double>(shape.rows) / static_cast<double>(shape.in_row);
    const double along = std::sqrt(area / ratio), across = area / along;
    shape.box = shape.rows_along_y ? PeriodicBox(across, along) : PeriodicBox(along, across);
    return shape;
}

LatticeBox lattice_box(double sites, long least, double orientation) {
    const double sixths = orientation / (30.0 * degree), nearest = std::round(sixths);
    Checks checks;
    checks.require(
        sites >= 4.0 && sites <= most_sites,
        fmt::format("a lattice of {:.4g} sites to fit a box to: must be 4 to {:g}", sites, most_sites));
    checks.require(
        std::abs(sixths - nearest) < 1e-9,
        fmt::format("orientation = {} rad with box = \"fit\": a lattice without strain closes in a "
                    "rectangle only if its rows lie along a side; give 0 or 90 deg",
                    orientation));
    checks.finish();
    LatticeBox best;
    double best_cost = std::numeric_limits<double>::infinity();
    const long in_row = std::lround(std::sqrt(sites * std::sqrt(0.75)));
    const long pairs = std::lround(std::sqrt(sites / std::sqrt(0.75)) / 2.0);
    for (long i = std::max(in_row - 2, 1L); i <= in_row + 2; ++i)
        for (long j = std::max(pairs - 1, 1L); j <= pairs + 1; ++j) {
            const double found = static_cast<double>(i * 2 * j),
                         ratio = std::sqrt(0.75) * static_cast<double>(2 * j) / static_cast<double>(i),
                         cost = std::abs(repeatable::log(ratio)) + std::abs(repeatable::log(found / sites));
            if (i * 2 * j < least || !(cost < best_cost - 1e-12))
                continue;
            best.in_row = i;
            best.rows = 2 * j;
            best_cost = cost;
        }
    best.rows_along_y = std::lround(nearest) % 2 != 0;
    return with_area(best, 1.0);
}

std::vector<Eigen::Vector2d> lattice_sites(const LatticeFit& fit, const PeriodicBox& box) {
    const long sites = fit.sites, rows = std::gcd(fit.n1, fit.n2), row = sites / rows;
    const double scale_x = box.x / static_cast<double>(sites), scale_y = box.y / static_cast<double>(sites);
    std::vector<Eigen::Vector2d> places;
    places.reserve(static_cast<std::size_t>(sites));
    for (long j = 0; j < rows; ++j)
        for (long i = 0; i < row; ++i) // integer coordinates, so no site is lost or doubled at the edge
            places.emplace_back(
                static_cast<double>(positive_remainder(fit.n2 * i - fit.m2 * j, sites)) * scale_x,
                static_cast<double>(positive_remainder(fit.m1 * j - fit.n1 * i, sites)) * scale_y);
    return places;
}

} // namespace rodwake::granular
