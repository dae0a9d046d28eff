#include "plane_table.hpp"

#include "rodwake/core/error.hpp"

#include <algorithm>
#include <sstream>
#include <utility>

namespace rodwake::elastic {

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

/// Takes over what was asked of the exact field.
void merge(FieldValues& f, const FieldValues& exact, FieldRequest asked) {
    if (asked.displacement)
        f.displacement = exact.displacement;
    if (asked.dipole)
        f.dipole = exact.dipole;
    if (asked.strain)
        f.strain = exact.strain;
    if (asked.polar) {
        f.laplacian = exact.laplacian;
        f.gradient_of_trace = exact.gradient_of_trace;
    }
    if (asked.gradients && asked.strain) {
        f.strain_x = exact.strain_x;
        f.strain_y = exact.strain_y;
    }
    if (asked.gradients && asked.polar) {
        f.laplacian_x = exact.laplacian_x;
        f.laplacian_y = exact.laplacian_y;
        f.gradient_of_trace_x = exact.gradient_of_trace_x;
        f.gradient_of_trace_y = exact.gradient_of_trace_y;
    }
}

class TableWake final : public Wake {
public:
    TableWake(std::shared_ptr<const PlaneTable> table, const Medium& medium)
        : table_(std::move(table)),
          strain_(table_->strain, table_->lowest_level, table_->degree, strain_components),
          gradient_(table_->gradient, table_->lowest_level, table_->degree, gradient_components),
          exact_(medium), per_xi_(1.0 / medium.xi) {}

    FieldValues at(double x, double y, FieldRequest request) const override;
    MediumDerivatives by_medium(double x, double y, FieldRequest request) const override {
        return medium_derivatives(exact_, x, y, request);
    }

    const Medium& medium() const { return exact_.medium(); }

private:
    bool put_strain(FieldValues& f, double x, double y, double sign) const;
    bool put_slopes(FieldValues& f, double x, double y, double sign, FieldRequest request) const;

    std::shared_ptr<const PlaneTable> table_;
    CellIndex strain_, gradient_;
    Field exact_;
    double per_xi_;
};

/// x and y >= 0 in units of xi; false: not in the table.
bool TableWake::put_strain(FieldValues& f, double x, double y, double sign) const {
    const CellIndex::Found cell = strain_.find(x, y);
    if (!cell.coefficients)
        return false;
    const auto value = evaluate_cell<strain_components>(table_->degree, cell.coefficients, cell.u, cell.v).f;
    f.strain = {per_xi_ * value[0], sign * per_xi_ * value[1], per_xi_ * value[2]};
    return true;
}

/// What is made of the gradient.
bool TableWake::put_slopes(FieldValues& f, double x, double y, double sign, FieldRequest request) const {
    const CellIndex::Found cell = gradient_.find(x, y);
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
    rest.strain = request.strain && !put_strain(f, X, Y, sign);
    const bool slopes = request.polar || (request.strain && request.gradients);
    const bool exact_slopes = slopes && !put_slopes(f, X, Y, sign, request);
    rest.polar = request.polar && exact_slopes;
    rest.gradients = exact_slopes && request.gradients;
    if (!(rest.displacement || rest.dipole || rest.strain || exact_slopes))
        return f;
    rest.strain |= exact_slopes && request.strain && request.gradients;
    merge(f, exact_.at(x, y, rest), rest);
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
