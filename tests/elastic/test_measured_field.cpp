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
        const FieldValues change = wake->by_heading(q.x, q.y, {.strain = true, .polar = true});
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
    CHECK_THROWS_AS(field->wake(0.0)->by_medium(1.0, 1.0, {.strain = true}), InputError);
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
