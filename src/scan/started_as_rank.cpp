#include "rodwake/scan/mpi.hpp"

#include <cstdlib>

namespace rodwake::scan {

bool started_as_rank() {
    // Open MPI; MPICH, Intel MPI and srun with PMI
    for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"})
        if (const char* size = std::getenv(name); size && std::atoi(size) > 1)
            return true;
    const char *pmix = std::getenv("PMIX_RANK"), *tasks = std::getenv("SLURM_NTASKS"); // srun with PMIx
    return pmix && tasks && std::atoi(tasks) > 1;
}

} // namespace rodwake::scan
