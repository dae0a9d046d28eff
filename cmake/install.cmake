# cmake --install: headers, libraries, the program with what it ships; find_package(rodwake) afterwards. cpack makes a .deb of it.
include(CMakePackageConfigHelpers)

# What a part stands on, itself last: <out>_parts, and <out>_packages that its linker needs.
function(rodwake_needs part out)
    set(parts)
    set(packages)
    get_property(links GLOBAL PROPERTY RODWAKE_LINKS_${part})
    foreach(link IN LISTS links)
        string(REGEX REPLACE "::.*" "" package ${link})
        if(package STREQUAL rodwake)
            string(REPLACE "rodwake::" "" below ${link})
            rodwake_needs(${below} below)
            list(APPEND parts ${below_parts})
            list(APPEND packages ${below_packages})
        elseif(DEFINED RODWAKE_FIND_${package})
            list(APPEND packages ${package})
        else()
            message(FATAL_ERROR "part ${part} links ${link}, and cmake/dependencies.cmake does not say how that is found")
        endif()
    endforeach()
    list(APPEND parts ${part})
    list(REMOVE_DUPLICATES parts)
    list(REMOVE_DUPLICATES packages)
    set(${out}_parts ${parts} PARENT_SCOPE)
    set(${out}_packages ${packages} PARENT_SCOPE)
endfunction()

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/rodwake)
get_property(parts GLOBAL PROPERTY RODWAKE_PARTS)
set(RODWAKE_NEEDS)
set(used)
foreach(part IN LISTS parts)
    install(TARGETS rodwake_${part} EXPORT rodwake-${part} ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
    install(EXPORT rodwake-${part} NAMESPACE rodwake:: DESTINATION ${package_dir})
    rodwake_needs(${part} it)
    string(APPEND RODWAKE_NEEDS "set(_rodwake_${part}_parts ${it_parts})\nset(_rodwake_${part}_packages ${it_packages})\n")
    list(APPEND used ${it_packages})
endforeach()
list(REMOVE_DUPLICATES used)
foreach(package IN LISTS used)
    string(APPEND RODWAKE_NEEDS "set(_rodwake_find_${package} ${RODWAKE_FIND_${package}})\n")
endforeach()

install(TARGETS rodwake RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(DIRECTORY include/rodwake DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})

# Names of 0.2, for one release: its parts assembly and stages are app. Their headers pass on to those of app, with the old namespace.
set(headers_of_assembly cases describe field_choice fit granular measure measure_kind measure_report plan rods scan scan_beds scan_problem schema)
set(headers_of_stages evaluate fit_results run run_context run_folder wake_tables)
foreach(old IN ITEMS assembly stages)
    foreach(header IN LISTS headers_of_${old})
        string(REPLACE scan_beds scanned_bed new ${header})
        file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/names_of_0_2/rodwake/${old}/${header}.hpp
             CONTENT "#pragma once\n// The name of 0.2: include rodwake/app/${new}.hpp.\n#include \"rodwake/app/${new}.hpp\"\nnamespace rodwake {\nnamespace ${old} = app;\n}\n")
    endforeach()
endforeach()
install(DIRECTORY ${CMAKE_BINARY_DIR}/names_of_0_2/rodwake DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(DIRECTORY plots/ DESTINATION ${CMAKE_INSTALL_DATADIR}/rodwake/plots PATTERN "__pycache__" EXCLUDE)
install(DIRECTORY convert/ DESTINATION ${CMAKE_INSTALL_DATADIR}/rodwake/convert PATTERN "__pycache__" EXCLUDE)
install(DIRECTORY commands/ DESTINATION ${CMAKE_INSTALL_DATADIR}/rodwake/commands PATTERN "__pycache__" EXCLUDE)
install(DIRECTORY fitting/problems fitting/data DESTINATION ${CMAKE_INSTALL_DATADIR}/rodwake/fitting)
install(DIRECTORY explorer DESTINATION ${CMAKE_INSTALL_DATADIR}/rodwake)
install(DIRECTORY scenes DESTINATION ${CMAKE_INSTALL_DATADIR}/rodwake)
install(FILES ${CMAKE_BINARY_DIR}/shell/rodwake.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
install(FILES ${CMAKE_BINARY_DIR}/shell/rodwake DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
install(FILES ${CMAKE_BINARY_DIR}/shell/_rodwake DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions)
install(FILES LICENSE README.md DESTINATION ${CMAKE_INSTALL_DOCDIR})

configure_package_config_file(cmake/rodwakeConfig.cmake.in ${CMAKE_BINARY_DIR}/rodwakeConfig.cmake
                              INSTALL_DESTINATION ${package_dir})
# Names of 0.2 are still understood, so a project that asks for 0.2 is served.
write_basic_package_version_file(${CMAKE_BINARY_DIR}/rodwakeConfigVersion.cmake COMPATIBILITY SameMajorVersion)
install(FILES ${CMAKE_BINARY_DIR}/rodwakeConfig.cmake ${CMAKE_BINARY_DIR}/rodwakeConfigVersion.cmake cmake/FindHDF5C.cmake
        DESTINATION ${package_dir})

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "The rodwake authors <authors@rodwake.invalid>") # the field asks for an address; there is none
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "motile rods in an elastic medium")
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION
    "A vibrated rod walks through a crystal of beads and leaves a wake of strain
in which other rods turn. rodwake integrates many rods in such fields,
simulates the beds themselves, measures their wakes, fits the elastic
parameters, and maps capture and escape, from one scene file to figures
and a report.")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_PRE_BUILD_SCRIPTS ${PROJECT_SOURCE_DIR}/cmake/debian.cmake)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON) # the libraries that the program is linked with
set(CPACK_DEBIAN_PACKAGE_DEPENDS "python3, python3-numpy, python3-matplotlib, python3-h5py") # of rodwake plot
include(CPack)
