# Warnings, and arithmetic that does not depend on the compiler's contraction choices. GCC 12 at -O3 sees overlapping copies
# in std::string that are none (GCC bug 105329), hence no -Wrestrict.
# Position-independent functions of a part are its own: nobody replaces them, so they may be inlined.
set(RODWAKE_FLAGS -fno-semantic-interposition -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -ffp-contract=off
    $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>
    $<$<BOOL:${RODWAKE_WERROR}>:-Werror>)

# rodwake_part(<name> SOURCES ... [PUBLIC ...] [PRIVATE ...])
# One static library per part of the pipeline. A part links only what it lists, so a call the wrong way does not link;
# tests/house checks the includes as well.
function(rodwake_part name)
    cmake_parse_arguments(PART "" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
    set(target rodwake_${name})
    add_library(${target} STATIC ${PART_SOURCES})
    add_library(rodwake::${name} ALIAS ${target})
    set_target_properties(${target} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON)
    target_include_directories(${target}
        PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>
        PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
    target_compile_features(${target} PUBLIC cxx_std_20)
    target_link_libraries(${target} PUBLIC ${PART_PUBLIC} PRIVATE ${PART_PRIVATE})
    target_compile_options(${target} PRIVATE ${RODWAKE_FLAGS})
    set_property(GLOBAL APPEND PROPERTY RODWAKE_PARTS ${target})
endfunction()
