# The C library of HDF5, with its high-level part, as the target HDF5C::HDF5C, and HDF5C_VERSION. CMake's own module compiles
# a test in C; a project in C++ alone need not have that language. HDF5_ROOT, variable or environment, comes first; Debian's
# serial build next.
find_path(HDF5C_INCLUDE_DIR hdf5.h HINTS ${HDF5_ROOT} ENV HDF5_ROOT PATH_SUFFIXES include hdf5/serial)
find_library(HDF5C_LIBRARY NAMES hdf5_serial hdf5 HINTS ${HDF5_ROOT} ENV HDF5_ROOT PATH_SUFFIXES lib hdf5/serial)
find_library(HDF5C_HL_LIBRARY NAMES hdf5_serial_hl hdf5_hl HINTS ${HDF5_ROOT} ENV HDF5_ROOT PATH_SUFFIXES lib hdf5/serial)
if(HDF5C_INCLUDE_DIR)
    file(STRINGS ${HDF5C_INCLUDE_DIR}/H5public.h HDF5C_VERSION REGEX "define H5_VERS_INFO")
    string(REGEX REPLACE ".*version: ([0-9.]+).*" "\\1" HDF5C_VERSION "${HDF5C_VERSION}")
endif()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(HDF5C REQUIRED_VARS HDF5C_LIBRARY HDF5C_HL_LIBRARY HDF5C_INCLUDE_DIR VERSION_VAR HDF5C_VERSION)
mark_as_advanced(HDF5C_INCLUDE_DIR HDF5C_LIBRARY HDF5C_HL_LIBRARY)

if(HDF5C_FOUND AND NOT TARGET HDF5C::HDF5C)
    add_library(HDF5C::HDF5C UNKNOWN IMPORTED)
    set_target_properties(HDF5C::HDF5C PROPERTIES IMPORTED_LOCATION ${HDF5C_HL_LIBRARY}
                          INTERFACE_LINK_LIBRARIES ${HDF5C_LIBRARY}
                          INTERFACE_INCLUDE_DIRECTORIES ${HDF5C_INCLUDE_DIR})
endif()
