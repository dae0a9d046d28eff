# Warnings, and arithmetic that does not depend on the compiler's contraction choices. GCC 12 at -O3 sees overlapping copies
# in std::string that are none (GCC bug 105329), hence no -Wrestrict, -Wstringop-overflow and -Warray-bounds. In a batch it takes sources for
# headers, whose classes should have no hidden members (-Wsubobject-linkage).
# Position-independent functions of a part are its own: nobody replaces them, so they may be inlined. The compiler collects its
# garbage from 400 MB on instead of 130, a tenth of its time on the largest sources.
set(RODWAKE_FLAGS -fno-semantic-interposition -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -ffp-contract=off
    $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>
    $<$<CXX_COMPILER_ID:GNU>:-Wno-stringop-overflow>
    $<$<CXX_COMPILER_ID:GNU>:-Wno-array-bounds>
    $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>
    $<$<CXX_COMPILER_ID:GNU>:--param=ggc-min-expand=200>
    $<$<CXX_COMPILER_ID:GNU>:--param=ggc-min-heapsize=400000>
    $<$<BOOL:${RODWAKE_WERROR}>:-Werror>)

# What a part's sources read most: numbers or text. Reading a precompiled header costs too, so each is small.
rodwake_precompile(rodwake_numbers PIC LINK fmt::fmt Eigen3::Eigen
                   HEADERS algorithm array cmath functional limits optional span string vector fmt/format.h Eigen/Core)
rodwake_precompile(rodwake_front PIC LINK fmt::fmt Eigen3::Eigen
                   HEADERS algorithm array cmath filesystem fstream functional map memory optional set span string vector fmt/format.h
                   Eigen/Core)
rodwake_precompile(rodwake_text PIC LINK fmt::fmt
                   HEADERS algorithm array cmath functional map memory optional set span string vector fmt/format.h)

# The presets compile sources eight at a time (CMAKE_UNITY_BUILD): most of a source's time goes into its headers. Two hidden
# helpers of one name and parameters in a batch are a "redefinition": share them, or rename one. Compiled alone are sources
# that Highway includes once an instruction set, and those whose place says so (rodwake_part's ALONE): all files of a folder hide
# the same names, or a header brings a function that others' calls would find (std::quoted).
set(RODWAKE_LARGE_BATCH 24 CACHE STRING "Sources compiled together of the parts with the heaviest headers: app and the command line")
function(rodwake_compile_alone)
    foreach(source IN LISTS ARGN)
        file(STRINGS ${source} by_target REGEX "foreach_target\\.h" LIMIT_COUNT 1)
        if(by_target)
            set_property(SOURCE ${source} PROPERTY SKIP_UNITY_BUILD_INCLUSION ON)
        endif()
    endforeach()
endfunction()

# rodwake_part(<name> SOURCES ... [PUBLIC ...] [PRIVATE ...] [ALONE <sources of these that are compiled alone>])
# One static library per part of the pipeline. A part links only what it lists, so a call the wrong way does not link;
# tests/architecture checks the includes as well.
function(rodwake_part name)
    cmake_parse_arguments(PART "" "" "SOURCES;PUBLIC;PRIVATE;ALONE" ${ARGN})
    set(target rodwake_${name})
    add_library(${target} STATIC ${PART_SOURCES})
    add_library(rodwake::${name} ALIAS ${target})
    rodwake_compile_alone(${PART_SOURCES})
    set_property(SOURCE ${PART_ALONE} PROPERTY SKIP_UNITY_BUILD_INCLUSION ON)
    set_target_properties(${target} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON)
    target_include_directories(${target}
        PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>
        PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
    target_compile_features(${target} PUBLIC cxx_std_20)
    target_compile_options(${target} PRIVATE ${RODWAKE_FLAGS})
    target_link_libraries(${target} PUBLIC ${PART_PUBLIC})
    set(links ${PART_PUBLIC} ${PART_PRIVATE})
    foreach(library IN LISTS PART_PRIVATE)
        if(library IN_LIST RODWAKE_HEADER_ONLY)
            list(REMOVE_ITEM links ${library})
            set(library $<BUILD_INTERFACE:${library}>)
        endif()
        target_link_libraries(${target} PRIVATE ${library})
    endforeach()
    rodwake_optimise(${target} ${name})
    if(NOT fmt::fmt IN_LIST links OR name IN_LIST RODWAKE_UNOPTIMISED)
        # the small parts gain nothing; those of the list have another level than the precompiled headers
    elseif(name IN_LIST RODWAKE_LIGHT)
        rodwake_reuse(${target} rodwake_front)
    elseif("${links}" MATCHES "Eigen3|rodwake::(integrate|rods|granular|measure|fitting)")
        rodwake_reuse(${target} rodwake_numbers)
    else()
        rodwake_reuse(${target} rodwake_text)
    endif()
    set_property(GLOBAL APPEND PROPERTY RODWAKE_PARTS ${name})
    set_property(GLOBAL PROPERTY RODWAKE_LINKS_${name} ${links}) # for rodwakeConfig.cmake
endfunction()
