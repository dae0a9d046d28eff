#pragma once
// Reads trajectories of beds as H5mdWriter writes them (h5md.hpp), frame by frame, exactly the stored bits.
// Bodies with an `id` come in the order of the first frame, whatever row they have; numbers with a `unit`
// come in SI. Species 0 are the beads: the first particles of a frame. Of a rod its centre of mass and its
// orientation are read, and the places of its spheres, by which pictures draw it.
//
// A file that is none of these, is cut short, damaged, or holds what cannot be (values that are not finite,
// places outside the box, a box that changes, steps or times that do not increase) is an InputError that
// names the file.

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace rodwake::store {

/// What is the same in every frame, and when the frames are. SI.
struct TrajectoryInfo {
    std::array<double, 3> box{}; ///< sides, m
    bool periodic = true;        ///< in x and y; false: a wall, round if the parameters have wall_radius
    std::size_t particles = 0;   ///< beads and spheres of rods
    std::size_t beads = 0, rods = 0;
    double bead_radius =
        0.0; ///< of all beads, m; if they differ, the parameter bead_radius, which lengths refer to
    double bead_mass = 0.0;     ///< mean, kg
    std::vector<double> radius; ///< [beads], m
    std::map<std::string, double> parameters;
    std::uint64_t seed = 0;
    std::vector<std::int64_t> step; ///< [frames], increasing
    std::vector<double> time;       ///< [frames], s, increasing

    std::size_t frames() const { return step.size(); }
};

/// Centre of mass of a rod: place in the box and number of the box.
struct StoredRod {
    double x = 0.0, y = 0.0; ///< m, in [0, box)
    std::int32_t image_x = 0, image_y = 0;
    std::array<double, 4> orientation{}; ///< quaternion, real part first, body to world; not 0
};

struct StoredFrame {
    std::int64_t step = 0;
    double time = 0.0;                          ///< s
    std::vector<double> x, y;                   ///< [beads], m, in [0, box)
    std::vector<double> z;                      ///< [beads], m
    std::vector<std::int32_t> image_x, image_y; ///< [beads], number of the box
    std::vector<double> vx, vy, vz;             ///< [beads], m/s
    std::vector<StoredRod> rods;                ///< [rods]
};

class H5mdReader {
public:
    /// Reads and checks everything but the frames themselves. Throws InputError.
    explicit H5mdReader(const std::filesystem::path& path);
    ~H5mdReader();
    H5mdReader(H5mdReader&&) noexcept;
    H5mdReader& operator=(H5mdReader&&) noexcept;

    const TrajectoryInfo& info() const;
    /// Frame `frame` < info().frames(); the vectors of `out` are used again. Throws InputError.
    void read(std::size_t frame, StoredFrame& out);

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace rodwake::store
