// A field of data: what is sampled comes back, smooth and continuous into theory, in every domain.

#include "measured_samples.hpp"

#include "rodwake/core/error.hpp"

#include <catch2/catch.hpp>

#include <vector>

using namespace rodwake;
using namespace measured_samples;

namespace {

constexpr FieldRequest everything{.displacement = true, .strain = true, .polar = true, .gradients = true};

/// All numbers but the dipole.
std::vector<double> numbers(const FieldValues& f) {
    std::vector<double> all;
    for (const Vector& v : {f.displacement, f.laplacian, f.gradient_of_trace, f.laplacian_x, f.laplacian_y,
                            f.gradient_of_trace_x, f.gradient_of_trace_y})
        all.insert(all.end(), {v.x, v.y});
    for (const SymmetricTensor& t : {f.strain, f.strain_x, f.strain_y})
        all.insert(all.end(), {t.xx, t.xy, t.yy});
    return all;
}

double largest_difference(const FieldValues& a, const FieldValues& b) {
    const auto x = numbers(a), y = numbers(b);
    double largest = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i)
        largest = std::max(largest, std::abs(x[i] - y[i]));
    return largest;
}

/// Largest error of strain over largest strain on the circle.
double strain_error_on_circle(const Wake& wake, const Wake& exact, double r) {
    double error = 0.0, size = 0.0;
    for (double angle = 0.0; angle < 6.2; angle += 0.1) {
        const double x = r * std::cos(angle), y = r * std::sin(angle);
        const SymmetricTensor a = wake.at(x, y, {.strain = true}).strain,
                              b = exact.at(x, y, {.strain = true}).strain;
        error = std::max({error, std::abs(a.xx - b.xx), std::abs(a.xy - b.xy), std::abs(a.yy - b.yy)});
        size = std::max({size, std::abs(b.xx), std::abs(b.xy), std::abs(b.yy)});
    }
    return error / size;
}

/// In the core, where both are mixed, where data alone count, at the edge, beyond it.
constexpr Vector places[] = {{1.2, 0.5}, {2.5, 1.3},    {-3.0, 1.0}, {5.0, -4.0}, {-6.5, 2.0},
                             {9.6, 3.0}, {-2.0, -10.2}, {10.1, 9.9}, {11.5, 1.0}};

const MeasuredDisplacement& rough() {
    static const MeasuredDisplacement measured(sampled(24, 0.02, true), theory, options(0.1));
    return measured;
}

} // namespace

TEST_CASE("what was sampled of an exact field comes back") {
    const auto exact = exact_field(truth, box)->wake(0.0), wrong = exact_field(theory, box)->wake(0.0);
    const auto coarse =
        MeasuredDisplacement(sampled(24, 1e-6, false), theory, options()).field(box)->wake(0.0);
    const auto fine = MeasuredDisplacement(sampled(48, 1e-6, false), theory, options()).field(box)->wake(0.0);
    for (const double r : {4.5, 6.0, 8.0}) {
        CHECK(strain_error_on_circle(*wrong, *exact, r) > 0.1); // theory alone is another field
        // knots are 1 apart and the field varies over r: less than (1/r)^4 of it
        CHECK(strain_error_on_circle(*fine, *exact, r) < 3e-3);
        CHECK(strain_error_on_circle(*coarse, *exact, r) < 5e-2);
    }
    CHECK(strain_error_on_circle(*fine, *exact, 4.5) < 0.5 * strain_error_on_circle(*coarse, *exact, 4.5));
}

