// Fields of rods at many points. Points go block by block through the batched kernels into the rows of the
// result, a block a task, so that what a thread works on stays in its cache. Where there is no field, at a
// rod or at a place that is no number, a row is NaN.

#include "arrays.hpp"
#include "bind.hpp"
#include "rod_problem.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/parallel.hpp"
#include "rodwake/elastic/wake_field.hpp"
#include "rodwake/elastic/wake_kernel.hpp"
#include "rodwake/rods/classify_outcome.hpp"
#include "signals.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>

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
    const elastic::FieldPoints places{r.x.subspan(from, count), r.y.subspan(from, count)};
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

    void add(std::size_t i) const {
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

private:
    const Request& r_;
    FieldRequest request_;
    std::vector<std::shared_ptr<const elastic::Wake>> wakes_;
};

/// The ways to evaluate a request.
class Evaluation {
public:
    explicit Evaluation(const Request& r)
        : r_(r), batched_(!r.medium.box && (r.quantity == Quantity::strain || request_of(r.quantity).polar)),
          kernel_(r.medium.elastic) {
        if (!batched_)
            one_by_one_.emplace(r);
    }

    /// Returns at how many finite points there is no field.
    std::size_t add(std::size_t from, std::size_t to) const {
        if (batched_)
            try {
                add_batch(r_, kernel_, from, to);
                return 0;
            } catch (const InputError&) { // of some point: the others are evaluated without it
            }
        std::size_t singular = 0;
        for (std::size_t i = from; i < to; ++i)
            if (!add_point(i)) {
                std::fill_n(r_.out.begin() + static_cast<std::ptrdiff_t>(i * r_.width()), r_.width(), nan);
                singular += finite(i);
            }
        return singular;
    }

private:
    static constexpr double nan = std::numeric_limits<double>::quiet_NaN();

    bool finite(std::size_t i) const { return std::isfinite(r_.x[i]) && std::isfinite(r_.y[i]); }

    /// Images of a rod are found to rounding: their places are worked out.
    bool at_rod(std::size_t i) const {
        const std::optional<PeriodicBox>& box = r_.medium.box;
        return std::ranges::any_of(r_.rods, [&](const Source& rod) {
            const double x = r_.x[i] - rod.x, y = r_.y[i] - rod.y;
            const bool image = box && (std::abs(x) > 0.5 * box->x || std::abs(y) > 0.5 * box->y);
            return elastic::is_singular(x, y, image ? box : std::nullopt);
        });
    }

    bool add_point(std::size_t i) const {
        if (!finite(i) || at_rod(i))
            return false;
        try {
            if (batched_)
                add_batch(r_, kernel_, i, i + 1);
            else
                one_by_one_->add(i);
            return true;
        } catch (const InputError&) { // too near a rod for numbers, or too far
            return false;
        }
    }

    const Request& r_;
    bool batched_;
    elastic::WakeKernel kernel_;
    std::optional<PointSum> one_by_one_;
};

/// Returns at how many finite points there is no field.
std::size_t evaluate(const Request& r, const std::atomic<bool>& stopped) {
    const Evaluation evaluation(r);
    const std::size_t points = r.x.size();
    std::atomic<std::size_t> singular = 0;
    parallel_for((points + block - 1) / block, r.threads, [&](std::size_t task) {
        const std::size_t from = task * block, to = std::min(points, from + block);
        if (!stopped)
            singular += evaluation.add(from, to);
    });
    return singular;
}

/// What takes longer than starting a thread can be interrupted.
std::size_t evaluate_attended(const Request& r) {
    std::atomic<bool> stopped = false;
    std::size_t singular = 0;
    if (r.x.size() * r.rods.size() > 8 * block) {
        attended([&] { singular = evaluate(r, stopped); }, [] {}, [&] { stopped = true; });
        return singular;
    }
    const py::gil_scoped_release release;
    return evaluate(r, stopped);
}

std::vector<Source> sources_of(const Array& rods) {
    std::vector<Source> sources;
    for (py::ssize_t i = 0; i < rods.shape(0); ++i)
        sources.push_back({rods.at(i, 0), rods.at(i, 1), rods.at(i, 2)});
    return sources;
}

