// Fields of rods at many points. Points go block by block through the batched kernels into the rows of the
// result, a block a task, so that what a thread works on stays in its cache.

#include "arrays.hpp"
#include "bind.hpp"
#include "medium.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/parallel.hpp"
#include "rodwake/elastic/wake_field.hpp"
#include "rodwake/elastic/wake_kernel.hpp"
#include "signals.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

namespace rodwake::python {

namespace {

using elastic::FieldRequest;
using elastic::FieldValues;
using elastic::Source;

enum class Quantity { displacement, strain, laplacian, grad_div, dipole };

constexpr std::size_t block = 2048;

struct Request {
    Medium medium;
    Quantity quantity;
    std::vector<Source> rods;
    std::span<const double> x, y;
    std::span<double> out; ///< width() numbers a point
    std::size_t threads;

    std::size_t width() const { return quantity == Quantity::strain ? 4 : 2; }
};

/// What a request asks of a field.
FieldRequest request_of(Quantity quantity) {
    return {.displacement = quantity == Quantity::displacement,
            .strain = quantity == Quantity::strain,
            .polar = quantity == Quantity::laplacian || quantity == Quantity::grad_div,
            .dipole = quantity == Quantity::dipole};
}

elastic::Vector vector_of(const FieldValues& values, Quantity quantity) {
    switch (quantity) {
    case Quantity::laplacian:
        return values.laplacian;
    case Quantity::grad_div:
        return values.gradient_of_trace;
    case Quantity::dipole:
        return values.dipole;
    case Quantity::displacement:
    case Quantity::strain:
        break;
    }
    return values.displacement;
}

void put(const elastic::SymmetricTensor& t, double* row) {
    row[0] = t.xx;
    row[1] = row[2] = t.xy;
    row[3] = t.yy;
}

/// Strain and polar vectors on the plane.
void add_batch(const Request& r, const elastic::WakeKernel& kernel, std::size_t from, std::size_t to) {
    const std::size_t count = to - from;
    const elastic::Places places{r.x.subspan(from, count), r.y.subspan(from, count)};
    std::array<std::array<double, block>, 7> sums;
    const auto sum = [&](std::size_t k) { return std::span(sums[k]).first(count); };
    const elastic::StrainSums strain{sum(0), sum(1), sum(2)};
    double* row = r.out.data() + from * r.width();
    if (r.quantity == Quantity::strain) {
        kernel.strain(r.rods, places, strain);
        for (std::size_t i = 0; i < count; ++i, row += 4)
            put({sums[0][i], sums[1][i], sums[2][i]}, row);
        return;
    }
    kernel.strain_and_polar(r.rods, places, strain, {sum(3), sum(4), sum(5), sum(6)});
    const std::size_t first = r.quantity == Quantity::laplacian ? 3 : 5;
    for (std::size_t i = 0; i < count; ++i, row += 2) {
        row[0] = sums[first][i];
        row[1] = sums[first + 1][i];
    }
}

/// Everything else, a point at a time, by the wake of each rod in its own frame.
class PointSum {
public:
    explicit PointSum(const Request& r) : r_(r), request_(request_of(r.quantity)) {
        const auto field = elastic::exact_field(r.medium.elastic, r.medium.box);
        for (const Source& rod : r.rods)
            wakes_.push_back(field->wake(rod.heading));
    }

    void add(std::size_t from, std::size_t to) const {
        for (std::size_t i = from; i < to; ++i)
            add_point(i);
    }

private:
    void add_point(std::size_t i) const {
        elastic::SymmetricTensor strain;
        elastic::Vector vector;
        for (std::size_t k = 0; k < wakes_.size(); ++k) {
            const Source& rod = r_.rods[k];
            const double c = std::cos(rod.heading), s = std::sin(rod.heading);
            const elastic::Vector at = turned(elastic::Vector{r_.x[i] - rod.x, r_.y[i] - rod.y}, c, -s);
            const FieldValues own = wakes_[k]->at(at.x, at.y, request_);
            const auto t = turned(own.strain, c, s);
            const auto v = turned(vector_of(own, r_.quantity), c, s);
            strain = {strain.xx + t.xx, strain.xy + t.xy, strain.yy + t.yy};
            vector = {vector.x + v.x, vector.y + v.y};
        }
        double* row = r_.out.data() + i * r_.width();
        if (r_.quantity == Quantity::strain)
            return put(strain, row);
        row[0] = vector.x;
        row[1] = vector.y;
    }

    const Request& r_;
    FieldRequest request_;
    std::vector<std::shared_ptr<const elastic::Wake>> wakes_;
};

void evaluate(const Request& r, const std::atomic<bool>& stopped) {
    const bool batched = !r.medium.box && (r.quantity == Quantity::strain || request_of(r.quantity).polar);
    const std::optional<PointSum> one_by_one =
        batched ? std::nullopt : std::optional<PointSum>(std::in_place, r);
    const elastic::WakeKernel kernel(r.medium.elastic);
    const std::size_t points = r.x.size();
    parallel_for((points + block - 1) / block, r.threads, [&](std::size_t task) {
        const std::size_t from = task * block, to = std::min(points, from + block);
        if (stopped)
            return;
        if (batched)
            add_batch(r, kernel, from, to);
        else
            one_by_one->add(from, to);
    });
}

/// What takes longer than starting a thread can be interrupted.
void evaluate_attended(const Request& r) {
    std::atomic<bool> stopped = false;
    if (r.x.size() * r.rods.size() > 8 * block)
        return attended([&] { evaluate(r, stopped); }, [] {}, [&] { stopped = true; });
    const py::gil_scoped_release release;
    evaluate(r, stopped);
}

std::vector<Source> sources_of(const Array& rods) {
    if (rods.ndim() != 2 || rods.shape(1) != 3)
        throw InputError("rods: expected an array of shape (N, 3): x, y and heading of each rod");
    std::vector<Source> sources;
    for (py::ssize_t i = 0; i < rods.shape(0); ++i)
        sources.push_back({rods.at(i, 0), rods.at(i, 1), rods.at(i, 2)});
    return sources;
}

/// x and y of one length; the result has a row of 2 (strain: 4) numbers a point.
Array field(Quantity quantity, const Array& x, const Array& y, const Medium& medium, const Array& rods,
            std::size_t threads) {
    if (x.size() != y.size())
        throw InputError("x and y have " + std::to_string(x.size()) + " and " + std::to_string(y.size()) +
                         " numbers: give them the same shape");
    Request request{
        medium, quantity, sources_of(rods), numbers(x), numbers(y), {}, std::max<std::size_t>(threads, 1)};
    Array out({x.size(), static_cast<py::ssize_t>(request.width())});
    request.out = {out.mutable_data(), static_cast<std::size_t>(out.size())};
    evaluate_attended(request);
    return out;
}

} // namespace

void bind_fields(py::module_& module) {
    const std::pair<const char*, Quantity> quantities[] = {{"displacement", Quantity::displacement},
                                                           {"strain", Quantity::strain},
                                                           {"laplacian", Quantity::laplacian},
                                                           {"grad_div", Quantity::grad_div},
                                                           {"dipole", Quantity::dipole}};
    for (const auto& [name, quantity] : quantities)
        module.def(name, [quantity = quantity](const Array& x, const Array& y, const Medium& medium,
                                               const Array& rods, std::size_t threads) {
            return field(quantity, x, y, medium, rods, threads);
        });
}

} // namespace rodwake::python
