# giveway_add_fmu(NAME controller SOURCES ... [LIBRARIES ...] [TABLE file] [SHARES file] [ROBOT file] [OUTPUT dir]
#                 [LICENCES NAME=FILE ...] [SHIP FILE ...])
#
# SHIP: the files of the model and of what it is linked to, for an FMU that an importer can compile; the shell's are
# added.
# SHARES: the table that TABLE shares entries with. The equations of the documentation page are read from equations.txt
# beside the caller's CMakeLists.txt, if there is one.
#
# Builds the model as static library giveway_<name>_model (for the batch library and tests), takes the shared library,
# one for FMI 2.0 and 3.0, from the trees of the platforms, and packs giveway_<name>_fmi2.fmu and
# giveway_<name>_fmi3.fmu: for this machine in fmus/, for all platforms in fmus_all/. With OUTPUT, a folder, the FMU is
# one for tests, compiled in this tree and packed there.
# Defaults: TABLE variables.toml beside the caller's CMakeLists.txt, ROBOT robots/trikey.toml.
add_custom_target(fmus ALL)
add_custom_target(fmus_all)
add_custom_target(fmu_binaries) # in the tree of a platform: the shared libraries alone
set_property(GLOBAL PROPERTY GIVEWAY_FMU_MODULES "")

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
  # The entry (..._fmu.cpp) names the model of the binary. The linker takes it out of the archive only if a shell or a
  # test refers to it, so a library of several models contains none.
  add_library(${_module}_model STATIC ${ARG_SOURCES} ${_code})
  giveway_compile_options(${_module}_model)
  target_include_directories(${_module}_model PUBLIC "${_generated}" "${PROJECT_SOURCE_DIR}/fmu/models"
                                                     "${CMAKE_CURRENT_SOURCE_DIR}")
  target_link_libraries(${_module}_model PUBLIC ${ARG_LIBRARIES})

  if(GIVEWAY_PLATFORM MATCHES "wasi$") # no FMUs, only the batch library
    return()
  endif()
  if(GIVEWAY_NATIVE_FMUS OR ARG_OUTPUT)
    add_library(${_module} MODULE "${PROJECT_SOURCE_DIR}/fmu/shell/heap.cpp")
    giveway_compile_options(${_module})
    target_link_libraries(${_module} PRIVATE giveway_fmi_shell ${_module}_model)
    giveway_link_fmu(${_module})
  endif()
  if(GIVEWAY_PLATFORM)
    set_target_properties(${_module} PROPERTIES LIBRARY_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/binaries")
    add_dependencies(fmu_binaries ${_module})
    return()
  endif()

  set(_licences "license.txt=${PROJECT_SOURCE_DIR}/LICENSE" ${ARG_LICENCES})
  set(_contents GENERATED "${_generated}" GENERATED_FILES ${_generated_files})
  if(ARG_OUTPUT)
    giveway_pack_fmu(${_module} ALL TARGET fmu_${ARG_NAME} FOLDER "${ARG_OUTPUT}" LICENCES ${_licences} ${_contents})
    return()
  endif()
  set_property(GLOBAL APPEND PROPERTY GIVEWAY_FMU_MODULES ${_module})
  set(_folder "${CMAKE_BINARY_DIR}/fmus")
  if(GIVEWAY_NATIVE_FMUS)
    giveway_pack_fmu(${_module} TARGET fmu_${ARG_NAME} FOLDER "${_folder}" LICENCES ${_licences} ${_contents})
  else()
    # What zig puts into libraries: its own run-time routines, templates of libc++, and those of MinGW-w64 and musl for
    # Windows.
    get_filename_component(_zig "${GIVEWAY_ZIG}" DIRECTORY)
    list(APPEND _licences "zig.txt=${_zig}/LICENSE" "libcxx.txt=${_zig}/lib/libcxx/LICENSE.TXT")
    giveway_pack_fmu(${_module} TARGET fmu_${ARG_NAME} FOLDER "${_folder}" PLATFORMS ${GIVEWAY_SYSTEM} LICENCES ${_licences}
                     ${_contents})
    list(APPEND _licences "mingw-w64.txt=${_zig}/lib/libc/mingw/COPYING" "musl.txt=${_zig}/lib/libc/musl/COPYRIGHT")
    giveway_pack_fmu(${_module} TARGET fmu_${ARG_NAME}_all FOLDER "${_folder}_all" PLATFORMS ${GIVEWAY_PLATFORMS}
                     LICENCES ${_licences} ${_contents})
    add_dependencies(fmus_all fmu_${ARG_NAME}_all)
  endif()
  add_dependencies(fmus fmu_${ARG_NAME})
  install(FILES "${_folder}/${_module}_fmi2.fmu" "${_folder}/${_module}_fmi3.fmu" DESTINATION giveway/native COMPONENT native)
  install(FILES "${_table_written_out}" DESTINATION giveway/native COMPONENT native)
endfunction()

# Target TARGET: MODULE_fmi2.fmu and MODULE_fmi3.fmu in FOLDER, with the libraries of PLATFORMS or, without, that of
# this tree.
function(giveway_pack_fmu MODULE)
  cmake_parse_arguments(ARG "ALL" "TARGET;FOLDER;GENERATED" "PLATFORMS;LICENCES;GENERATED_FILES" ${ARGN})
  set(_arguments "")
  set(_depends ${ARG_GENERATED_FILES} ${GIVEWAY_CODEGEN_FILES})
  if(ARG_PLATFORMS)
    foreach(_platform IN LISTS ARG_PLATFORMS)
      giveway_platform_library(${MODULE} ${_platform} _library)
      list(APPEND _arguments --binary "${_platform}=${_library}")
      list(APPEND _depends platform_${_platform} "${_library}")
    endforeach()
  else()
    list(APPEND _arguments --binary "${GIVEWAY_SYSTEM}=$<TARGET_FILE:${MODULE}>")
    list(APPEND _depends ${MODULE})
  endif()
  foreach(_licence IN LISTS ARG_LICENCES)
    list(APPEND _arguments --licence "${_licence}")
  endforeach()
  set(_fmus "")
  foreach(_fmi 2 3)
    set(_fmu "${ARG_FOLDER}/${MODULE}_fmi${_fmi}.fmu")
    add_custom_command(
      OUTPUT "${_fmu}"
      COMMAND ${GIVEWAY_CODEGEN} package --fmi ${_fmi} --generated "${ARG_GENERATED}" ${_arguments} --out "${_fmu}"
      DEPENDS ${_depends}
      COMMENT "Packing ${_fmu}"
      VERBATIM)
    list(APPEND _fmus "${_fmu}")
  endforeach()
  set(_all "")
  if(ARG_ALL)
    set(_all ALL)
  endif()
  add_custom_target(${ARG_TARGET} ${_all} DEPENDS ${_fmus})
endfunction()
