#pragma once
// A small made-up run: beads and two rods that wander through the edges of the box.

#include "rodwake/core/rng.hpp"
#include "rodwake/store/frames.hpp"

namespace store_test {

namespace store = rodwake::store;

struct SampleFrames {
    struct Values {
        std::int64_t step = 0;
        double time = 0.0;
        std::vector<double> position, velocity, rod_position, rod_velocity, rod_orientation,
            rod_angular_momentum, observables;
    };
    static constexpr std::size_t beads = 9, rods = 2, per_rod = 3, count = 4;

    store::FrameLayout layout;
    std::vector<Values> frames;

    SampleFrames() {
        const std::size_t n = beads + rods * per_rod;
        layout.box = {0.0312, 0.0312, 0.0014};
        for (std::size_t i = 0; i < n; ++i) {
            const auto owner = static_cast<std::int32_t>((i - beads) / per_rod);
            layout.species.push_back(i < beads ? 0 : 1);
            layout.id.push_back(static_cast<std::int32_t>(i) + 1);
            layout.mass.push_back(i < beads ? 7.2e-7 : 5e-6);
            layout.radius.push_back(i < beads ? 4e-4 : 5.5e-4 - 3e-5 * static_cast<double>(i - beads));
            if (i >= beads)
                layout.rod_of_sphere.push_back(owner);
        }
        layout.rod_id = {1, 2};
        layout.rod_mass = {1.5e-5, 1.6e-5};
        layout.observables = {"kinetic_energy", "plate_z"};
        RandomStream random(42);
        for (std::size_t k = 0; k < count; ++k)
            frames.push_back(values(random, k));
    }

    store::Frame frame(std::size_t k) const {
        const Values& f = frames.at(k);
        return {f.step,         f.time,         f.position,        f.velocity,
                f.rod_position, f.rod_velocity, f.rod_orientation, f.rod_angular_momentum,
                f.observables};
    }

private:
    using RandomStream = rodwake::RandomStream;

    Values values(RandomStream& random, std::size_t k) const {
        const auto draw = [&](std::size_t size, double low, double high) {
            std::vector<double> out(size);
            for (double& value : out)
                value = random.uniform(low, high);
            return out;
        };
        const std::size_t n = 3 * layout.particles();
        return {static_cast<std::int64_t>(500 * k),
                0.01 * static_cast<double>(k),
                draw(n, -0.1, 0.1),
                draw(n, -0.2, 0.2),
                draw(3 * rods, -0.1, 0.1),
                draw(3 * rods, -0.1, 0.1),
                draw(4 * rods, -1.0, 1.0),
                draw(3 * rods, -1e-8, 1e-8),
                draw(2, 0.0, 1e-5)};
    }
};

} // namespace store_test
