# Every package rodwake uses, with what for. All are in Debian 12; tools/packages.txt names them.
# The words that find a package are kept: rodwakeConfig.cmake says the same to who uses an installed part.
include(FeatureSummary)
list(APPEND CMAKE_MODULE_PATH ${PROJECT_SOURCE_DIR}/cmake)

set(RODWAKE_FIND_Threads Threads)
set(RODWAKE_FIND_Eigen3 Eigen3 3.4 NO_MODULE)
set(RODWAKE_FIND_Boost Boost 1.74)
set(RODWAKE_FIND_SUNDIALS SUNDIALS 6.4 COMPONENTS cvodes idas arkode nvecserial sunmatrixdense sunlinsoldense
    sunnonlinsolnewton sunnonlinsolfixedpoint)
# Debian ships two packages of this name; either gives the C library, and the C interface is all we use.
set(RODWAKE_FIND_NLopt NLopt 2.7)
set(RODWAKE_FIND_tomlplusplus tomlplusplus)
set(RODWAKE_FIND_CLI11 CLI11)
set(RODWAKE_FIND_fmt fmt)
set(RODWAKE_FIND_spdlog spdlog)
set(RODWAKE_FIND_nlohmann_json nlohmann_json)
set(RODWAKE_FIND_HDF5C HDF5C)
set(RODWAKE_FIND_hwy hwy) # its run-time part links with the vector kernels
set(RODWAKE_FIND_ZLIB ZLIB)
foreach(package Threads Eigen3 Boost SUNDIALS NLopt tomlplusplus CLI11 fmt spdlog nlohmann_json HDF5C hwy ZLIB)
    find_package(${RODWAKE_FIND_${package}} REQUIRED)
endforeach()

# Checksums: header only (XXH_INLINE_ALL), so nothing is linked.
find_path(RODWAKE_XXHASH_INCLUDE xxhash.h)
if(NOT RODWAKE_XXHASH_INCLUDE)
    message(FATAL_ERROR "xxhash.h not found: install libxxhash-dev")
endif()
add_library(rodwake_xxhash INTERFACE IMPORTED)
target_include_directories(rodwake_xxhash SYSTEM INTERFACE ${RODWAKE_XXHASH_INCLUDE})

# Compiled into a part that uses them privately: who links the installed part does without.
set(RODWAKE_HEADER_ONLY Eigen3::Eigen Boost::headers nlohmann_json::nlohmann_json rodwake_xxhash)

# Scans on the ranks of a job. The C interface is all we use.
option(RODWAKE_MPI "Scans under mpiexec, if there is an MPI" ON)
set(RODWAKE_FIND_MPI MPI COMPONENTS CXX)
if(RODWAKE_MPI)
    set(MPI_CXX_SKIP_MPICXX ON)
    find_package(MPI QUIET COMPONENTS CXX)
    set_package_properties(MPI PROPERTIES PURPOSE "scans under mpiexec" TYPE OPTIONAL)
endif()

if(RODWAKE_BENCH)
    find_package(benchmark REQUIRED)
endif()
if(RODWAKE_TESTS)
    find_package(Catch2 2.13 REQUIRED)
endif()
# Plots need the interpreter that has matplotlib: Debian's own, whichever python3 comes first on PATH.
set(RODWAKE_PYTHON /usr/bin/python3 CACHE FILEPATH "Python that the package is built for, and of the tests")
set(RODWAKE_FIGURES_PYTHON ${RODWAKE_PYTHON} CACHE STRING "Python with matplotlib and h5py, for rodwake plot: a path, or a name on PATH")
if(RODWAKE_PYTHON_PACKAGE)
    set(PYTHON_EXECUTABLE ${RODWAKE_PYTHON}) # of pybind11
    find_package(pybind11 2.10 QUIET)
    set_package_properties(pybind11 PROPERTIES PURPOSE "the Python package" TYPE OPTIONAL)
endif()

# ccache takes up precompiled headers only if told so. Paths below the source tree count as relative ones, so what one clone
# compiled serves every other.
find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM)
    set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros
        CCACHE_BASEDIR=${PROJECT_SOURCE_DIR} CCACHE_NOHASHDIR=1 ${CCACHE_PROGRAM})
endif()
