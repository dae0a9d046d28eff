// Rods on meshes. Compiled once for each instruction set (foreach_target includes this file again); sums have
// one order, so that bits are the same.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "heat_points.cpp"
#include <hwy/foreach_target.h> // IWYU pragma: keep
#include <hwy/highway.h>

#include "heat_mesh.hpp"
#include "vector_math_inl.hpp"

#include <algorithm>

HWY_BEFORE_NAMESPACE();
namespace rodwake::elastic::HWY_NAMESPACE {

constexpr std::size_t mesh_lanes = heat_lanes;
using Lanes = hn::CappedTag<double, mesh_lanes>;
using V = hn::Vec<Lanes>;

/// What a vector of rods covers, by axis: first line and column, and the kernel's numbers there.
template<std::size_t row>
struct Covers {
    double within[mesh_lanes]; ///< less than 0: not meant
    std::int64_t first[2][mesh_lanes], piece[2][mesh_lanes];
    double u[2][mesh_lanes];
    double kernel[2][mesh_lanes][row];
};

template<std::size_t row>
HWY_INLINE void PlaceAlong(const MeshRods& task, int axis, std::size_t from, Covers<row>& covers) {
    const Lanes d;
    const hn::RebindToSigned<Lanes> i;
    const auto set = [](double value) HWY_ATTR { return hn::Set(Lanes(), value); };
    constexpr auto pieces = static_cast<double>(MeshKernel::pieces);
    const double *positions = (axis == 0 ? task.rods.x : task.rods.y).data() + from,
                 *headings = (axis == 0 ? task.rods.cosine : task.rods.sine).data() + from;
    for (std::size_t k = 0; k < mesh_lanes; k += hn::Lanes(d)) {
        const V then = Fnma(d, hn::LoadU(d, headings + k), set(task.time), hn::LoadU(d, positions + k));
        const V at = hn::Mul(hn::Sub(then, set(axis == 0 ? task.x : task.y)), set(task.grid.per_length)),
                edge = hn::Sub(at, set(0.5 * static_cast<double>(task.grid.width))), first = hn::Ceil(edge),
                z = hn::Mul(set(pieces), hn::Sub(first, edge)),
                piece = hn::Min(hn::Floor(z), set(pieces - 1.0)), rest = hn::Sub(z, piece);
        const V inside = hn::Min(hn::Sub(at, set(task.lowest)), hn::Sub(set(task.highest), at));
        hn::StoreU(axis == 0 ? inside : hn::Min(inside, hn::LoadU(d, covers.within + k)), d,
                   covers.within + k);
        hn::StoreU(hn::ConvertTo(i, first), i, covers.first[axis] + k);
        hn::StoreU(hn::ConvertTo(i, piece), i, covers.piece[axis] + k);
        hn::StoreU(hn::Sub(hn::Add(rest, rest), set(1.0)), d, covers.u[axis] + k);
    }
}

/// Of rods from `from` on: a rod a lane for their places, then a point of the kernel a lane.
template<std::size_t row>
HWY_INLINE void CoverRods(const MeshRods& task, std::size_t from, Covers<row>& covers) {
    const Lanes d;
    for (const int axis : {0, 1}) {
        PlaceAlong(task, axis, from, covers);
        for (std::size_t k = 0; k < mesh_lanes; ++k) {
            if (!(covers.within[k] >= 0.0))
                continue;
            const double* c = task.kernel.values() +
                              static_cast<std::size_t>(covers.piece[axis][k]) * MeshKernel::terms * row;
            const V u = hn::Set(d, covers.u[axis][k]);
            for (std::size_t j = 0; j < row; j += hn::Lanes(d)) {
                V sum = hn::LoadU(d, c + (MeshKernel::terms - 1) * row + j);
                for (std::size_t term = MeshKernel::terms - 1; term-- > 0;)
                    sum = Fma(d, sum, u, hn::LoadU(d, c + term * row + j));
                hn::StoreU(sum, d, covers.kernel[axis][k] + j);
            }
            covers.first[axis][k] += static_cast<std::int64_t>(task.grid.pad);
        }
    }
}

template<std::size_t row>
constexpr std::size_t VectorsOf() {
    return (row + hn::MaxLanes(Lanes()) - 1) / hn::MaxLanes(Lanes());
}

/// Adds a rod's numbers 1, n_x, n_y to lines from `begin` to `end`.
template<std::size_t row>
HWY_INLINE void SpreadRod(const MeshRods& task, const Covers<row>& covers, std::size_t k, double cosine,
                          double sine, std::size_t begin, std::size_t end, double* to) {
    const Lanes d;
    constexpr std::size_t vectors = VectorsOf<row>();
    const std::size_t first = static_cast<std::size_t>(covers.first[0][k]), columns = task.grid.columns,
                      last = std::min(first + task.grid.width, end);
    V part[strain_parts][vectors];
    RODWAKE_UNROLL
    for (std::size_t v = 0; v < vectors; ++v) {
        part[0][v] = hn::LoadU(d, covers.kernel[1][k] + v * hn::Lanes(d));
        part[1][v] = hn::Mul(part[0][v], hn::Set(d, cosine));
        part[2][v] = hn::Mul(part[0][v], hn::Set(d, sine));
    }
    double* at = to + std::max(first, begin) * strain_parts * columns + covers.first[1][k];
    for (std::size_t line = std::max(first, begin); line < last; ++line) {
        const V factor = hn::Set(d, covers.kernel[0][k][line - first]);
        RODWAKE_UNROLL
        for (std::size_t field = 0; field < strain_parts; ++field, at += columns)
            RODWAKE_UNROLL
        for (std::size_t v = 0; v < vectors; ++v) {
            double* const here = at + v * hn::Lanes(d);
            hn::StoreU(Fma(d, factor, part[field][v], hn::LoadU(d, here)), d, here);
        }
    }
}

template<std::size_t row>
HWY_NOINLINE void SpreadRow(const MeshRods& task, std::size_t begin, std::size_t end, double* to) {
    Covers<row> covers;
    const NearSources& rods = task.rods;
    for (std::size_t from = 0; from < rods.count; from += mesh_lanes) {
        CoverRods(task, from, covers);
        for (std::size_t k = 0; k < std::min(mesh_lanes, rods.count - from); ++k)
            if (covers.within[k] >= 0.0 && static_cast<std::size_t>(covers.first[0][k]) < end)
                SpreadRod(task, covers, k, rods.cosine[from + k], rods.sine[from + k], begin, end, to);
    }
}

void SpreadRods(const MeshRods& task, std::size_t begin, std::size_t end, double* to) {
    (task.kernel.row() == 8 ? SpreadRow<8> : SpreadRow<16>)(task, begin, end, to);
}

/// Sum of a row in one order.
template<std::size_t row>
HWY_INLINE double SumOf(const double* v) {
    double four[4];
    for (std::size_t k = 0; k < 4; ++k)
        four[k] = row == 8 ? v[k] + v[k + 4] : (v[k] + v[k + 4]) + (v[k + row - 8] + v[k + row - 4]);
    return (four[0] + four[2]) + (four[1] + four[3]);
}

template<std::size_t row, std::size_t fields>
HWY_INLINE void ReadRod(const MeshRods& task, const Covers<row>& covers, std::size_t k, const double* from,
                        std::array<double, fields>& sums) {
    const Lanes d;
    const std::size_t columns = task.grid.columns;
    double part[fields][row];
    for (std::size_t j = 0; j < row; j += hn::Lanes(d)) {
        V sum[fields];
        RODWAKE_UNROLL
        for (std::size_t field = 0; field < fields; ++field)
            sum[field] = hn::Zero(d);
        const double* at =
            from + static_cast<std::size_t>(covers.first[0][k]) * fields * columns + covers.first[1][k] + j;
        for (std::size_t i = 0; i < task.grid.width; ++i) {
            const V factor = hn::Set(d, covers.kernel[0][k][i]);
            RODWAKE_UNROLL
            for (std::size_t field = 0; field < fields; ++field, at += columns)
                sum[field] = Fma(d, factor, hn::LoadU(d, at), sum[field]);
        }
        const V across = hn::LoadU(d, covers.kernel[1][k] + j);
        RODWAKE_UNROLL
        for (std::size_t field = 0; field < fields; ++field)
            hn::StoreU(hn::Mul(sum[field], across), d, part[field] + j);
    }
    for (std::size_t field = 0; field < fields; ++field)
        sums[field] = SumOf<row>(part[field]);
}

template<std::size_t row, std::size_t fields>
HWY_NOINLINE void ReadRow(const MeshRods& task, std::size_t from, const double* grid, double* const* sums) {
    Covers<row> covers;
    CoverRods(task, from, covers);
    for (std::size_t k = 0; k < std::min(mesh_lanes, task.rods.count - from); ++k) {
        std::array<double, fields> read;
        ReadRod<row>(task, covers, k, grid, read);
        for (std::size_t field = 0; field < fields; ++field)
            sums[field][from + k] += read[field];
    }
}

/// Adds the fields at a vector of rods.
void ReadRods(const MeshRods& task, std::size_t from, std::size_t fields, const double* grid,
              double* const* sums) {
    const bool narrow = task.kernel.row() == 8;
    const auto read = fields == strain_parts ? narrow ? ReadRow<8, strain_parts> : ReadRow<16, strain_parts>
                      : narrow ? ReadRow<8, all_parts>
                                             : ReadRow<16, all_parts>;
    read(task, from, grid, sums);
}

} // namespace rodwake::elastic::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rodwake::elastic {

HWY_EXPORT(SpreadRods);
HWY_EXPORT(ReadRods);

void spread_rods(const MeshRods& task, std::size_t begin, std::size_t end, double* to) {
    HWY_DYNAMIC_DISPATCH(SpreadRods)(task, begin, end, to);
}

void read_rods(const MeshRods& task, std::size_t from, std::size_t fields, const double* grid,
               double* const* sums) {
    HWY_DYNAMIC_DISPATCH(ReadRods)(task, from, fields, grid, sums);
}

} // namespace rodwake::elastic
#endif
