# cmake --install: headers, libraries, the program, plots; find_package(rodwake) afterwards.
include(CMakePackageConfigHelpers)

get_property(parts GLOBAL PROPERTY RODWAKE_PARTS)
install(TARGETS ${parts} EXPORT rodwakeTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(TARGETS rodwake RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(DIRECTORY include/rodwake DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(DIRECTORY plots/ DESTINATION ${CMAKE_INSTALL_DATADIR}/rodwake/plots PATTERN "__pycache__" EXCLUDE
        PATTERN "test_*" EXCLUDE PATTERN "plot_case.py" EXCLUDE PATTERN "made_up_*.py" EXCLUDE)
install(DIRECTORY fitting/problems fitting/data DESTINATION ${CMAKE_INSTALL_DATADIR}/rodwake/fitting)
install(DIRECTORY scenes DESTINATION ${CMAKE_INSTALL_DATADIR}/rodwake)
install(FILES LICENSE README.md DESTINATION ${CMAKE_INSTALL_DOCDIR})

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/rodwake)
install(EXPORT rodwakeTargets NAMESPACE rodwake:: DESTINATION ${package_dir})
configure_package_config_file(cmake/rodwakeConfig.cmake.in ${CMAKE_BINARY_DIR}/rodwakeConfig.cmake
                              INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${CMAKE_BINARY_DIR}/rodwakeConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/rodwakeConfig.cmake ${CMAKE_BINARY_DIR}/rodwakeConfigVersion.cmake
        DESTINATION ${package_dir})
