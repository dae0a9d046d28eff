# What Debian asks of a package beside what is installed: run by cpack on the staged tree, so that cmake --install stays plain.
set(tree ${CPACK_TEMPORARY_INSTALL_DIRECTORY}${CPACK_PACKAGING_INSTALL_PREFIX})
set(doc ${tree}/share/doc/rodwake)
file(STRINGS ${CMAKE_CURRENT_LIST_DIR}/../CITATION.cff released REGEX "^date-released: ")
string(REPLACE "date-released: " "" released ${released})
if(NOT DEFINED ENV{SOURCE_DATE_EPOCH}) # of every file in the package: the same bytes whenever it is made
    execute_process(COMMAND date -u -d ${released} +%s OUTPUT_VARIABLE epoch OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
    set(ENV{SOURCE_DATE_EPOCH} ${epoch})
endif()

file(READ ${doc}/LICENSE license)
string(REGEX REPLACE "\n\n" "\n.\n" license ${license})
string(REGEX REPLACE "\n" "\n " license ${license})
string(STRIP "${license}" license)
file(WRITE ${doc}/copyright "Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/
Upstream-Name: rodwake

Files: *
Copyright: 2026 The rodwake authors
License: Expat

License: Expat
 ${license}
")
file(REMOVE ${doc}/LICENSE)

execute_process(COMMAND date -R -u -d ${released} OUTPUT_VARIABLE date OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
file(WRITE ${doc}/changelog "rodwake (${CPACK_PACKAGE_VERSION}) unstable; urgency=medium

  * New release: CHANGELOG.md of the sources says what is new.

 -- ${CPACK_PACKAGE_CONTACT}  ${date}
")
execute_process(COMMAND gzip -9n ${doc}/changelog ${tree}/share/man/man1/rodwake.1 COMMAND_ERROR_IS_FATAL ANY)
