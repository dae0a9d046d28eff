// Making a PlaneTable: on each level the coarsest cells whose polynomials keep the tolerance.

#include "plane_table.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/parallel.hpp"
#include "rodwake/core/rng.hpp"

#include <algorithm>
#include <limits>
#include <numbers>
#include <sstream>
#include <utility>

namespace rodwake::elastic {

namespace {

/// Levels of 2^e xi from below 1e-4 to beyond 200.
constexpr int lowest_level = -14, end_level = 8;
constexpr std::int32_t cells_per_unit[] = {2, 3, 4, 6, 8, 12, 16, 24};
/// Of the tolerance: cells are checked at points, between which the error may be larger.
constexpr double margin = 0.5;

/// What a table holds at a place: strain (3 numbers) or its gradient (6).
template<std::size_t components>
using Numbers = std::array<double, components>;

template<std::size_t components, class Of> // a Field or a Wake
Numbers<components> numbers(const Of& field, double x, double y) {
    if constexpr (components == strain_components) {
        const SymmetricTensor e = field.at(x, y, {.strain = true}).strain;
        return {e.xx, e.xy, e.yy};
    } else {
        const FieldValues f = field.at(x, y, {.strain = true, .gradients = true});
        return {f.strain_x.xx, f.strain_x.xy, f.strain_x.yy, f.strain_y.xx, f.strain_y.xy, f.strain_y.yy};
    }
}

/// Norm of the tensors: xy counts twice.
template<std::size_t components>
double norm(const Numbers<components>& t) {
    double sum = 0.0;
    for (std::size_t k = 0; k < components; ++k)
        sum += (k % 3 == 1 ? 2.0 : 1.0) * t[k] * t[k];
    return std::sqrt(sum);
}

template<std::size_t components>
double relative_error(const Numbers<components>& value, const Numbers<components>& exact) {
    Numbers<components> off;
    for (std::size_t k = 0; k < components; ++k)
        off[k] = value[k] - exact[k];
    return norm(off) / std::max(norm(exact), std::numeric_limits<double>::min());
}

std::vector<double> chebyshev_nodes(int count) {
    std::vector<double> nodes(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i)
        nodes[static_cast<std::size_t>(i)] = std::cos(std::numbers::pi * (i + 0.5) / count);
    return nodes;
}

/// to_monomials(k, i): coefficient of u^k in the polynomial that is 1 at node i and 0 at the others.
std::vector<double> to_monomials(const std::vector<double>& nodes) {
    const std::size_t n = nodes.size();
    std::vector<double> result(n * n);
    for (std::size_t i = 0; i < n; ++i) {
        std::vector<double> product{1.0};
        for (std::size_t m = 0; m < n; ++m) {
            if (m == i)
                continue;
            product.push_back(0.0);
            for (std::size_t k = product.size(); k-- > 0;)
                product[k] = ((k > 0 ? product[k - 1] : 0.0) - nodes[m] * product[k]) / (nodes[i] - nodes[m]);
        }
        for (std::size_t k = 0; k < n; ++k)
            result[k * n + i] = product[k];
    }
    return result;
}

/// A square of the plane in units of xi: u, v in [-1, 1] are (x - x0)/half, (y - y0)/half.
struct Square {
    double x0, y0, half;
};

/// Fits and checks the cells of one degree.
template<std::size_t components>
class CellFit {
public:
    CellFit(double eta, double tolerance, int degree)
        : field_({.eta = eta, .xi = 1.0}), tolerance_(margin * tolerance), degree_(degree),
          nodes_(chebyshev_nodes(degree + 1)), to_monomials_(elastic::to_monomials(nodes_)) {}

    std::vector<double> fit(const Square& cell) const;
    bool good(const Square& cell, const std::vector<double>& coefficients) const;

private:
    Numbers<components> exact(const Square& cell, double u, double v) const {
        return numbers<components>(field_, cell.x0 + cell.half * u, cell.y0 + cell.half * v);
    }

