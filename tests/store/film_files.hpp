#pragma once
// A short film in every format that has a reader.

#include "rodwake/store/gsd.hpp"
#include "rodwake/store/h5md.hpp"
#include "rodwake/store/track_file.hpp"
#include "sample_frames.hpp"
#include "scratch.hpp"

#include <cstring>
#include <string>

namespace store_test {

/// Particles 4 and 5 at steps 0, 100 and 200; 5 goes through the edge of the box. Times, if any, are 0.1 s
/// apart.
inline std::string dump_of(bool with_times) {
    const char* atoms[] = {"4 1 1 2 0\n5 2 3 2.5 0\n", "5 2 9.5 2.5 0\n4 1 1.25 2 0\n",
                           "4 1 1.5 2 0\n5 2 9 2.5 0\n"};
    std::string text;
    for (int k = 0; k < 3; ++k)
        text += (with_times ? "ITEM: TIME\n0." + std::to_string(k) + "\n" : "") + "ITEM: TIMESTEP\n" +
                std::to_string(100 * k) +
                "\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS pp pp ff\n0 10\n0 8\n0 1\nITEM: ATOMS id type "
                "x y z\n" +
                atoms[k];
    return text;
}
inline const std::string dump_film = dump_of(false);

inline const std::string xyz_film = [] {
    const char* atoms[] = {"A 1 2 0 4 bead\nB 3 2.5 0 5 rod\n", "B 9.5 2.5 0 5 rod\nA 1.25 2 0 4 bead\n",
                           "A 1.5 2 0 4 bead\nB 9 2.5 0 5 rod\n"};
    std::string text;
    for (int k = 0; k < 3; ++k)
        text += "2\nLattice=\"10 0 0 0 8 0 0 0 1\" Properties=species:S:1:pos:R:3:id:I:1:kind:S:1 pbc=\"T T "
                "F\" Time=0." +
                std::to_string(k) + " Step=" + std::to_string(100 * k) + "\n" + atoms[k];
    return text;
}();

inline const std::string csv_film =
    "frame,particle,x,y\n0,4,1,2\n0,5,3,2.5\n1,4,1.25,2\n1,5,9.5,2.5\n2,4,1.5,2\n2,5,9,2.5\n";

template<class Writer>
void write_samples(Writer& out, const SampleFrames& samples) {
    for (std::size_t k = 0; k < samples.frames.size(); ++k)
        out.add_frame(samples.frame(k));
    out.commit();
}

inline void write_gsd_film(const fs::path& path) {
    const SampleFrames samples;
    store::GsdWriter out(path, samples.layout);
    write_samples(out, samples);
}

inline void write_h5md_film(const fs::path& path) {
    const SampleFrames samples;
    store::H5mdWriter out(path, samples.layout, {});
    write_samples(out, samples);
}

inline rodwake::TrackRows read_film(const fs::path& file, const store::TrackColumns& columns = {}) {
    return store::read_tracks(file, store::TrackFormat::automatic, columns, [](double) { return true; });
}

} // namespace store_test
