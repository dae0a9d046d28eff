// The mesh where its modes are many or their forces nothing, and its start.

#include "medium/mode_mesh.hpp"
#include "reference_run.hpp"
#include "rods/interaction.hpp"
#include "rodwake/medium/dynamic_medium.hpp"

#include <catch2/catch.hpp>

#include <cmath>

using namespace rodwake;
using namespace rodwake::medium;

namespace {

std::vector<double> summed_start(const ModalField& modes, std::span<const double> poses) {
    std::vector<double> field(modes.numbers());
    for (std::size_t a = 0; a < poses.size() / 3; ++a)
        modes.add_steady(rods::pose(poses, a), field);
    return field;
}

} // namespace

TEST_CASE("the start of many rods is the sum of their steady fields") {
    const std::vector<double> poses = tests::crowd(200, 12.0);
    for (const double eta : {1.0, 0.3, -0.5, -0.9})
        for (const double xi : {10.0, 1.0, 0.1}) { // nearly all modes by harmonics, some, hardly any
            const elastic::Medium elastic{eta, xi};
            const DynamicMedium medium{.box = 12.0, .force_width = 0.5, .modes = 47};
            const ModalField modes(elastic, medium);
            Team team(1);
            ModeMesh mesh(modes, medium.box, team);
            std::vector<double> field(modes.numbers());
            mesh.add_steady(poses, field);
            const std::vector<double> exact = summed_start(modes, poses);
            CAPTURE(eta, xi);
            CHECK(tests::distance(field, exact) < mesh_error * tests::largest(exact));
        }
}

TEST_CASE("modes whose force underflows carry nothing of the transform before") {
    const elastic::Medium elastic{1.0, 1.0};
    const rods::Couplings couplings{1.0, 0.0, 0.0};
    const DynamicMedium medium{.box = 12.0, .force_width = 3.0, .modes = 96, .self_field = true};
    const ModalField modes(elastic, medium);
    REQUIRE(modes.force().back() == 0.0);
    Team team(1);
    ModeMesh mesh(modes, medium.box, team);
    const std::vector<double> poses = tests::crowd(5, 12.0), field = summed_start(modes, poses);
    std::vector<double> forces(field.size()), rates(5), exact(5);
    mesh.forces(poses, forces);
    mesh.turning(poses, field, couplings, rates);
    for (std::size_t a = 0; a < 5; ++a) {
        const rods::Direction n = rods::direction(poses, a);
        exact[a] = rods::turning_rate(
            modes.at(poses[3 * a], poses[3 * a + 1], rods::request_of(couplings, false), field), couplings,
            {n.cosine, n.sine});
    }
    CHECK(tests::distance(rates, exact) < mesh_error * tests::largest(exact));
}
