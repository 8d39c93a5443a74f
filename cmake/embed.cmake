# Puts text files into a C++ program.
#
#   include(${PROJECT_SOURCE_DIR}/cmake/embed.cmake)
#   loam_embed(TARGET loam_experiments HEADER "experiments/report/assets.hpp"
#              FUNCTION loam::experiments::report::embedded_assets
#              ASSETS style.css=${CMAKE_CURRENT_SOURCE_DIR}/style.css ...)
#
# adds a generated source to TARGET that defines FUNCTION, declared in HEADER as returning a span of {name, text}
# in the order of ASSETS. The source is written anew when one of the files changes. The same file, run as
# `cmake -DMANIFEST=... -DOUTPUT=... -DHEADER=... -DFUNCTION=... -P embed.cmake`, is the generator.

if(CMAKE_SCRIPT_MODE_FILE STREQUAL CMAKE_CURRENT_LIST_FILE)
  file(STRINGS "${MANIFEST}" entries)
  string(REGEX REPLACE "::[^:]*$" "" namespace "${FUNCTION}")
  string(REGEX REPLACE "^.*::" "" function "${FUNCTION}")
  set(rows "")
  foreach(entry IN LISTS entries)
    string(FIND "${entry}" "=" split)
    string(SUBSTRING "${entry}" 0 ${split} name)
    math(EXPR split "${split} + 1")
    string(SUBSTRING "${entry}" ${split} -1 path)
    file(READ "${path}" text)
    string(FIND "${text}" ")loam_asset\"" clash)
    if(NOT clash EQUAL -1)
      message(FATAL_ERROR "${path} contains the end mark of its own literal, )loam_asset\"")
    endif()
    # A map of the minified source is not shipped, so a browser must not be sent to look for it.
    string(REGEX REPLACE "\n//# sourceMappingURL=[^\n]*" "" text "${text}")
    string(APPEND rows "    {\"${name}\", R\"loam_asset(${text})loam_asset\"},\n")
  endforeach()
  file(WRITE "${OUTPUT}" "// Written by cmake/embed.cmake.\n#include \"${HEADER}\"\n\nnamespace ${namespace} {\nnamespace {\n"
       "constexpr Asset assets[] = {\n${rows}};\n}  // namespace\n"
       "std::span<const Asset> ${function}() { return assets; }\n}  // namespace ${namespace}\n")
  return()
endif()

set(LOAM_EMBED_SCRIPT ${CMAKE_CURRENT_LIST_FILE})

function(loam_embed)
  cmake_parse_arguments(ARG "" "TARGET;HEADER;FUNCTION" "ASSETS" ${ARGN})
  string(REGEX REPLACE "^.*::" "" stem "${ARG_FUNCTION}")
  set(output ${CMAKE_CURRENT_BINARY_DIR}/${stem}.cpp)
  set(manifest ${CMAKE_CURRENT_BINARY_DIR}/${stem}.manifest)
  set(paths "")
  set(lines "")
  foreach(entry IN LISTS ARG_ASSETS)
    string(REGEX REPLACE "^[^=]*=" "" path "${entry}")
    list(APPEND paths ${path})
    string(APPEND lines "${entry}\n")
  endforeach()
  file(CONFIGURE OUTPUT ${manifest} CONTENT "${lines}" @ONLY)
  add_custom_command(
    OUTPUT ${output}
    COMMAND ${CMAKE_COMMAND} -DMANIFEST=${manifest} -DOUTPUT=${output} -DHEADER=${ARG_HEADER}
            -DFUNCTION=${ARG_FUNCTION} -P ${LOAM_EMBED_SCRIPT}
    DEPENDS ${paths} ${manifest} ${LOAM_EMBED_SCRIPT}
    COMMENT "Embedding ${stem}"
    VERBATIM)
  target_sources(${ARG_TARGET} PRIVATE ${output})
endfunction()