    Field field_;
    double tolerance_;
    int degree_;
    std::vector<double> nodes_, to_monomials_;
};

template<std::size_t components>
std::vector<double> CellFit<components>::fit(const Square& cell) const {
    const std::size_t n = nodes_.size(), row = components * n;
    std::vector<double> half_done(row * n), c(row * n); // (node of u, power of v), then both powers
    for (std::size_t a = 0; a < n; ++a)
        for (std::size_t b = 0; b < n; ++b) {
            const auto f = exact(cell, nodes_[a], nodes_[b]);
            for (std::size_t j = 0; j < n; ++j)
                for (std::size_t k = 0; k < components; ++k)
                    half_done[row * a + components * j + k] += to_monomials_[n * j + b] * f[k];
        }
    for (std::size_t a = 0; a < n; ++a)
        for (std::size_t i = 0; i < n; ++i)
            for (std::size_t j = 0; j < row; ++j)
                c[row * i + j] += to_monomials_[n * i + a] * half_done[row * a + j];
    return c;
}

/// At points between the nodes, the cell's corners among them.
template<std::size_t components>
bool CellFit<components>::good(const Square& cell, const std::vector<double>& coefficients) const {
    const int points = degree_ + 2;
    const auto position = [&](int i) { return std::cos(std::numbers::pi * i / (points - 1)); };
    for (int a = 0; a < points; ++a)
        for (int b = 0; b < points; ++b) {
            const auto value =
                evaluate_cell<components>(degree_, coefficients.data(), position(a), position(b)).f;
            if (!(relative_error(value, exact(cell, position(a), position(b))) <= tolerance_))
                return false;
        }
    return true;
}

/// A level with its cells' polynomials; empty: exact, or in the hole that lower levels fill.
struct BuiltLevel {
    std::int32_t n = 0;
    std::vector<std::vector<double>> cells;
    bool complete = true;
};

bool in_hole(std::size_t i, std::size_t j, std::size_t n) { return i >= n && i < 3 * n && j < n; }

template<std::size_t components>
BuiltLevel make_level(const CellFit<components>& fit, int exponent, std::int32_t n, std::size_t threads) {
    const auto count = static_cast<std::size_t>(n);
    BuiltLevel level{n, std::vector<std::vector<double>>(8 * count * count), true};
    const double unit = std::ldexp(1.0, exponent), half = 0.5 * unit / n;
    parallel_for(2 * count, threads, [&](std::size_t j) {
        for (std::size_t i = 0; i < 4 * count; ++i) {
            if (in_hole(i, j, count))
                continue;
            const Square cell{half * (2.0 * static_cast<double>(i) + 1.0) - 2.0 * unit,
                              half * (2.0 * static_cast<double>(j) + 1.0), half};
            std::vector<double> c = fit.fit(cell);
            if (fit.good(cell, c))
                level.cells[4 * count * j + i] = std::move(c);
        }
    });
    for (std::size_t k = 0; k < level.cells.size(); ++k)
        if (level.cells[k].empty() && !in_hole(k % (4 * count), k / (4 * count), count))
            level.complete = false;
    return level;
}

template<std::size_t components>
CellTable make_cells(double eta, double tolerance, int degree, std::size_t threads) {
    const CellFit<components> fit(eta, tolerance, degree);
    CellTable table;
    std::size_t polynomials = 0;
    for (int e = lowest_level; e < end_level; ++e) {
        // The coarsest level that is complete, else the finest.
        BuiltLevel level;
        for (const std::int32_t n : cells_per_unit) {
            level = make_level(fit, e, n, threads);
            if (level.complete)
                break;
        }
        table.cells_per_unit.push_back(level.n);
        for (const std::vector<double>& cell : level.cells) {
            table.polynomial_of.push_back(cell.empty() ? -1 : static_cast<std::int32_t>(polynomials++));
            table.coefficients.insert(table.coefficients.end(), cell.begin(), cell.end());
        }
    }
    return table;
}

} // namespace

PlaneTable make_plane_table(double eta, double tolerance, std::size_t threads) {
    if (!(tolerance >= 1e-12 && tolerance <= 0.1)) {
        std::ostringstream message;
        message << "tolerance = " << tolerance << ": a table can be made for 1e-12 to 0.1";
        throw InputError(message.str());
    }
    PlaneTable table;
    table.eta = eta;
    table.tolerance = tolerance;
    table.degree = tolerance >= 3e-5 ? 3 : tolerance >= 1e-7 ? 5 : 7;
    table.lowest_level = lowest_level;
    table.strain = make_cells<strain_components>(eta, tolerance, table.degree, threads);
    table.gradient = make_cells<gradient_components>(eta, tolerance, table.degree, threads);
    constexpr std::int64_t points = 1'000'000;
    constexpr std::uint64_t seed = 20'260'101;
    const TableErrors errors = plane_table_errors(table, points, seed, threads);
    table.strain_error = errors.strain;
    table.gradient_error = errors.gradient;
    table.points_checked = points;
    return table;
}

TableErrors plane_table_errors(const PlaneTable& table, std::int64_t points, std::uint64_t seed,
                               std::size_t threads) {
    constexpr std::int64_t chunk = 10'000;
    const Medium medium{.eta = table.eta, .xi = 1.0};
    const Field exact(medium);
    const auto field = table_field(std::make_shared<const PlaneTable>(table), medium);
    const auto wake = field->wake(0.0);
    const auto chunks = static_cast<std::size_t>((points + chunk - 1) / chunk);
    std::vector<TableErrors> worst(chunks, {0.0, 0.0});
    parallel_for(chunks, threads, [&](std::size_t k) {
        RandomStream random(seed, static_cast<std::uint32_t>(k));
        for (std::int64_t i = 0; i < chunk && static_cast<std::int64_t>(k) * chunk + i < points; ++i) {
            const double r = random.log_uniform(1e-4, 200.0),
                         angle = random.uniform(-std::numbers::pi, std::numbers::pi);
            const double x = r * std::cos(angle), y = r * std::sin(angle);
            worst[k].strain =
                std::max(worst[k].strain, relative_error(numbers<strain_components>(*wake, x, y),
                                                         numbers<strain_components>(exact, x, y)));
            worst[k].gradient =
                std::max(worst[k].gradient, relative_error(numbers<gradient_components>(*wake, x, y),
                                                           numbers<gradient_components>(exact, x, y)));
        }
    });
    TableErrors all{0.0, 0.0};
    for (const TableErrors& item : worst)
        all = {std::max(all.strain, item.strain), std::max(all.gradient, item.gradient)};
    return all;
}

CellIndex::CellIndex(const CellTable& table, int lowest_level, int degree, std::size_t components)
    : lowest_(lowest_level), size_(static_cast<std::ptrdiff_t>(components) * (degree + 1) * (degree + 1)),
      coefficients_(table.coefficients.data()) {
    const std::int32_t* numbers = table.polynomial_of.data();
    for (std::size_t k = 0; k < table.cells_per_unit.size(); ++k) {
        const int n = table.cells_per_unit[k];
        const double unit = std::ldexp(1.0, lowest_level + static_cast<int>(k));
        levels_.push_back({2.0 * unit, n / unit, 4 * n, numbers});
        numbers += static_cast<std::ptrdiff_t>(8) * n * n;
    }
}

namespace {

/// d/dx and d/dy of a tensor.
struct Slopes {
    SymmetricTensor x, y;
};

Vector gradient_of_trace(const Slopes& s) { return {s.x.xx + s.x.yy, s.y.xx + s.y.yy}; }

/// 2 div eps - grad tr eps.
Vector laplacian(const Slopes& s) { return {s.x.xx - s.x.yy + 2.0 * s.y.xy, 2.0 * s.x.xy - s.y.xx + s.y.yy}; }

/// Of the mirror image if sign = -1: xy and d/dy are odd in y.
Slopes slopes(const std::array<double, gradient_components>& g, double factor, double sign) {
    const double odd = sign * factor;
    return {{factor * g[0], odd * g[1], factor * g[2]}, {odd * g[3], factor * g[4], odd * g[5]}};
}

class TableWake final : public Wake {
public:
    TableWake(std::shared_ptr<const PlaneTable> table, const Medium& medium)
        : table_(std::move(table)),
          strain_(table_->strain, table_->lowest_level, table_->degree, strain_components),
          gradient_(table_->gradient, table_->lowest_level, table_->degree, gradient_components),
          exact_(medium), per_xi_(1.0 / medium.xi) {}