TEST_CASE("strain, polar vectors and gradients of a measured field are its derivatives") {
    for (const auto& [of_box, heading] : {std::pair<std::optional<double>, double>{{}, 0.0}, {box, 0.7}}) {
        const auto wake = rough().field(of_box)->wake(heading);
        for (const Vector p : places) {
            const double h = 1e-4;
            const FieldValues f = wake->at(p.x, p.y, everything);
            const FieldValues e = wake->at(p.x + h, p.y, everything), w = wake->at(p.x - h, p.y, everything);
            const FieldValues n = wake->at(p.x, p.y + h, everything), s = wake->at(p.x, p.y - h, everything);
            const auto by = [h](double plus, double minus) { return (plus - minus) / (2.0 * h); };
            // truncation h^2/6 times third derivatives (of order 10 at (1.2, 0.5)), rounding 1e-16/h
            const auto close = [](double value) { return Approx(value).epsilon(1e-5).margin(1e-6); };
            CHECK(f.strain.xx == close(by(e.displacement.x, w.displacement.x)));
            CHECK(f.strain.yy == close(by(n.displacement.y, s.displacement.y)));
            CHECK(2.0 * f.strain.xy ==
                  close(by(n.displacement.x, s.displacement.x) + by(e.displacement.y, w.displacement.y)));
            CHECK(f.strain_x.xy == close(by(e.strain.xy, w.strain.xy)));
            CHECK(f.strain_y.xx == close(by(n.strain.xx, s.strain.xx)));
            CHECK(f.gradient_of_trace.x == close(f.strain_x.xx + f.strain_x.yy));
            CHECK(f.laplacian.y == close(2.0 * f.strain_x.xy - f.strain_y.xx + f.strain_y.yy));
            CHECK(f.laplacian_x.x == close(by(e.laplacian.x, w.laplacian.x)));
            CHECK(f.laplacian_y.y == close(by(n.laplacian.y, s.laplacian.y)));
            CHECK(f.gradient_of_trace_y.x == close(by(n.gradient_of_trace.x, s.gradient_of_trace.x)));
        }
    }
}

TEST_CASE("a measured field goes over into theory without a step in any derivative") {
    const auto field = rough().field(), outside = exact_field(theory);
    const auto wake = field->wake(0.0), alone = outside->wake(0.0);
    CHECK(numbers(wake->at(11.2, 3.0, everything)) == numbers(alone->at(11.2, 3.0, everything)));
    CHECK(numbers(wake->at(1.2, 1.0, everything)) == numbers(alone->at(1.2, 1.0, everything)));
    CHECK(largest_difference(wake->at(6.0, 3.0, everything), alone->at(6.0, 3.0, everything)) > 1e-3);
    const double step = 1e-7; // fields change by that times their derivatives, of order 10
    for (const double at : {edge, edge - blend})
        for (const double y : {1.0, -8.5, 10.0})
            CHECK(largest_difference(wake->at(at - step, y, everything), wake->at(at + step, y, everything)) <
                  1e-5);
    for (const double r : {core, core + blend})
        for (const double angle : {0.3, 2.0, 4.5}) {
            const double c = std::cos(angle), s = std::sin(angle);
            CHECK(largest_difference(wake->at((r - step) * c, (r - step) * s, everything),
                                     wake->at((r + step) * c, (r + step) * s, everything)) < 1e-4);
        }
}

TEST_CASE("a measured field in a box has images and turns with its rod") {
    const double heading = 0.6, h = 1e-5;
    const auto field = rough().field(box);
    const auto wake = field->wake(heading), ahead = field->wake(heading + h),
               before = field->wake(heading - h);
    const Vector side = turned(Vector{box, -box}, std::cos(heading), -std::sin(heading));
    for (const Vector p : places) {
        const FieldValues here = wake->at(p.x, p.y, everything);
        CHECK(largest_difference(here, wake->at(p.x + side.x, p.y + side.y, everything)) <
              1e-9); // rounding of the exact field's images
        const Vector q{p.x + side.x, p.y + side.y};
        const FieldValues change = wake->heading_derivative(q.x, q.y, {.strain = true, .polar = true});
        const auto a = ahead->at(q.x, q.y, everything), b = before->at(q.x, q.y, everything);
        const auto close = [](double value) { return Approx(value).epsilon(1e-5).margin(1e-5); };
        CHECK(change.strain.xy == close((a.strain.xy - b.strain.xy) / (2.0 * h)));
        CHECK(change.laplacian.x == close((a.laplacian.x - b.laplacian.x) / (2.0 * h)));
    }
    CHECK_THROWS_WITH(rough().field(1.4 * edge), Catch::Contains("would meet its own image"));
    CHECK_NOTHROW(rough().field(1.5 * edge));
}

