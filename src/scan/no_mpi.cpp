// A build without MPI.

#include "rodwake/core/error.hpp"
#include "rodwake/scan/mpi.hpp"

namespace rodwake::scan {

struct MpiJob::Workers {};

std::unique_ptr<MpiJob> MpiJob::join() {
    if (!started_as_rank())
        return nullptr;
    throw InputError(
        "this rodwake is built without MPI, and each rank would compute the whole scan: build it "
        "with MPI (libopenmpi-dev, -D RODWAKE_MPI=ON), or use --part i/n");
}

MpiJob::MpiJob() = default;
MpiJob::~MpiJob() = default;

Execute MpiJob::executor(Evaluate evaluate, std::function<bool()> stop) {
    return on_threads(std::move(evaluate), 1, std::move(stop));
}

void MpiJob::serve(const Evaluate&) {}
void MpiJob::fail(const std::string&) {}

} // namespace rodwake::scan
