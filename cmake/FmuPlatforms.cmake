# The shared libraries of the FMUs. Each platform has a build tree of its own in platforms/PLATFORM, compiled by zig,
# and what an FMU holds for a platform comes from there, whether it is packed for this machine alone (`make fmus`, the
# tests, the wheel) or for all platforms (`make fmus ALL=1`): what is tested is what users get.
include(ExternalProject)

option(GIVEWAY_NATIVE_FMUS "Compile the FMUs with this tree's own compiler instead of zig: for debuggers and sanitisers" OFF)
if(GIVEWAY_PLATFORM OR NOT GIVEWAY_SYSTEM IN_LIST GIVEWAY_PLATFORMS)
  set(GIVEWAY_NATIVE_FMUS ON)
endif()

if(NOT GIVEWAY_NATIVE_FMUS)
  execute_process(
    COMMAND "${Python3_EXECUTABLE}" -c
            "import importlib.util, pathlib; print(pathlib.Path(importlib.util.find_spec('ziglang').origin).parent / 'zig')"
    OUTPUT_VARIABLE GIVEWAY_ZIG OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  if(NOT EXISTS "${GIVEWAY_ZIG}")
    message(FATAL_ERROR "zig was not found: ${Python3_EXECUTABLE} has no package ziglang (cmake/requirements.lock names the version). "
                        "-DGIVEWAY_NATIVE_FMUS=ON does without it.")
  endif()
endif()

# VARIABLE: the shared library of the FMU `MODULE` for a platform.
function(giveway_platform_library MODULE PLATFORM VARIABLE)
  giveway_fmu_suffix(${PLATFORM} _suffix)
  set(${VARIABLE} "${CMAKE_BINARY_DIR}/platforms/${PLATFORM}/binaries/${MODULE}${_suffix}" PARENT_SCOPE)
endfunction()

# The build trees, as targets platform_PLATFORM; one is built when a file from it is wanted. MODULE...: all FMUs.
function(giveway_add_platforms)
  add_custom_target(batch_all)
  foreach(_platform IN LISTS GIVEWAY_PLATFORMS)
    set(_libraries "")
    foreach(_module IN LISTS ARGN)
      giveway_platform_library(${_module} ${_platform} _library)
      list(APPEND _libraries "${_library}")
    endforeach()
    giveway_add_platform(${_platform} fmu_binaries ${_libraries})
    # For the wheels, in the same tree after the FMUs.
    ExternalProject_Add_Step(platform_${_platform} batch COMMAND ${GIVEWAY_PLATFORM_BUILD} --target giveway_batch
                             DEPENDEES build EXCLUDE_FROM_MAIN ON ALWAYS ON USES_TERMINAL ON)
    ExternalProject_Add_StepTargets(platform_${_platform} batch)
    add_dependencies(batch_all platform_${_platform}-batch)
  endforeach()
endfunction()

set(_zig_cache "${CMAKE_BINARY_DIR}/platforms/zig-cache")
set(GIVEWAY_PLATFORM_BUILD "${CMAKE_COMMAND}" -E env "ZIG_GLOBAL_CACHE_DIR=${_zig_cache}" "ZIG_LOCAL_CACHE_DIR=${_zig_cache}"
                           "NINJA_STATUS=[FMUs %f/%t] " "${CMAKE_COMMAND}" --build <BINARY_DIR>)

# The tree of a platform, which makes TARGET and with it the files.
function(giveway_add_platform PLATFORM TARGET)
  set(_folder "${CMAKE_BINARY_DIR}/platforms")
  ExternalProject_Add(
    platform_${PLATFORM}
    EXCLUDE_FROM_ALL ON
    PREFIX "${_folder}/steps"
    SOURCE_DIR "${PROJECT_SOURCE_DIR}"
    BINARY_DIR "${_folder}/${PLATFORM}"
    CMAKE_ARGS --fresh # a tree keeps its first compiler, which may be gone
               "-DCMAKE_TOOLCHAIN_FILE=${PROJECT_SOURCE_DIR}/cmake/Platform.cmake" "-DGIVEWAY_PLATFORM=${PLATFORM}"
               "-DGIVEWAY_ZIG=${GIVEWAY_ZIG}" "-DGIVEWAY_SUNDIALS_VENDOR=${GIVEWAY_SUNDIALS_VENDOR}"
               "-DPython3_EXECUTABLE=${Python3_EXECUTABLE}" "-DCMAKE_MAKE_PROGRAM=${CMAKE_MAKE_PROGRAM}"
               # One link at a time: with an empty cache two that make zig's run-time routines can wait for each
               # other's lock for ever.
               -DCMAKE_JOB_POOLS=linking=1 -DCMAKE_JOB_POOL_LINK=linking
    BUILD_COMMAND ${GIVEWAY_PLATFORM_BUILD} --target ${TARGET}
    BUILD_ALWAYS ON # that tree knows what has changed
    USES_TERMINAL_BUILD ON # one after the other: each takes all processors
    BUILD_BYPRODUCTS ${ARGN}
    INSTALL_COMMAND ""
    LOG_CONFIGURE ON
    LOG_OUTPUT_ON_FAILURE ON)
endfunction()