TEST_CASE("sums over rods in a measured field are sums of their wakes") {
    const std::vector<Source> rods = {{0.0, 0.0, 0.3}, {5.0, 2.0, 2.0}, {-3.0, 11.0, -1.0}};
    for (const std::optional<double> of_box : {std::optional<double>{}, std::optional(box)}) {
        const auto field = rough().field(of_box);
        std::vector<FieldValues> sums(3), one_by_one(3);
        field->mutual(rods, {.strain = true, .polar = true}, sums);
        field->WakeField::mutual(rods, {.strain = true, .polar = true}, one_by_one);
        for (std::size_t a = 0; a < rods.size(); ++a) {
            CHECK(sums[a].strain.xy ==
                  Approx(one_by_one[a].strain.xy).epsilon(1e-11)); // another order of sums
            CHECK(sums[a].laplacian.x == Approx(one_by_one[a].laplacian.x).epsilon(1e-11));
        }
    }
}

TEST_CASE("a measured field says what it cannot do, and refuses what is no field") {
    const auto field = rough().field();
    CHECK(field->capabilities().gradients);
    CHECK_FALSE(field->capabilities().dipole);
    CHECK_THROWS_AS(field->wake(0.0)->at(1.0, 1.0, {.dipole = true}), InputError);
    CHECK_THROWS_AS(field->wake(0.0)->medium_derivatives(1.0, 1.0, {.strain = true}), InputError);
    CHECK_THROWS_AS(field->wake(0.0)->at(0.0, 0.0, {.strain = true}), InputError);
    const MeasuredGrid good = sampled(16, 0.1, false);
    const auto refuses = [&](auto spoil, const std::string& words) {
        MeasuredGrid grid = good;
        MeasuredOptions chosen = options(1.0);
        spoil(grid, chosen);
        CHECK_THROWS_WITH(MeasuredDisplacement(grid, theory, chosen), Catch::Contains(words));
    };
    refuses([](auto& g, auto&) { g.Ux.pop_back(); }, "255 values for 256 bins");
    refuses([](auto& g, auto&) { g.known.clear(); }, "0 marks");
    refuses([](auto& g, auto&) { g.sigma_y[7] = 0.0; }, "sigma of bin 7");
    refuses([](auto& g, auto&) { g.sigma_y[7] = std::nan(""); }, "sigma of bin 7");
    refuses([](auto& g, auto&) { g.n = 15; }, "15 bins a side");
    refuses([](auto&, auto& o) { o.edge = 11.0; }, "at most 10.5, where the measured field ends");
    refuses([](auto&, auto& o) { o.core = 7.0; }, "core = 7, blend = 2");
    refuses([](auto&, auto& o) { o.core = 0.0; }, "must be above 0");
    refuses([](auto& g, auto& o) { o.blend = 1.9 * g.spacing; }, "at least two bins");
    refuses(
        [](auto& g, auto& o) {
            o.blend = 3.0;
            o.correlation = 0.51 * g.box();
        },
        "at most half the box");
    refuses(
        [](auto& g, auto& o) {
            o.blend = 3.0;
            o.window = 0.51 * g.box();
        },
        "at most half the box");
}

// --- How a measured field is smoothed, and what its errors make of it

