# Copy to packages/rodwake/package.py of a repository of yours; then, in the sources:
#   spack dev-build rodwake@0.3.0
from spack.package import *


class Rodwake(CMakePackage):
    """Motile rods in an elastic medium: integration, granular simulation, fits and phase diagrams."""

    license("MIT")
    version("0.3.0")
    variant("mpi", default=True, description="Scans on the ranks of a job")
    variant("python", default=True, description="The Python package")

    depends_on("cxx", type="build")
    depends_on("cmake@3.25:", type="build")
    depends_on("ninja", type="build")
    depends_on("eigen@3.4:")
    depends_on("boost@1.74:")
    depends_on("sundials@6.4:6 +cvode +ida +arkode +cvodes +idas ~mpi")
    depends_on("nlopt@2.7:")
    depends_on("tomlplusplus")
    depends_on("cli11")
    depends_on("fmt")
    depends_on("spdlog +fmt_external")
    depends_on("nlohmann-json")
    depends_on("hdf5 ~mpi +hl")
    depends_on("highway")
    depends_on("xxhash")
    depends_on("zlib")
    depends_on("random123")
    depends_on("mpi", when="+mpi")
    depends_on("python", type=("build", "run"))
    depends_on("py-numpy", type="run")
    depends_on("py-matplotlib", type="run")
    depends_on("py-h5py", type="run")
    depends_on("py-pybind11@2.10:", when="+python")

    generator("ninja")

    def cmake_args(self):
        python = self.spec["python"].command.path
        return [self.define_from_variant("RODWAKE_MPI", "mpi"), self.define_from_variant("RODWAKE_PYTHON_PACKAGE", "python"),
                self.define("RODWAKE_PYTHON", python), self.define("RODWAKE_FIGURES_PYTHON", python)]
