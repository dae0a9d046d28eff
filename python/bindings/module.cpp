// rodwake._core: what the Python modules of the package call. It is theirs alone; its interface may change.

#include "bind.hpp"
#include "rodwake/core/build_info.hpp"

PYBIND11_MODULE(_core, module) {
    using namespace rodwake::python;
    module.doc() = "Compiled part of rodwake.";
    module.attr("version") = rodwake::build_info().version;
    module.attr("git") = rodwake::build_info().git;
    bind_errors(module);
    bind_medium(module);
    bind_fields(module);
    bind_rods(module);
    bind_equilibria(module);
    bind_noise(module);
    bind_scene(module);
    bind_run(module);
    bind_integrate(module);
    bind_fit(module);
    bind_posterior(module);
    bind_granular(module);
    bind_scan(module);
    bind_tradeoff(module);
}