    FieldValues at(double x, double y, FieldRequest request) const override;
    MediumDerivatives medium_derivatives(double x, double y, FieldRequest request) const override {
        return elastic::medium_derivatives(exact_, x, y, request);
    }

    const Medium& medium() const { return exact_.medium(); }

private:
    bool put_slopes(FieldValues& f, double x, double y, double sign, FieldRequest request) const;

    std::shared_ptr<const PlaneTable> table_;
    CellIndex strain_, gradient_;
    Field exact_;
    double per_xi_;
};

/// What is made of the gradient.
bool TableWake::put_slopes(FieldValues& f, double x, double y, double sign, FieldRequest request) const {
    const CellIndex::LocatedCell cell = gradient_.find(x, y);
    if (!cell.coefficients)
        return false;
    const auto value =
        evaluate_cell<gradient_components, true>(table_->degree, cell.coefficients, cell.u, cell.v);
    const double second = per_xi_ * per_xi_, third = second * per_xi_ * cell.scale;
    const Slopes s = slopes(value.f, second, sign);
    if (request.strain && request.gradients) {
        f.strain_x = s.x;
        f.strain_y = s.y;
    }
    if (!request.polar)
        return true;
    f.laplacian = laplacian(s);
    f.gradient_of_trace = gradient_of_trace(s);
    if (request.gradients) {
        const Slopes by_x = slopes(value.u, third, sign), by_y = slopes(value.v, sign * third, sign);
        f.laplacian_x = laplacian(by_x);
        f.laplacian_y = laplacian(by_y);
        f.gradient_of_trace_x = gradient_of_trace(by_x);
        f.gradient_of_trace_y = gradient_of_trace(by_y);
    }
    return true;
}

FieldValues TableWake::at(double x, double y, FieldRequest request) const {
    const double X = x * per_xi_, Y = std::abs(y) * per_xi_, sign = std::signbit(y) ? -1.0 : 1.0;
    FieldRequest rest = request; // of the exact field
    FieldValues f = unrequested();
    if (const CellIndex::LocatedCell cell = request.strain ? strain_.find(X, Y) : CellIndex::LocatedCell{};
        cell.coefficients) {
        const auto value =
            evaluate_cell<strain_components>(table_->degree, cell.coefficients, cell.u, cell.v).f;
        f.strain = {per_xi_ * value[0], sign * per_xi_ * value[1], per_xi_ * value[2]};
        rest.strain = false;
    }
    const bool slopes = request.polar || (request.strain && request.gradients);
    const bool exact_slopes = slopes && !put_slopes(f, X, Y, sign, request);
    rest.polar = request.polar && exact_slopes;
    rest.gradients = exact_slopes && request.gradients;
    if (!(rest.displacement || rest.dipole || rest.strain || exact_slopes))
        return f;
    rest.strain |= exact_slopes && request.strain && request.gradients;

    // Take over what is asked of the exact field.
    const FieldValues exact = exact_.at(x, y, rest);
    if (rest.displacement)
        f.displacement = exact.displacement;
    if (rest.dipole)
        f.dipole = exact.dipole;
    if (rest.strain)
        f.strain = exact.strain;
    if (rest.polar) {
        f.laplacian = exact.laplacian;
        f.gradient_of_trace = exact.gradient_of_trace;
    }
    if (rest.gradients && rest.strain) {
        f.strain_x = exact.strain_x;
        f.strain_y = exact.strain_y;
    }
    if (rest.gradients && rest.polar) {
        f.laplacian_x = exact.laplacian_x;
        f.laplacian_y = exact.laplacian_y;
        f.gradient_of_trace_x = exact.gradient_of_trace_x;
        f.gradient_of_trace_y = exact.gradient_of_trace_y;
    }
    return f;
}

class TableField final : public WakeField {
public:
    TableField(std::shared_ptr<const PlaneTable> table, const Medium& medium)
        : wake_(std::make_shared<const TableWake>(std::move(table), medium)) {}

    const Medium& medium() const override { return wake_->medium(); }
    std::shared_ptr<const Wake> wake(double /*heading*/) const override { return wake_; }

private:
    std::shared_ptr<const TableWake> wake_;
};

} // namespace

std::shared_ptr<const WakeField> table_field(std::shared_ptr<const PlaneTable> table, const Medium& medium) {
    validate(medium);
    if (table->eta != medium.eta) {
        std::ostringstream message;
        message << "the table is of eta = " << table->eta << ", the medium has eta = " << medium.eta;
        throw InputError(message.str());
    }
    return std::make_shared<const TableField>(std::move(table), medium);
}

} // namespace rodwake::elastic