namespace {

constexpr Vector place{5.0, 3.0};

double strain_at(const WakeField& field, Vector p = place) {
    return field.wake(0.0)->at(p.x, p.y, {.strain = true}).strain.xx;
}

double deviation(const std::vector<double>& values) {
    double mean = 0.0, square = 0.0;
    for (const double v : values)
        mean += v / static_cast<double>(values.size());
    for (const double v : values)
        square += (v - mean) * (v - mean);
    return std::sqrt(square / static_cast<double>(values.size() - 1));
}

std::vector<double> draws(const MeasuredDisplacement& measured, std::uint32_t count, std::uint64_t seed = 5) {
    std::vector<double> values;
    for (std::uint32_t k = 0; k < count; ++k)
        values.push_back(strain_at(*measured.drawn(seed, k)));
    return values;
}

/// Root mean square of exx - exact between 4 and 9 from the rod.
double strain_error(const MeasuredDisplacement& measured) {
    const auto wake = measured.field(box)->wake(0.0), exact = exact_field(truth, box)->wake(0.0);
    double square = 0.0, count = 0.0;
    for (double r = 4.5; r < 9.0; r += 1.0)
        for (double angle = 0.1; angle < 6.2; angle += 0.3, count += 1.0) {
            const double x = r * std::cos(angle), y = r * std::sin(angle);
            const double off =
                wake->at(x, y, {.strain = true}).strain.xx - exact->at(x, y, {.strain = true}).strain.xx;
            square += off * off;
        }
    return std::sqrt(square / count);
}

/// Errors that are means over a window of radius R, as rodwake measure makes them.
MeasuredGrid with_correlated_errors(std::size_t n, double sigma, double R) {
    MeasuredGrid grid = sampled(n, sigma, false);
    const auto side = static_cast<long>(n), reach = static_cast<long>(R / grid.spacing);
    RandomStream random(11);
    for (auto* U : {&grid.Ux, &grid.Uy}) {
        std::vector<double> white(n * n);
        for (double& z : white)
            z = normal(random);
        for (long row = 0; row < side; ++row)
            for (long column = 0; column < side; ++column) {
                double sum = 0.0, square = 0.0;
                for (long j = -reach; j <= reach; ++j)
                    for (long i = -reach; i <= reach; ++i) {
                        const double r = std::hypot(i, j) * grid.spacing / R;
                        const double weight = std::max(0.0, 1.0 - r * r);
                        sum += weight * white[static_cast<std::size_t>((row + j + side) % side * side +
                                                                       (column + i + side) % side)];
                        square += weight * weight;
                    }
                (*U)[static_cast<std::size_t>(row * side + column)] += sigma * sum / std::sqrt(square);
            }
    }
    return grid;
}

} // namespace

TEST_CASE("cross-validation smooths as much as the errors ask for") {
    double before = 0.0;
    for (const double sigma : {1e-3, 1e-2, 1e-1}) {
        const MeasuredGrid grid = sampled(32, sigma, true);
        const MeasuredDisplacement chosen(grid, theory, options());
        const SmoothingReport& x = chosen.report_x();
        CHECK(x.lambda > 3.0 * before); // more with larger errors
        before = x.lambda;
        // chi2 of points - tr(H), to 4 of its standard deviations
        const double left = static_cast<double>(x.points) - x.trace;
        CHECK(std::abs(x.chi2 - left) < 4.0 * std::sqrt(2.0 * left));
        const double error = strain_error(chosen);
        for (const double factor : {1e-3, 1e3}) // and no other smoothing is much better
            CHECK(error < 1.2 * strain_error(MeasuredDisplacement(grid, theory, options(factor * x.lambda))));
    }
}

TEST_CASE("errors that neighbours share are not taken for signal") {
    constexpr double R = 1.7;
    const MeasuredGrid grid = with_correlated_errors(32, 1e-2, R);
    MeasuredOptions windowed = options();
    windowed.window = R;
    const MeasuredDisplacement with(grid, theory, windowed), without(grid, theory, options());
    CHECK(with.report_x().lambda > 10.0 * without.report_x().lambda);
    CHECK(strain_error(with) < 0.7 * strain_error(without));
}

