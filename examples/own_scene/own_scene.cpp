// Reads a scene, changes a key, runs its rods and prints how the encounter ends:  own_scene pair.toml
// coupling.kappa 100

#include <rodwake/app/plan.hpp>
#include <rodwake/scene/read.hpp>
#include <rodwake/scene/set.hpp>

#include <cstdio>
#include <cstdlib>
#include <exception>

int main(int argc, char** argv) try {
    using namespace rodwake;
    if (argc != 4)
        return std::fprintf(stderr, "usage: own_scene SCENE KEY NUMBER\n"), 2;
    scene::Scene scene = scene::read_scene(argv[1]);
    if (const auto wrong = scene::compile_setter(scene, argv[2]).set(scene, std::atof(argv[3])))
        return std::fprintf(stderr, "%s\n", wrong->c_str()), 2;
    const app::RodsPlan plan = app::plan_rods(scene).front();
    const rods::RodResult result = rods::simulate(plan.problem, plan.options);
    std::printf("%s at t = %.6g f/(mu v0)\n", to_string(result.outcome.ending).c_str(), result.outcome.time);
} catch (const std::exception& error) {
    return std::fprintf(stderr, "%s\n", error.what()), 1;
}
