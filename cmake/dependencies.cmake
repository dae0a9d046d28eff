# Every package rodwake uses, with what for. All are in Debian 12; tools/packages.txt names them.
include(FeatureSummary)

find_package(Threads REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(Boost 1.74 REQUIRED)
find_package(SUNDIALS 6.4 REQUIRED COMPONENTS cvodes arkode nvecserial sunmatrixdense sunlinsoldense
             sunnonlinsolnewton sunnonlinsolfixedpoint)
# Debian ships two packages of this name; either gives the C library, and the C interface is all we use.
find_package(NLopt 2.7 REQUIRED)
find_package(tomlplusplus REQUIRED)
find_package(CLI11 REQUIRED)
find_package(fmt REQUIRED)
find_package(spdlog REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(HDF5 REQUIRED COMPONENTS C)
find_package(hwy REQUIRED)
# Checksums: header only (XXH_INLINE_ALL), so nothing is linked.
find_path(RODWAKE_XXHASH_INCLUDE xxhash.h)
if(NOT RODWAKE_XXHASH_INCLUDE)
    message(FATAL_ERROR "xxhash.h not found: install libxxhash-dev")
endif()
add_library(rodwake_xxhash INTERFACE IMPORTED)
target_include_directories(rodwake_xxhash SYSTEM INTERFACE ${RODWAKE_XXHASH_INCLUDE})
find_package(benchmark QUIET)
set_package_properties(benchmark PROPERTIES PURPOSE "benchmarks in bench/" TYPE OPTIONAL)
if(RODWAKE_TESTS)
    find_package(Catch2 2.13 REQUIRED)
endif()
# Plots need the interpreter that has matplotlib: Debian's own, whichever python3 comes first on PATH.
set(RODWAKE_PYTHON /usr/bin/python3 CACHE FILEPATH "Python with matplotlib and h5py, for rodwake plot")

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM)
    set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE_PROGRAM})
endif()

# FindHDF5 gives variables; the parts want a target.
add_library(rodwake_hdf5 INTERFACE IMPORTED)
target_include_directories(rodwake_hdf5 SYSTEM INTERFACE ${HDF5_INCLUDE_DIRS})
target_link_libraries(rodwake_hdf5 INTERFACE ${HDF5_C_LIBRARIES})
