#pragma once
// Trajectories as H5MD 1.1, in the form that h5py, MDAnalysis and VMD read. The file appears at commit.
//
//   particles/trajectory        every sphere: position (wrapped), image, velocity, id, box/edges in time;
//                               species, mass, radius
//   particles/trajectory_rods   the rods, if there are any: position (of the centre of mass, wrapped), image,
//                               velocity, orientation (quaternion, real part first, body to world),
//                               angular_momentum, id, box; mass
//   observables/<name>          one number a frame
//   parameters                  named numbers (attributes), units, kinds (number of each species),
//                               rod_of_sphere
//   rodwake                     version, command, seed and other texts
//
// Absolute position = position + image * L. Everything in time shares one `step` and `time` by hard links.
// Box edges are the 3 x 3 matrix of the spec's general form: MDAnalysis takes the shorter vector form for no
// box. SI units throughout; there are no `unit` attributes, because MDAnalysis refuses files with units that
// it does not know (pass convert_units=False).

#include "rodwake/store/frames.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace rodwake::store {

struct H5mdInfo {
    std::string author = "unknown";
    std::string version; ///< of rodwake
    std::string command;
    std::uint64_t seed = 0;
    std::vector<std::pair<std::string, double>> parameters; ///< SI
    std::vector<std::pair<std::string, std::string>> texts; ///< further attributes of group rodwake
    bool deflate = false;                                   ///< smaller and slower
};

class H5mdWriter {
public:
    /// Throws InputError for a layout that is none (check_layout), RunError if the file cannot be made.
    H5mdWriter(const std::filesystem::path& target, FrameLayout layout, const H5mdInfo& info);
    ~H5mdWriter();
    H5mdWriter(const H5mdWriter&) = delete;
    H5mdWriter& operator=(const H5mdWriter&) = delete;
    H5mdWriter(H5mdWriter&&) = delete;
    H5mdWriter& operator=(H5mdWriter&&) = delete;

    /// Throws RunError for a frame that does not fit (check_frame) or cannot be written.
    void add_frame(const Frame& frame);
    /// Closes and renames the file into place. Throws RunError with the system's reason.
    void commit();

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace rodwake::store
