# giveway_add_fmu(NAME controller SOURCES ... [LIBRARIES ...] [TABLE file] [SHARES file] [ROBOT file] [OUTPUT dir]
#                 [LICENCES NAME=FILE ...] [SHIP FILE ...])
#
# SHIP: the files of the model and of what it is linked to, for an FMU that an importer can compile; the shell's are added.
# SHARES: the table that TABLE shares entries with.
# The equations of the documentation page are read from equations.txt beside the caller's CMakeLists.txt, if there is one.
#
# Builds the model as static library giveway_<name>_model (for the batch library and tests), giveway_<name>.so, one binary for
# FMI 2.0 and 3.0, and packs giveway_<name>_fmi2.fmu and giveway_<name>_fmi3.fmu. Defaults: TABLE variables.toml beside the caller's CMakeLists.txt, ROBOT
# robots/trikey.toml, OUTPUT ${CMAKE_BINARY_DIR}/fmus. Target fmu_<name>; target fmus builds those
# with the default OUTPUT.
add_custom_target(fmus ALL)
add_custom_target(fmu_binaries) # their shared libraries alone

set(GIVEWAY_CODEGEN_DIR "${PROJECT_SOURCE_DIR}/fmu/codegen")
file(GLOB GIVEWAY_CODEGEN_FILES CONFIGURE_DEPENDS "${GIVEWAY_CODEGEN_DIR}/giveway_codegen/*.py")
set(GIVEWAY_CODEGEN "${CMAKE_COMMAND}" -E env "PYTHONPATH=${GIVEWAY_CODEGEN_DIR}" PYTHONDONTWRITEBYTECODE=1
                    "${Python3_EXECUTABLE}" -m giveway_codegen)

function(giveway_add_fmu)
  cmake_parse_arguments(ARG "" "NAME;TABLE;SHARES;ROBOT;OUTPUT" "SOURCES;LIBRARIES;LICENCES;SHIP" ${ARGN})
  if(NOT ARG_TABLE)
    set(ARG_TABLE "${CMAKE_CURRENT_SOURCE_DIR}/variables.toml")
  endif()
  if(NOT ARG_ROBOT)
    set(ARG_ROBOT "${PROJECT_SOURCE_DIR}/robots/trikey.toml")
  endif()
  set(_generated "${CMAKE_CURRENT_BINARY_DIR}/generated_${ARG_NAME}")
  set(_code "${_generated}/${ARG_NAME}_variables.hpp" "${_generated}/${ARG_NAME}_variables.cpp"
            "${_generated}/${ARG_NAME}_fmu.cpp")
  set(_table_written_out "${_generated}/${ARG_NAME}.variables.toml")
  set(_generated_files ${_code} "${_table_written_out}" "${_generated}/fmi2/modelDescription.xml" "${_generated}/fmi3/modelDescription.xml"
                       "${_generated}/common/documentation/index.html")
  set(_options "")
  set(_equations "${CMAKE_CURRENT_SOURCE_DIR}/equations.txt")
  if(EXISTS "${_equations}")
    list(APPEND _options --equations "${_equations}")
  else()
    set(_equations "")
  endif()
  if(ARG_SHIP)
    list(APPEND ARG_SHIP ${GIVEWAY_SHELL_FILES})
    list(APPEND _options --ship ${ARG_SHIP})
  endif()
  add_custom_command(
    OUTPUT ${_generated_files}
    COMMAND ${GIVEWAY_CODEGEN} sources --name ${ARG_NAME} --table "${ARG_TABLE}" --robot "${ARG_ROBOT}"
            --version ${PROJECT_VERSION} ${_options} --out "${_generated}"
    DEPENDS "${ARG_TABLE}" ${ARG_SHARES} "${ARG_ROBOT}" ${_equations} ${ARG_SHIP} ${GIVEWAY_CODEGEN_FILES}
    COMMENT "Generating sources of ${ARG_NAME} from its variable table"
    VERBATIM)

  set(_module giveway_${ARG_NAME})
  # The entry (..._fmu.cpp) says which model is that of the binary. A linker takes it out of the archive only for a
  # shell or a test that asks for it, so a library of several models has none.
  add_library(${_module}_model STATIC ${ARG_SOURCES} ${_code})
  giveway_compile_options(${_module}_model)
  target_include_directories(${_module}_model PUBLIC "${_generated}" "${PROJECT_SOURCE_DIR}/fmu/models"
                                                     "${CMAKE_CURRENT_SOURCE_DIR}")
  target_link_libraries(${_module}_model PUBLIC ${ARG_LIBRARIES})

  add_library(${_module} MODULE "${PROJECT_SOURCE_DIR}/fmu/shell/heap.cpp")
  giveway_compile_options(${_module})
  target_link_libraries(${_module} PRIVATE giveway_fmi_shell ${_module}_model)
  giveway_link_fmu(${_module})

  set(_output "${CMAKE_BINARY_DIR}/fmus")
  if(ARG_OUTPUT)
    set(_output "${ARG_OUTPUT}")
  endif()
  set(_licences --licence "license.txt=${PROJECT_SOURCE_DIR}/LICENSE")
  foreach(_licence IN LISTS ARG_LICENCES)
    list(APPEND _licences --licence "${_licence}")
  endforeach()
  # A tree for another platform packs what lies in the trees of all platforms beside it.
  set(_binaries --binary "${GIVEWAY_SYSTEM}=$<TARGET_FILE:${_module}>")
  set(_binary_files "")
  if(GIVEWAY_PLATFORM)
    set(_binaries "")
    # What zig puts into libraries: its own run-time routines, and those of MinGW-w64 for Windows.
    get_filename_component(_zig "${GIVEWAY_ZIG}" DIRECTORY)
    list(APPEND _licences --licence "zig.txt=${_zig}/LICENSE" --licence "mingw-w64.txt=${_zig}/lib/libc/mingw/COPYING")
    foreach(_platform IN LISTS GIVEWAY_PLATFORMS)
      giveway_fmu_suffix(${_platform} _suffix)
      set(_file "${CMAKE_BINARY_DIR}/../${_platform}/binaries/${_module}${_suffix}")
      list(APPEND _binaries --binary "${_platform}=${_file}")
      if(NOT _platform STREQUAL GIVEWAY_PLATFORM)
        list(APPEND _binary_files "${_file}")
      endif()
    endforeach()
    set_target_properties(${_module} PROPERTIES LIBRARY_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/binaries")
  endif()
  set(_fmus "")
  foreach(_fmi 2 3)
    set(_fmu "${_output}/${_module}_fmi${_fmi}.fmu")
    add_custom_command(
      OUTPUT "${_fmu}"
      COMMAND ${GIVEWAY_CODEGEN} package --fmi ${_fmi} --generated "${_generated}" ${_binaries} ${_licences}
              --out "${_fmu}"
      DEPENDS ${_module} ${_binary_files} ${_generated_files} ${GIVEWAY_CODEGEN_FILES}
      COMMENT "Packing ${_module}_fmi${_fmi}.fmu"
      VERBATIM)
    list(APPEND _fmus "${_fmu}")
  endforeach()
  add_custom_target(fmu_${ARG_NAME} ALL DEPENDS ${_fmus})
  if(NOT ARG_OUTPUT)
    add_dependencies(fmu_binaries ${_module})
    add_dependencies(fmus fmu_${ARG_NAME})
    install(FILES ${_fmus} DESTINATION giveway/native COMPONENT native)
    install(FILES "${_table_written_out}" DESTINATION giveway/native COMPONENT native)
  endif()
endfunction()
