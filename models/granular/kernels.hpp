#pragma once
// The two loops that every step runs over all beads and all near pairs, with vector instructions chosen at
// run time (Highway). Positions and velocities are packed rows x, y, z and one more number (bodies.hpp).
// Every target gives the same bits: no sum is reordered and no product is fused.

#include "rodwake/core/parallel.hpp"
#include "rodwake/core/periodic.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <new>
#include <vector>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace rodwake::granular {

// Storage of packed rows x, y, z, 0 and of what else every step goes through. It starts on a cache line, so
// that no row and no vector of two rows straddles one: measured, this makes the flight of the beads 1.6 times
// faster. What is large is asked for in large pages: a processor knows the places of some 3000 pages, which
// at 4 kB each are those of 40 000 beads.

template<class T>
struct LineAligned {
    using value_type = T;
    static constexpr std::size_t line = 64, large_page = std::size_t{1} << 21;
    LineAligned() = default;
    template<class U>
    LineAligned(const LineAligned<U>&) {}
    static std::align_val_t alignment(std::size_t n) {
        return std::align_val_t{n * sizeof(T) < large_page ? line : large_page};
    }
    T* allocate(std::size_t n) {
        std::size_t bytes = n * sizeof(T);
        const bool large = bytes >= large_page;
        if (large) // whole pages
            bytes = (bytes + large_page - 1) / large_page * large_page;
        void* p = ::operator new(bytes, alignment(n));
#ifdef MADV_HUGEPAGE
        if (large)
            madvise(p, bytes, MADV_HUGEPAGE); // a wish: no harm if it is not granted
#endif
        return static_cast<T*>(p);
    }
    void deallocate(T* p, std::size_t n) { ::operator delete(p, alignment(n)); }
    bool operator==(const LineAligned&) const = default;
};

using Rows = std::vector<double, LineAligned<double>>;
using Vector3 = Eigen::Vector3d;

inline auto row(Rows& rows, std::size_t i) { return Eigen::Map<Vector3>(&rows[4 * i]); }
inline auto row(const Rows& rows, std::size_t i) { return Eigen::Map<const Vector3>(&rows[4 * i]); }

struct Pair {
    std::uint32_t first, second; ///< first < second
};

/// Smallest and largest of a quantity over many bodies, per axis (and a fourth lane that stays 0).
struct BodyRange {
    double low[4], high[4];

    static BodyRange empty();
    void include(const BodyRange& other);
    void include(const double* row);
    /// No body is faster in the plane.
    double fastest_in_plane() const;
};

struct Drift {
    double step, gravity;
    double lowest, highest; ///< z between which a bead touches no plate
    bool own_radii = false; ///< these are the plates' heights: each bead keeps its radius, the fourth number
                            ///< of its position, away from them
};

/// Free flight of beads [begin, end) over one step: x += v dt - g dt^2/2, v -= g dt. Adds the beads that end
/// outside (lowest, highest), NaN among them, to `out`, and their velocities before the step to `velocities`,
/// whose fourth numbers are 0.
void drift(double* position, double* velocity, std::size_t begin, std::size_t end, const Drift& drift,
           BodyRange& velocities, std::vector<std::uint32_t>& out);

/// Where all radii are equal a pair has no number of its own: a step reads half as much.
struct PairList {
    std::vector<Pair, LineAligned<Pair>> pairs;
    double common = 0.0; ///< sum of the radii of every pair, m; 0: they differ
    Rows reach;          ///< that of each, m; empty if it is common

    std::size_t size() const { return pairs.size(); }
    double reach_of(std::size_t k) const { return reach.empty() ? common : reach[k]; }
    void clear();
    void resize(std::size_t count);
    void copy(std::size_t to, const PairList& other, std::size_t from) {
        pairs[to] = other.pairs[from];
        if (!reach.empty())
            reach[to] = other.reach[from];
    }
};

/// One list of all, in their order; where each begins, and the end.
std::vector<std::size_t> gather(const std::vector<PairList>& parts, ThreadPool& team, PairList& list);

/// Pairs of [begin, end) that overlap in space now: their indices in the list, and how many. `found` has room
/// for end - begin + 8.
std::size_t overlapping(const double* position, const PairList& list, std::size_t begin, std::size_t end,
                        const PeriodicBox& box, std::uint32_t* found);

/// Pairs of [begin, end) nearer in the plane than their reach and `allowance`.
std::size_t within_reach(const double* position, const PairList& list, std::size_t begin, std::size_t end,
                         const PeriodicBox& box, double allowance, std::uint32_t* found);

/// product[k] = sum of a[i] b[k - i] over i = 0 to order, rising, for k < product_lanes; b is read from
/// -order to product_lanes - 1.
inline constexpr int product_lanes = 32;
void series_product(const double* a, int order, const double* b, double* product);

/// The largest distance in the plane between the same rows [begin, end) of two arrays.
double furthest_moved(const Rows& position, const Rows& before, std::size_t begin, std::size_t end);

} // namespace rodwake::granular
