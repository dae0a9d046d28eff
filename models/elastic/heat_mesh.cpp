#include "heat_mesh.hpp"

#include <boost/math/special_functions/bessel.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

namespace rodwake::elastic {

using fourier::Complex, fourier::Fft;

namespace {

double bessel_i0(double x) {
    using Policy = boost::math::policies::policy<boost::math::policies::promote_double<false>>;
    return boost::math::cyl_bessel_i(0, x, Policy());
}

} // namespace

MeshKernel::MeshKernel(std::size_t width)
    : width_(width), beta_(0.75 * std::numbers::pi * static_cast<double>(width)), top_(bessel_i0(beta_)),
      values_(pieces * terms * row()) {
    const double wide = 0.5 * static_cast<double>(width);
    for (std::size_t p = 0; p < pieces; ++p)
        for (std::size_t i = 0; i < width; ++i) {
            const std::vector<double> c = fourier::powers_of(terms, [&](double u) {
                const double z = (static_cast<double>(p) + 0.5 * (u + 1.0)) / pieces,
                             s = (z + static_cast<double>(i)) / wide - 1.0;
                return bessel_i0(beta_ * std::sqrt(std::max(0.0, 1.0 - s * s))) / top_;
            });
            for (std::size_t k = 0; k < terms; ++k)
                values_[(p * terms + k) * row() + i] = c[k];
        }
}

std::size_t MeshKernel::width_for(double cutoff) {
    return std::clamp(static_cast<std::size_t>(std::ceil(cutoff / 2.1)), narrowest, widest);
}

double MeshKernel::transform(double m, double grid) const {
    const auto width = static_cast<double>(width_);
    const double wave = std::numbers::pi * width * m / grid, z = std::sqrt(beta_ * beta_ - wave * wave);
    return width * std::sinh(z) / (z * top_);
}

namespace {

std::size_t whole(std::size_t count) { return (count + Fft::lanes - 1) / Fft::lanes * Fft::lanes; }

constexpr double oversampling = 1.2; // grid points a mode, at least

} // namespace

MeshGrid::MeshGrid(double box, std::size_t half_modes, std::size_t kernel_width, std::size_t field_count)
    : size(Fft::suitable(
          std::max(static_cast<std::size_t>(oversampling * static_cast<double>(2 * half_modes + 1)) + 1,
                   2 * kernel_width))),
      half(half_modes), width(kernel_width), pad(width / 2), fields(field_count),
      columns(whole(size + MeshKernel::widest + 1)), lines(size + width + 1),
      per_length(static_cast<double>(size) / box) {}

void HeatMesh::begin(double x, double y, double box, std::size_t half, ThreadPool& team) {
    team_ = &team;
    x_ = x;
    y_ = y;
    box_ = box;
    unit_ = 2.0 * std::numbers::pi / box;
    half_ = half;
    for (auto* item : {&ux_, &uy_})
        item->assign((2 * half + 1) * (half + 1), {});
}

const MeshKernel& HeatMesh::kernel(double cutoff) const {
    return kernels_[std::min(MeshKernel::width_for(cutoff) - MeshKernel::narrowest, kernels_.size() - 1)];
}

namespace {

/// Working space that each thread keeps: lines of `size`.
struct MeshLines {
    std::vector<Fft::Element> field[strain_parts], other;
};
MeshLines& lines(std::size_t size) {
    thread_local MeshLines kept;
    for (auto* item : {&kept.field[0], &kept.field[1], &kept.field[2], &kept.other})
        item->resize(size);
    return kept;
}

/// One number of each line.
void copy_lanes(const double* from, double* to) { std::memcpy(to, from, Fft::lanes * sizeof(double)); }

void clear(std::span<Fft::Element> all) { std::memset(all.data(), 0, all.size_bytes()); }

/// Ends of lines and columns that reach over are added where they belong: numbers `apart` from each other.
void fold(const MeshGrid& g, std::size_t apart, double* numbers, std::size_t length) {
    const auto add = [&](std::size_t from, std::size_t to) {
        for (std::size_t j = 0; j < length; ++j)
            numbers[to * apart + j] += numbers[from * apart + j];
    };
    for (std::size_t i = 0; i < g.pad; ++i)
        add(i, i + g.size);
    for (std::size_t i = g.size + g.pad; i < g.lines; ++i)
        add(i, i - g.size);
}

/// And the other way round.
void extend(const MeshGrid& g, std::size_t apart, double* numbers, std::size_t length) {
    for (std::size_t i = 0; i < g.pad; ++i)
        std::copy_n(numbers + (i + g.size) * apart, length, numbers + i * apart);
    for (std::size_t i = g.size + g.pad; i < g.lines; ++i)
        std::copy_n(numbers + (i - g.size) * apart, length, numbers + i * apart);
}

std::size_t place_of(const MeshGrid& g, std::size_t n) {
    return n >= g.half ? n - g.half : g.size + n - g.half; // of mode n - half
}

Complex times_i(Complex z) { return {-z.im, z.re}; }
/// What makes of the transform the one with the other sign, before and after it.
Complex swapped(Complex z) { return {z.im, z.re}; }

/// A field's mode from the displacement's.
Complex field_of(std::size_t field, double qx, double qy, Complex x, Complex y) {
    switch (field) {
    case 0:
        return times_i(qx * x);
    case 1:
        return times_i(0.5 * (qy * x + qx * y));
    case 2:
        return times_i(qy * y);
    case 3:
    case 4:
        return -(qx * qx + qy * qy) * (field == 3 ? x : y);
    default:
        return -(field == 5 ? qx : qy) * (qx * x + qy * y);
    }
}

} // namespace

/// Gaussians over the kernel's transform, by number of the mode.
std::vector<double> HeatMesh::gaussian(const MeshKernel& kernel, const MeshGrid& g, double spread) const {
    std::vector<double> all;
    for (std::size_t m = 0; m <= g.half; ++m)
        all.push_back(std::exp(-spread * wave(m) * wave(m)) /
                      kernel.transform(static_cast<double>(m), static_cast<double>(g.size)));
    return all;
}

void HeatMesh::reserve(const MeshGrid& g) {
    const std::size_t line = g.fields * g.columns, modes = whole(g.half + 1) * line;
    const auto grow = [](std::vector<double>& all, std::size_t count) {
        all.resize(std::max(all.size(), count));
    };
    grow(grid_, g.lines * line);
    grow(between_re_, modes);
    grow(between_im_, modes);
}

void HeatMesh::add(const NearSources& rods, const HeatNode& node, double cutoff, double margin, double felt) {
    const auto largest = static_cast<std::size_t>(std::ceil(std::sqrt(cutoff / node.time) / wave(1)));
    const MeshKernel& with = kernel(cutoff);
    const MeshGrid g(box_, std::min(half_, largest), with.width(), strain_parts);
    reserve(g);
    const MeshRods task{with,
                        g,
                        rods,
                        x_,
                        y_,
                        node.time,
                        (margin - felt) * g.per_length,
                        (box_ - margin + felt) * g.per_length};
    const std::size_t line = g.fields * g.columns, threads = team_->started(),
                      slabs = threads == 1 ? 1 : 4 * threads;
    team_->run(slabs, [&](std::size_t slab) {
        const std::size_t begin = g.lines * slab / slabs, end = g.lines * (slab + 1) / slabs;
        std::fill(&grid_[begin * line], &grid_[0] + end * line, 0.0);
        spread_rods(task, begin, end, grid_.data());
        for (std::size_t k = begin * g.fields; k < end * g.fields; ++k)
            fold(g, 1, &grid_[k * g.columns], 1);
    });
    fold(g, line, grid_.data(), line);
    const Fft& fft = ffts_.try_emplace(g.size, g.size).first->second;
    team_->run(line / Fft::lanes, [&](std::size_t block) { // columns of fields to m
        const std::size_t first = block * Fft::lanes;
        MeshLines& work = lines(g.size);
        for (std::size_t i = 0; i < g.size; ++i) {
            copy_lanes(&grid_[(i + g.pad) * line + first], work.field[0][i].re);
            std::memset(work.field[0][i].im, 0, sizeof(work.field[0][i].im));
        }
        fft.transform(work.field[0], work.other);
        for (std::size_t m = 0; m <= g.half; ++m) {
            copy_lanes(work.field[0][m].re, &between_re_[m * line + first]);
            copy_lanes(work.field[0][m].im, &between_im_[m * line + first]);
        }
    });
    const Weights weights{node.weight / (box_ * box_), gaussian(with, g, node.time),
                          gaussian(with, g, diffusivity_ * node.time)};
    team_->run(whole(g.half + 1) / Fft::lanes, [&](std::size_t block) { add_modes(g, fft, weights, block); });
}

/// Lines m to n, and to the displacement.
void HeatMesh::add_modes(const MeshGrid& g, const Fft& fft, const Weights& weights, std::size_t block) {
    MeshLines& work = lines(g.size);
    const std::size_t first = block * Fft::lanes, count = std::min(Fft::lanes, g.half + 1 - first);
    for (std::size_t field = 0; field < strain_parts; ++field) {
        for (std::size_t lane = 0; lane < count; ++lane) {
            const std::size_t from = ((first + lane) * g.fields + field) * g.columns + g.pad;
            for (std::size_t j = 0; j < g.size; ++j)
                set_lane(work.field[field][j], lane, {between_re_[from + j], between_im_[from + j]});
        }
        fft.transform(work.field[field], work.other);
    }
    for (std::size_t n = 0; n <= 2 * g.half; ++n) {
        const std::size_t at = place_of(g, n), k = n > g.half ? n - g.half : g.half - n;
        const double qy = n < g.half ? -wave(k) : wave(k), shear_n = weights.node * weights.shear[k],
                     wide_n = weights.node * diffusivity_ * weights.longitudinal[k];
        Complex *x = &ux_[(n + half_ - g.half) * (half_ + 1) + first],
                *y = &uy_[(n + half_ - g.half) * (half_ + 1) + first];
        for (std::size_t lane = 0; lane < count; ++lane) {
            const std::size_t m = first + lane;
            const double shear = shear_n * weights.shear[m], both = shear - wide_n * weights.longitudinal[m];
            const Complex gradient = times_i(both * lane_of(work.field[0][at], lane));
            x[lane] = x[lane] + shear * lane_of(work.field[1][at], lane) + wave(m) * gradient;
            y[lane] = y[lane] + shear * lane_of(work.field[2][at], lane) + qy * gradient;
        }
    }
}

void HeatMesh::read(const NearSources& rods, double cutoff, std::span<double* const> sums) {
    const MeshKernel& with = kernel(cutoff);
    const MeshGrid g(box_, half_, with.width(), sums.size());
    reserve(g);
    const Fft& fft = ffts_.try_emplace(g.size, g.size).first->second;
    const std::vector<double> inverse = gaussian(with, g, 0.0);
    const std::size_t blocks = whole(g.half + 1) / Fft::lanes, line = g.fields * g.columns;
    team_->run(g.fields * blocks, [&](std::size_t task) { // a field's modes to lines
        MeshLines& work = lines(g.size);
        auto& data = work.field[0];
        const std::size_t field = task / blocks, first = task % blocks * Fft::lanes,
                          count = std::min(Fft::lanes, g.half + 1 - first);
        clear(data);
        for (std::size_t n = 0; n <= 2 * g.half; ++n) {
            const std::size_t k = n > g.half ? n - g.half : g.half - n;
            const double qy = n < g.half ? -wave(k) : wave(k);
            for (std::size_t lane = 0; lane < count; ++lane) {
                const std::size_t m = first + lane, i = n * (half_ + 1) + m;
                set_lane(data[place_of(g, n)], lane,
                         swapped(inverse[k] * inverse[m] * field_of(field, wave(m), qy, ux_[i], uy_[i])));
            }
        }
        fft.transform(data, work.other);
        for (std::size_t lane = 0; lane < count; ++lane)
            for (std::size_t j = 0; j < g.size; ++j) {
                const std::size_t to = ((first + lane) * g.fields + field) * g.columns + g.pad + j;
                between_re_[to] = data[j].im[lane];
                between_im_[to] = data[j].re[lane];
            }
    });
    team_->run(line / Fft::lanes, [&](std::size_t block) { // modes to columns
        const std::size_t first = block * Fft::lanes;
        MeshLines& work = lines(g.size);
        auto& data = work.field[0];
        clear(data);
        for (std::size_t m = 0; m <= g.half; ++m)
            for (std::size_t lane = 0; lane < Fft::lanes; ++lane) {
                const Complex z{between_re_[m * line + first + lane], between_im_[m * line + first + lane]};
                set_lane(data[m == 0 ? 0 : g.size - m], lane, {-z.im, z.re}); // the mode -m: its conjugate
                set_lane(data[m], lane, swapped(z));
            }
        fft.transform(data, work.other);
        for (std::size_t i = 0; i < g.size; ++i)
            copy_lanes(data[i].im, &grid_[(i + g.pad) * line + first]);
    });
    for (std::size_t k = g.pad * g.fields; k < (g.pad + g.size) * g.fields; ++k)
        extend(g, 1, &grid_[k * g.columns], 1);
    extend(g, line, grid_.data(), line);
    const MeshRods task{with, g, rods, x_, y_, 0.0, 0.0, static_cast<double>(g.size)};
    team_->run(whole(rods.count) / heat_lanes,
               [&](std::size_t k) { read_rods(task, k * heat_lanes, g.fields, grid_.data(), sums.data()); });
}

} // namespace rodwake::elastic
