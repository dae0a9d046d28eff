// From measured bins to a smooth field: what they have beyond theory, smoothed, with draws of its errors.

#include "field_algebra.hpp"
#include "measured_residual.hpp"
#include "rodwake/core/box_sides.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/rng.hpp"
#include "smoothing_spline.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>
#include <utility>

namespace rodwake::elastic {

namespace {

/// Errors of the bins in units of their sigma: white noise under the window of the means, around the box.
std::vector<double> unit_errors(const MeasuredGrid& grid, double correlation, const RandomStream& random) {
    RandomStream normals = random;
    std::vector<double> white(grid.n * grid.n);
    for (double& z : white)
        z = normals.normal();
    const auto n = static_cast<long>(grid.n), reach = static_cast<long>(correlation / grid.spacing);
    std::vector<double> errors(white.size(), 0.0);
    double square = 0.0;
    for (long j = -reach; j <= reach; ++j)
        for (long i = -reach; i <= reach; ++i) {
            const double r = std::hypot(i, j) * grid.spacing / correlation;
            const double weight = i == 0 && j == 0 ? 1.0 : std::max(0.0, 1.0 - r * r);
            square += weight * weight;
            for (long row = 0; weight > 0.0 && row < n; ++row)
                for (long column = 0; column < n; ++column)
                    errors[static_cast<std::size_t>(row * n + column)] +=
                        weight *
                        white[static_cast<std::size_t>((row + j + n) % n * n + (column + i + n) % n)];
        }
    for (double& e : errors)
        e /= std::sqrt(square);
    return errors;
}

struct MeasuredComponent {
    SmoothingSpline spline;
    std::vector<double> values, sigma; ///< delta at the points
    SmoothingReport report;
};

} // namespace

void validate(const MeasuredGrid& g, const MeasuredOptions& o, std::optional<PeriodicBox> box) {
    const auto refuse = [](const auto&... words) {
        std::ostringstream text;
        (text << ... << words);
        throw InputError(text.str());
    };
    const std::size_t bins = g.n * g.n;
    if (g.n < 16 || g.n % 2 != 0 || !(g.spacing > 0.0))
        refuse("measured field: ", g.n, " bins a side, ", g.spacing,
               " apart: an even number from 16 on is needed");
    for (const auto* values : {&g.Ux, &g.Uy, &g.sigma_x, &g.sigma_y})
        if (values->size() != bins)
            refuse("measured field: ", values->size(), " values for ", bins, " bins");
    if (g.known.size() != bins)
        refuse("measured field: ", g.known.size(), " marks for ", bins, " bins");
    for (std::size_t i = 0; i < bins; ++i)
        if (!(g.sigma_x[i] > 0.0 && g.sigma_y[i] > 0.0))
            refuse("measured field: the sigma of bin ", i, " is not above 0");
    const double last = g.place(g.n - 1), rounding = 1e-9 * last;
    if (!(o.core > 0.0 && o.blend > 0.0 && o.edge - o.blend >= o.core + o.blend && o.edge <= last + rounding))
        refuse("measured field: core = ", o.core, ", blend = ", o.blend, ", edge = ", o.edge,
               ": core and blend must be above 0, core + 2 blend at most edge, and edge at most ", last,
               ", where the measured field ends");
    if (!(o.blend >= 2.0 * g.spacing))
        refuse("measured field: blend = ", o.blend, ": at least two bins, which are ", g.spacing, " apart");
    if (!(o.window <= 0.5 * g.box() && o.correlation <= 0.5 * g.box()))
        refuse("measured field: window = ", o.window, ", correlation = ", o.correlation,
               ": at most half the box, ", 0.5 * g.box());
    if (box && !(box->shorter() > std::numbers::sqrt2 * o.edge))
        refuse("measured field: in a box of ", to_string(*box),
               " f/mu what was measured up to edge = ", o.edge,
               " would meet its own image: its sides must be longer than sqrt(2) edge");
}

struct MeasuredDisplacement::Impl {
    MeasuredGrid grid;
    Medium medium;
    MeasuredOptions options;
    QuinticKnots knots;
    std::vector<std::size_t> bins; ///< those outside the core
    std::vector<MeasuredComponent> components;
    std::vector<double> coefficients_x, coefficients_y;

