# Toolchain file for the platforms that FMUs are built for: zig's clang, which brings the C libraries of all of them.
# Used by FmuPlatforms.cmake with
#
#   -DGIVEWAY_PLATFORM=x86_64-windows   an FMI 3 platform tuple, one of those below; or wasm32-wasi: the batch library
#                                       for browsers (web/)
#   -DGIVEWAY_ZIG=FILE                  zig's binary
set(GIVEWAY_PLATFORM "" CACHE STRING "FMI 3 platform tuple to build FMU binaries for")
set(GIVEWAY_ZIG "" CACHE FILEPATH "zig")
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES GIVEWAY_PLATFORM GIVEWAY_ZIG)

# The oldest systems that are supported are part of the target.
set(_system_of_linux Linux)
set(_system_of_windows Windows)
set(_system_of_darwin Darwin)
set(_system_of_wasi Generic) # no system: what there is of one comes from the caller
set(_target_of_x86_64-linux x86_64-linux-gnu.2.17)
set(_target_of_aarch64-linux aarch64-linux-gnu.2.17)
set(_target_of_x86_64-windows x86_64-windows-gnu)
set(_target_of_x86_64-darwin x86_64-macos.11.0)
set(_target_of_aarch64-darwin aarch64-macos.11.0)
set(_target_of_wasm32-wasi wasm32-wasi)
if(NOT DEFINED _target_of_${GIVEWAY_PLATFORM})
  message(FATAL_ERROR "GIVEWAY_PLATFORM is '${GIVEWAY_PLATFORM}', but must be one of x86_64-linux, aarch64-linux, "
                      "x86_64-windows, x86_64-darwin, aarch64-darwin, wasm32-wasi")
endif()
string(REGEX MATCH "(.*)-(.*)" _ "${GIVEWAY_PLATFORM}")
set(CMAKE_SYSTEM_PROCESSOR ${CMAKE_MATCH_1})
set(CMAKE_SYSTEM_NAME ${_system_of_${CMAKE_MATCH_2}})

# A compiler cache may hand on other file names than it was given, and file names get into libraries; zig has its own.
unset(ENV{CMAKE_C_COMPILER_LAUNCHER})
unset(ENV{CMAKE_CXX_COMPILER_LAUNCHER})

set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)

set(CMAKE_C_COMPILER "${GIVEWAY_ZIG}" cc)
set(CMAKE_CXX_COMPILER "${GIVEWAY_ZIG}" c++)
foreach(_language C CXX)
  set(CMAKE_${_language}_COMPILER_TARGET ${_target_of_${GIVEWAY_PLATFORM}})
  # The compiler works; CMake's test program would need a C++ library for each platform.
  set(CMAKE_${_language}_COMPILER_WORKS TRUE)
endforeach()

# CMake wants archiver and ranlib as files without arguments.
set(_tools "${CMAKE_BINARY_DIR}/zig")
foreach(_tool ar ranlib)
  file(CONFIGURE OUTPUT "${_tools}/${_tool}" CONTENT "#!/bin/sh\nexec '${GIVEWAY_ZIG}' ${_tool} \"$@\"\n")
  file(CHMOD "${_tools}/${_tool}" PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE)
endforeach()
set(CMAKE_AR "${_tools}/ar")
set(CMAKE_RANLIB "${_tools}/ranlib")
