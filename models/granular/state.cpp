#include "rodwake/granular/state.hpp"

#include "rodwake/core/repeatable_math.hpp"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <algorithm>
#include <cmath>

namespace rodwake::granular {

namespace {

class Hash {
public:
    Hash() { XXH3_64bits_reset(&state_); }
    void add(const void* bytes, std::size_t count) { XXH3_64bits_update(&state_, bytes, count); }
    void add(std::int64_t number) { add(&number, sizeof number); }
    void add(const std::vector<double>& numbers) { add(numbers.data(), numbers.size() * sizeof(double)); }
    void add(const Eigen::Vector3d& vector) { add(vector.data(), 3 * sizeof(double)); }
    std::uint64_t value() const { return XXH3_64bits_digest(&state_); }

private:
    XXH3_state_t state_;
};

void put(std::vector<double>& out, const Eigen::Vector3d& v) { out.insert(out.end(), {v.x(), v.y(), v.z()}); }

} // namespace

void Beads::resize(std::size_t count) {
    for (auto* array : {&x, &y, &z, &vx, &vy, &vz, &wx, &wy, &wz})
        array->resize(count, 0.0);
}

double RodBody::heading() const {
    const Eigen::Vector3d along = axis();
    const double angle = repeatable::atan2(along.y(), along.x());
    return angle == -M_PI ? M_PI : angle; // atan2(-0, -1)
}

std::vector<double> sphere_positions(const State& state, std::span<const Clump> clumps) {
    std::vector<double> out;
    const Beads& b = state.beads;
    for (std::size_t i = 0; i < b.size(); ++i)
        put(out, {b.x[i], b.y[i], b.z[i]});
    for (std::size_t r = 0; r < state.rods.size(); ++r)
        for (const double offset : clumps[r].offset)
            put(out, state.rods[r].position + offset * state.rods[r].axis());
    return out;
}

std::vector<double> sphere_velocities(const State& state, std::span<const Clump> clumps) {
    std::vector<double> out;
    const Beads& b = state.beads;
    for (std::size_t i = 0; i < b.size(); ++i)
        put(out, {b.vx[i], b.vy[i], b.vz[i]});
    for (std::size_t r = 0; r < state.rods.size(); ++r) {
        const RodBody& rod = state.rods[r];
        // the part of the spin across the axis is L/I_t there, and the part along it moves no centre
        const Eigen::Vector3d turning = rod.angular_momentum.cross(rod.axis()) / clumps[r].transverse_inertia;
        for (const double offset : clumps[r].offset)
            put(out, rod.velocity + offset * turning);
    }
    return out;
}

std::uint64_t state_hash(const State& state) {
    Hash hash;
    hash.add(state.step);
    hash.add(static_cast<std::int64_t>(state.beads.size()));
    hash.add(static_cast<std::int64_t>(state.rods.size()));
    const Beads& b = state.beads;
    for (const auto* array : {&b.x, &b.y, &b.z, &b.vx, &b.vy, &b.vz, &b.wx, &b.wy, &b.wz})
        hash.add(*array);
    if (std::ranges::adjacent_find(b.radius, std::ranges::not_equal_to()) != b.radius.end())
        hash.add(b.radius);
    for (const RodBody& rod : state.rods) {
        hash.add(rod.position);
        hash.add(rod.velocity);
        hash.add(rod.orientation.coeffs().data(), 4 * sizeof(double)); // x y z w
        hash.add(rod.angular_momentum);
    }
    return hash.value();
}

std::uint64_t combined_hash(const std::vector<std::uint64_t>& hashes) {
    Hash hash;
    for (const std::uint64_t one : hashes)
        hash.add(static_cast<std::int64_t>(one));
    return hash.value();
}

} // namespace rodwake::granular