    Impl(const MeasuredGrid& g, const Medium& m, const MeasuredOptions& o);
    MeasuredComponent component(const std::vector<double>& U, const std::vector<double>& sigma,
                                const std::vector<double>& theory) const;
    std::vector<double> errors(double radius, const RandomStream& random) const;
    std::vector<double> levelled(std::vector<double> coefficients) const;
    double x(std::size_t bin) const { return grid.place(bin % grid.n); }
    double y(std::size_t bin) const { return grid.place(bin / grid.n); }
    std::shared_ptr<const WakeField> with(std::optional<PeriodicBox> box, std::vector<double> cx,
                                          std::vector<double> cy) const;
};

MeasuredDisplacement::Impl::Impl(const MeasuredGrid& g, const Medium& m, const MeasuredOptions& o)
    : grid(g), medium(m), options(o) {
    validate(grid, options);
    const std::size_t last = grid.n - 1, intervals = grid.n / 2;
    knots = {grid.place(0), (grid.place(last) - grid.place(0)) / static_cast<double>(intervals), intervals};
    const auto wake = exact_field(medium, grid.box())->wake(0.0);
    std::vector<double> theory_x, theory_y;
    for (std::size_t bin = 0; bin < grid.n * grid.n; ++bin)
        if (std::hypot(x(bin), y(bin)) > options.core) {
            const Vector u = wake->at(x(bin), y(bin), {.displacement = true}).displacement;
            bins.push_back(bin);
            theory_x.push_back(u.x);
            theory_y.push_back(u.y);
        }
    components.push_back(component(grid.Ux, grid.sigma_x, theory_x));
    components.push_back(component(grid.Uy, grid.sigma_y, theory_y));
    coefficients_x = levelled(components[0].spline.fit(components[0].values));
    coefficients_y = levelled(components[1].spline.fit(components[1].values));
}

MeasuredComponent MeasuredDisplacement::Impl::component(const std::vector<double>& U,
                                                        const std::vector<double>& sigma,
                                                        const std::vector<double>& theory) const {
    SplinePoints points;
    std::vector<double> values;
    for (std::size_t k = 0; k < bins.size(); ++k) {
        points.x.push_back(x(bins[k]));
        points.y.push_back(y(bins[k]));
        points.sigma.push_back(sigma[bins[k]]);
        values.push_back(grid.known[bins[k]] ? U[bins[k]] - theory[k] : 0.0);
    }
    MeasuredComponent c{SmoothingSpline(knots, points), values, points.sigma, {}};
    constexpr std::uint32_t probes = 16; // tr(H R) to about 2 % of a field of 78 bins a side
    constexpr std::uint64_t seed = 0x70726f6265;
    Eigen::MatrixXd z(static_cast<Eigen::Index>(bins.size()), probes);
    for (std::uint32_t k = 0; k < probes; ++k) {
        const std::vector<double> item = errors(options.window, RandomStream(seed, k));
        z.col(k) = Eigen::Map<const Eigen::VectorXd>(item.data(), z.rows());
    }
    if (options.smoothing)
        c.spline.set_lambda(*options.smoothing);
    c.report.lambda = options.smoothing ? *options.smoothing : c.spline.choose(values, z);
    c.report.trace = c.spline.trace(z);
    c.report.chi2 = c.spline.chi2(values, c.spline.fit(values));
    c.report.points = values.size();
    return c;
}

/// At the points, in units of sigma; bins without data have none.
std::vector<double> MeasuredDisplacement::Impl::errors(double radius, const RandomStream& random) const {
    const std::vector<double> all = unit_errors(grid, radius, random);
    std::vector<double> chosen;
    for (const std::size_t bin : bins)
        chosen.push_back(grid.known[bin] ? all[bin] : 0.0);
    return chosen;
}

/// Less the constant c for which |f - c|^2 |grad w|^2 over the edge is least. B-splines add up to 1.
std::vector<double> MeasuredDisplacement::Impl::levelled(std::vector<double> coefficients) const {
    double sum = 0.0, weights = 0.0;
    for (const std::size_t bin : bins) {
        const Jet w = edge_weight(options, x(bin), y(bin));
        const double weight = w.x * w.x + w.y * w.y;
        if (weight > 0.0)
            sum += weight * spline_at(knots, coefficients, x(bin), y(bin)).v;
        weights += weight;
    }
    for (double& c : coefficients)
        c -= sum / weights;
    return coefficients;
}

std::shared_ptr<const WakeField> MeasuredDisplacement::Impl::with(std::optional<PeriodicBox> box,
                                                                  std::vector<double> cx,
                                                                  std::vector<double> cy) const {
    validate(grid, options, box);
    return measured_field(exact_field(medium, box), {options, knots, std::move(cx), std::move(cy)});
}

MeasuredDisplacement::MeasuredDisplacement(const MeasuredGrid& grid, const Medium& theory,
                                           const MeasuredOptions& options)
    : impl_(std::make_shared<const Impl>(grid, theory, options)) {}

std::shared_ptr<const WakeField> MeasuredDisplacement::field(std::optional<PeriodicBox> box) const {
    return impl_->with(box, impl_->coefficients_x, impl_->coefficients_y);
}

std::shared_ptr<const WakeField> MeasuredDisplacement::drawn(std::uint64_t seed, std::uint32_t sample,
                                                             std::optional<PeriodicBox> box) const {
    const auto coefficients = [&](std::uint32_t which) {
        const MeasuredComponent& c = impl_->components[which];
        const std::vector<double> errors = impl_->errors(
            std::max(impl_->options.window, impl_->options.correlation), RandomStream(seed, sample, which));
        std::vector<double> values = c.values;
        for (std::size_t i = 0; i < values.size(); ++i)
            values[i] += c.sigma[i] * errors[i];
        return impl_->levelled(c.spline.fit(values));
    };
    return impl_->with(box, coefficients(0), coefficients(1));
}

const SmoothingReport& MeasuredDisplacement::report_x() const { return impl_->components[0].report; }
const SmoothingReport& MeasuredDisplacement::report_y() const { return impl_->components[1].report; }

namespace {

/// A function of one variable with three derivatives.
struct Line {
    double v, d, dd, ddd;
};

/// s((place - from)/width), by place.
Line smooth_step(double position, double width) {
    const double t = std::clamp(position / width, 0.0, 1.0), r = 1.0 - t, per = 1.0 / width;
    return {t * t * t * t * (35.0 + t * (-84.0 + t * (70.0 - 20.0 * t))), 140.0 * t * t * t * r * r * r * per,
            420.0 * t * t * r * r * (r - t) * per * per,
            840.0 * t * r * (r * r - 3.0 * t * r + t * t) * per * per * per};
}

/// Of |x|: odd derivatives change sign.
Line towards_edge(double x, const MeasuredOptions& o) {
    const Line s = smooth_step(o.edge - std::abs(x), o.blend);
    const double sign = x < 0.0 ? 1.0 : -1.0;
    return {s.v, sign * s.d, s.dd, sign * s.ddd};
}

/// f(r), r the distance from the rod, above 0.
Jet radial(const Line& f, double x, double y) {
    const double r = std::hypot(x, y), c = x / r, s = y / r, per = 1.0 / r;
    const double first = f.d * per;                          // f'/r
    const double second = f.dd - first;                      // along r, beyond f'/r
    const double third = f.ddd - 3.0 * per * (f.dd - first); // r^3 ((1/r) d/dr)^3 f
    return {f.v,
            f.d * c,
            f.d * s,
            first + second * c * c,
            second * c * s,
            first + second * s * s,
            third * c * c * c + 3.0 * per * second * c,
            third * c * c * s + per * second * s,
            third * c * s * s + per * second * c,
            third * s * s * s + 3.0 * per * second * s};
}

Jet product(const Jet& f, const Jet& g) {
    return {f.v * g.v,
            f.x * g.v + f.v * g.x,
            f.y * g.v + f.v * g.y,
            f.xx * g.v + 2.0 * f.x * g.x + f.v * g.xx,
            f.xy * g.v + f.x * g.y + f.y * g.x + f.v * g.xy,
            f.yy * g.v + 2.0 * f.y * g.y + f.v * g.yy,
            f.xxx * g.v + 3.0 * (f.xx * g.x + f.x * g.xx) + f.v * g.xxx,
            f.xxy * g.v + f.xx * g.y + 2.0 * (f.xy * g.x + f.x * g.xy) + f.y * g.xx + f.v * g.xxy,
            f.xyy * g.v + f.yy * g.x + 2.0 * (f.xy * g.y + f.y * g.xy) + f.x * g.yy + f.v * g.xyy,
            f.yyy * g.v + 3.0 * (f.yy * g.y + f.y * g.yy) + f.v * g.yyy};
}

SymmetricTensor strain(const Vector& by_x, const Vector& by_y) {
    return {by_x.x, 0.5 * (by_x.y + by_y.x), by_y.y};
}

} // namespace

Jet edge_weight(const MeasuredOptions& options, double x, double y) {
    const Line f = towards_edge(x, options), g = towards_edge(y, options);
    return {f.v * g.v,  f.d * g.v,   f.v * g.d,  f.dd * g.v, f.d * g.d,
            f.v * g.dd, f.ddd * g.v, f.dd * g.d, f.d * g.dd, f.v * g.ddd};
}

Jet blend_weight(const MeasuredOptions& options, double x, double y) {
    const double r = std::hypot(x, y);
    if (r <= options.core)
        return {};
    const Jet edge = edge_weight(options, x, y);
    return r >= options.core + options.blend
               ? edge
               : product(radial(smooth_step(r - options.core, options.blend), x, y), edge);
}

bool MeasuredResidual::reaches(double px, double py) const {
    return std::abs(px) < options.edge && std::abs(py) < options.edge && std::hypot(px, py) > options.core;
}

void MeasuredResidual::add_to(FieldValues& f, double px, double py) const {
    const Jet w = blend_weight(options, px, py);
    const Jet u = product(w, spline_at(knots, x, px, py)), v = product(w, spline_at(knots, y, px, py));
    FieldValues more{};
    more.displacement = {u.v, v.v};
    more.strain = strain({u.x, v.x}, {u.y, v.y});
    more.laplacian = {u.xx + u.yy, v.xx + v.yy};
    more.gradient_of_trace = {u.xx + v.xy, u.xy + v.yy};
    more.strain_x = strain({u.xx, v.xx}, {u.xy, v.xy});
    more.strain_y = strain({u.xy, v.xy}, {u.yy, v.yy});
    more.laplacian_x = {u.xxx + u.xyy, v.xxx + v.xyy};
    more.laplacian_y = {u.xxy + u.yyy, v.xxy + v.yyy};
    more.gradient_of_trace_x = {u.xxx + v.xxy, u.xxy + v.xyy};
    more.gradient_of_trace_y = {u.xxy + v.xyy, u.xyy + v.yyy};
    add(f, more); // what was not asked for is NaN in f, and stays so
}

} // namespace rodwake::elastic
