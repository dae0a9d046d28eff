# Headers that most sources read, parsed once. Sources and headers still include what
# they use: headers are compiled alone (target headers_alone, test "compile"), and clang-tidy reads sources without these.
option(RODWAKE_PCH "Precompile the headers of libraries" ON)

# Parts that read, write and report, and tests, compile in two thirds of the time at -O1 and run as fast; numerics keep the level of the
# build type.
# With sanitisers even that takes longer than it spares. A precompiled header serves one level: those of RODWAKE_LIGHT share one, tests go
# by the name of theirs, and unoptimised parts use none.
set(RODWAKE_LIGHT scene app cli python rodwake_front rodwake_checks rodwake_exact_checks)
set(RODWAKE_UNOPTIMISED "" CACHE STRING "Parts, and precompiled headers of tests, that are compiled with -O0")

function(rodwake_optimise target name)
    if(name IN_LIST RODWAKE_UNOPTIMISED)
        target_compile_options(${target} PRIVATE -O0)
    elseif(name IN_LIST RODWAKE_LIGHT)
        target_compile_options(${target} PRIVATE -O1)
    endif()
endfunction()

# rodwake_precompile(<name> [PIC] LINK <libraries> HEADERS <header>...): makes the target <name>; rodwake_reuse(<target> <name>) takes it up.
function(rodwake_precompile name)
    cmake_parse_arguments(SET "PIC" "" "LINK;HEADERS" ${ARGN})
    if(NOT RODWAKE_PCH)
        return()
    endif()
    set(source ${CMAKE_BINARY_DIR}/precompiled/${name}.cpp) # a target needs a source
    file(CONFIGURE OUTPUT ${source} CONTENT "")
    add_library(${name} OBJECT EXCLUDE_FROM_ALL ${source})
    target_link_libraries(${name} PRIVATE ${SET_LINK})
    target_compile_options(${name} PRIVATE ${RODWAKE_FLAGS})
    rodwake_optimise(${name} ${name})
    if(SET_PIC) # as all the sources that use it
        set_target_properties(${name} PROPERTIES POSITION_INDEPENDENT_CODE ON)
    endif()
    list(TRANSFORM SET_HEADERS PREPEND "<")
    list(TRANSFORM SET_HEADERS APPEND ">")
    target_precompile_headers(${name} PRIVATE ${SET_HEADERS})
endfunction()

function(rodwake_reuse target name)
    if(RODWAKE_PCH)
        target_precompile_headers(${target} REUSE_FROM ${name})
    endif()
endfunction()
