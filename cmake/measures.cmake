# rodwake_list_measures(<template> <source> <file>...): makes the source that lists the measures. Each file defines
# `MeasureKind <its name>()`. The list calls these functions by name, so that the linker takes them out of the static library;
# objects that register themselves would be left there.
function(rodwake_list_measures template source)
    set(RODWAKE_MEASURE_DECLARATIONS)
    set(RODWAKE_MEASURE_CALLS)
    foreach(file IN LISTS ARGN)
        get_filename_component(name ${file} NAME_WE)
        file(STRINGS ${file} definition REGEX "^MeasureKind ${name}\\(\\) {")
        if(NOT definition)
            message(FATAL_ERROR "${file} defines no \"MeasureKind ${name}()\", under the name of the file; docs/extending.md tells what a measure is")
        endif()
        string(APPEND RODWAKE_MEASURE_DECLARATIONS "MeasureKind ${name}();\n")
        string(APPEND RODWAKE_MEASURE_CALLS "\n            measures::${name}(),")
    endforeach()
    configure_file(${template} ${source} @ONLY)
endfunction()
