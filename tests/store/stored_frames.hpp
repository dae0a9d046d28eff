#pragma once
// Samples as a trajectory, and whether a frame that was read is the sample to the last bit.

#include "rodwake/store/h5md.hpp"
#include "rodwake/store/h5md_reader.hpp"

#include "sample_frames.hpp"
#include "scratch.hpp"

#include <algorithm>
#include <bit>

namespace store_test {

inline void write_h5md(const fs::path& path, const SampleFrames& samples, bool deflate = false) {
    store::H5mdInfo info;
    info.seed = 18446744073709551615U;
    info.parameters = {{"time_step", 2e-5}, {"phi_b", 0.8}};
    info.deflate = deflate;
    store::H5mdWriter out(path, samples.layout, info);
    for (std::size_t k = 0; k < samples.frames.size(); ++k)
        out.add_frame(samples.frame(k));
    out.commit();
}

inline SampleFrames without_rods() {
    SampleFrames samples;
    auto& layout = samples.layout;
    layout.rod_id.clear();
    layout.rod_mass.clear();
    layout.rod_of_sphere.clear();
    layout.species.assign(layout.species.size(), 0);
    layout.mass.assign(layout.species.size(), 7.2e-7);
    layout.radius.assign(layout.species.size(), 4e-4);
    for (auto& frame : samples.frames)
        frame.rod_position = frame.rod_velocity = frame.rod_orientation = frame.rod_angular_momentum = {};
    return samples;
}

/// 0 and -0 differ.
inline bool same_bits(double a, double b) {
    return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

inline bool beads_are(const store::StoredFrame& found, const SampleFrames& samples, std::size_t k) {
    const auto& wanted = samples.frames.at(k);
    const store::WrappedVectors at = store::wrap(wanted.position, samples.layout);
    const auto beads = static_cast<std::size_t>(std::ranges::count(samples.layout.species, 0));
    bool same = found.step == wanted.step && same_bits(found.time, wanted.time) && found.x.size() == beads &&
                found.y.size() == beads && found.image_x.size() == beads && found.image_y.size() == beads &&
                found.vx.size() == beads && found.vy.size() == beads && found.z.size() == beads &&
                found.vz.size() == beads;
    for (std::size_t i = 0; same && i < beads; ++i)
        same = same_bits(found.x[i], at.place[3 * i]) && same_bits(found.y[i], at.place[3 * i + 1]) &&
               found.image_x[i] == at.image[3 * i] && found.image_y[i] == at.image[3 * i + 1] &&
               same_bits(found.vx[i], wanted.velocity[3 * i]) &&
               same_bits(found.vy[i], wanted.velocity[3 * i + 1]) &&
               same_bits(found.z[i], at.place[3 * i + 2]) &&
               same_bits(found.vz[i], wanted.velocity[3 * i + 2]);
    return same;
}

inline bool rods_are(const store::StoredFrame& found, const SampleFrames& samples, std::size_t k) {
    const auto& wanted = samples.frames.at(k);
    const store::WrappedVectors at = store::wrap(wanted.rod_position, samples.layout);
    bool same = found.rods.size() == samples.layout.rods();
    for (std::size_t i = 0; same && i < found.rods.size(); ++i) {
        const store::StoredRod& rod = found.rods[i];
        same = same_bits(rod.x, at.place[3 * i]) && same_bits(rod.y, at.place[3 * i + 1]) &&
               rod.image_x == at.image[3 * i] && rod.image_y == at.image[3 * i + 1];
        for (std::size_t c = 0; c < 4; ++c)
            same = same && same_bits(rod.orientation[c], wanted.rod_orientation[4 * i + c]);
    }
    return same;
}

inline bool is_frame(const store::StoredFrame& found, const SampleFrames& samples, std::size_t k) {
    return beads_are(found, samples, k) && rods_are(found, samples, k);
}

/// Whether all frames of the file are the samples; throws what the reader throws.
inline bool holds(const fs::path& path, const SampleFrames& samples) {
    store::H5mdReader reader(path);
    store::StoredFrame frame;
    bool same = reader.info().frames() == samples.frames.size();
    for (std::size_t k = 0; k < reader.info().frames(); ++k) {
        reader.read(k, frame);
        same = same && is_frame(frame, samples, k);
    }
    return same;
}

} // namespace store_test