TEST_CASE("the spread of draws is the error that the sigmas make") {
    MeasuredGrid grid = sampled(24, 0.02, false);
    std::vector<std::size_t> bins; // only these have errors: the others keep their weight
    for (std::size_t bin = 0; bin < grid.known.size(); ++bin) {
        const double x = grid.place(bin % 24), y = grid.place(bin / 24);
        grid.known[bin] = std::hypot(x - place.x, y - place.y) < 3.5;
        if (grid.known[bin])
            bins.push_back(bin);
    }
    for (const std::size_t bin : bins) // of all sizes
        grid.sigma_x[bin] *= 0.5 + 0.1 * static_cast<double>(bin % 24);
    const MeasuredDisplacement measured(grid, theory, options(0.03));
    double variance = 0.0;
    const double unmoved = strain_at(*measured.field());
    for (const std::size_t bin : bins) { // smoothing is linear: each sigma by itself
        MeasuredGrid moved = grid;
        moved.Ux[bin] += grid.sigma_x[bin];
        const double change =
            strain_at(*MeasuredDisplacement(moved, theory, options(0.03)).field()) - unmoved;
        variance += change * change;
    }
    constexpr std::uint32_t count = 400; // the deviation is then known to 3.5 %; three of that
    CHECK(deviation(draws(measured, count)) == Approx(std::sqrt(variance)).epsilon(0.11));
    for (auto* sigma : {&grid.sigma_x, &grid.sigma_y})
        for (double& s : *sigma)
            s *= 2.0;
    const MeasuredDisplacement twice(grid, theory, options(0.03));
    CHECK(deviation(draws(twice, 20)) ==
          Approx(2.0 * deviation(draws(measured, 20))).epsilon(1e-9)); // the same draws
}

TEST_CASE("errors that go together are not averaged out, and over a long way they strain little") {
    std::vector<double> strain, displacement;
    for (const double radius : {0.0, 2.0, 10.0}) {
        MeasuredOptions chosen = options(0.03);
        chosen.correlation = radius;
        const MeasuredDisplacement measured(sampled(24, 0.02, false), theory, chosen);
        strain.push_back(deviation(draws(measured, 40)));
        std::vector<double> u; // against theory, which keeps its place at the edge
        for (std::uint32_t k = 0; k < 40; ++k)
            u.push_back(
                measured.drawn(5, k)->wake(0.0)->at(place.x, place.y, {.displacement = true}).displacement.x);
        displacement.push_back(deviation(u));
    }
    CHECK(strain[1] > 1.5 * strain[0]); // within the reach of the smoothing
    CHECK(strain[2] < 0.8 * strain[1]);
    CHECK(displacement[1] > 1.5 * displacement[0]);
    CHECK(displacement[2] > 0.8 * displacement[1]);
}

TEST_CASE("draws depend on seed and sample alone") {
    const MeasuredDisplacement measured(sampled(24, 0.02, false), theory, options(0.03));
    CHECK(strain_at(*measured.drawn(5, 3)) == strain_at(*measured.drawn(5, 3)));
    CHECK(strain_at(*measured.drawn(5, 3)) != strain_at(*measured.drawn(5, 4)));
    CHECK(strain_at(*measured.drawn(5, 3)) != strain_at(*measured.drawn(6, 3)));
}

TEST_CASE("a constant in a measured field makes no strain") {
    MeasuredGrid grid = sampled(24, 0.02, true);
    const auto plain = MeasuredDisplacement(grid, theory, options(0.1)).field();
    for (double& u : grid.Ux)
        u += 3.0;
    const auto lifted = MeasuredDisplacement(grid, theory, options(0.1)).field();
    for (const Vector p : {place, Vector{9.7, 2.0}, Vector{-4.0, -9.9}})
        CHECK(strain_at(*lifted, p) ==
              Approx(strain_at(*plain, p)).margin(1e-9)); // rounding of 3 over the blend
}