/// x and y of one length; the result has a row of 2 (strain: 4) numbers a point.
Array field(const char* name, Quantity quantity, const Array& x, const Array& y, const Medium& medium,
            const Array& rods, std::size_t threads) {
    Request request{
        medium, quantity, sources_of(rods), numbers(x), numbers(y), {}, std::max<std::size_t>(threads, 1)};
    Array out({x.size(), static_cast<py::ssize_t>(request.width())});
    request.out = {out.mutable_data(), static_cast<std::size_t>(out.size())};
    // It warns as NumPy does of 0/0, at the line that called rodwake.
    if (const std::size_t singular = evaluate_attended(request);
        singular > 0 &&
        PyErr_WarnFormat(PyExc_RuntimeWarning, 3,
                         "%s: NaN at %zu of %zu points, which are at a rod, where its field is singular, or "
                         "farther from it than 1e300 xi",
                         name, singular, request.x.size()) != 0)
        throw py::error_already_set();
    return out;
}

/// What the other rods make at each rod, and in a box its own images: lab components.
class InteractionOptions {
public:
    InteractionOptions(const std::vector<Source>& rods, const Medium& medium)
        : displacement_(2 * rods.size()), strain_(4 * rods.size()), gradient_(8 * rods.size()),
          laplacian_(2 * rods.size()), grad_div_(2 * rods.size()) {
        const auto field = elastic::exact_field(medium.elastic, medium.box);
        constexpr FieldRequest all{.displacement = true, .strain = true, .polar = true, .gradients = true};
        for (const Source& rod : rods) {
            const auto wake = field->wake(rod.heading);
            const double c = std::cos(rod.heading), s = std::sin(rod.heading);
            for (std::size_t a = 0; a < rods.size(); ++a) {
                const auto at = turned(elastic::Vector{rods[a].x - rod.x, rods[a].y - rod.y}, c, -s);
                if (&rods[a] != &rod)
                    add(a, wake->at(at.x, at.y, all), c, s);
                else if (medium.box)
                    add(a, wake->self_image_field(all), c, s);
            }
        }
    }

    py::tuple arrays() && {
        const auto n = static_cast<py::ssize_t>(displacement_.size() / 2);
        return py::make_tuple(
            array_of(std::move(displacement_), {n, 2}), array_of(std::move(strain_), {n, 2, 2}),
            array_of(std::move(gradient_), {n, 2, 2, 2}), array_of(std::move(laplacian_), {n, 2}),
            array_of(std::move(grad_div_), {n, 2}));
    }

private:
    static void add(const elastic::Vector& v, double* row) {
        row[0] += v.x;
        row[1] += v.y;
    }
    static void add(const elastic::SymmetricTensor& t, double factor, double* row) {
        const double values[] = {t.xx, t.xy, t.xy, t.yy};
        for (std::size_t k = 0; k < 4; ++k)
            row[k] += factor * values[k];
    }
    /// Values in the axes of a source with this heading.
    void add(std::size_t a, const FieldValues& f, double c, double s) {
        add(turned(f.displacement, c, s), &displacement_[2 * a]);
        add(turned(f.laplacian, c, s), &laplacian_[2 * a]);
        add(turned(f.gradient_of_trace, c, s), &grad_div_[2 * a]);
        add(turned(f.strain, c, s), 1.0, &strain_[4 * a]);
        const auto by_x = turned(f.strain_x, c, s),
                   by_y = turned(f.strain_y, c, s); // along the source's axes
        add(by_x, c, &gradient_[8 * a]);
        add(by_y, -s, &gradient_[8 * a]);
        add(by_x, s, &gradient_[8 * a + 4]);
        add(by_y, c, &gradient_[8 * a + 4]);
    }

    std::vector<double> displacement_, strain_, gradient_, laplacian_, grad_div_;
};

py::tuple wakes(const Array& poses, const Medium& medium) {
    rods::RodProblem problem = problem_of(poses, &medium, {});
    problem.t_end = 1.0; // means nothing here
    std::optional<InteractionOptions> sums;
    {
        const py::gil_scoped_release release;
        validate(problem);
        sums.emplace(sources_of(poses), medium);
    }
    return std::move(*sums).arrays();
}

} // namespace

void bind_fields(py::module_& module) {
    const std::pair<const char*, Quantity> quantities[] = {{"displacement", Quantity::displacement},
                                                           {"strain", Quantity::strain},
                                                           {"laplacian", Quantity::laplacian},
                                                           {"grad_div", Quantity::grad_div},
                                                           {"dipole", Quantity::dipole}};
    for (const auto& [name, quantity] : quantities)
        module.def(name,
                   [name = name, quantity = quantity](const Array& x, const Array& y, const Medium& medium,
                                                      const Array& rods, std::size_t threads) {
                       return field(name, quantity, x, y, medium, rods, threads);
                   });
    module.def("wakes", &wakes);
}

} // namespace rodwake::python
