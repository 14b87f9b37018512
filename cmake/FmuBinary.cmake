# How an FMU's shared library is linked on each system: it exports only FMI's functions, needs nothing but the
# C library, and its bytes do not tell where or when it was built.
set(GIVEWAY_PLATFORMS x86_64-linux aarch64-linux x86_64-windows x86_64-darwin aarch64-darwin)
# FMI 3's name of the system that is built for.
string(TOLOWER "${CMAKE_SYSTEM_PROCESSOR}-${CMAKE_SYSTEM_NAME}" GIVEWAY_SYSTEM)
string(REPLACE arm64 aarch64 GIVEWAY_SYSTEM "${GIVEWAY_SYSTEM}")
string(REPLACE amd64 x86_64 GIVEWAY_SYSTEM "${GIVEWAY_SYSTEM}")

# Of a platform's shared libraries.
function(giveway_fmu_suffix PLATFORM VARIABLE)
  if(PLATFORM MATCHES "windows$")
    set(${VARIABLE} .dll PARENT_SCOPE)
  elseif(PLATFORM MATCHES "darwin$")
    set(${VARIABLE} .dylib PARENT_SCOPE)
  else()
    set(${VARIABLE} .so PARENT_SCOPE)
  endif()
endfunction()

# Linked as C: no C++ runtime goes into the binary; shell/heap.cpp is all of it that is needed.
function(giveway_link_fmu MODULE)
  giveway_link_alone(${MODULE} "${PROJECT_SOURCE_DIR}/fmu/shell/exports.map")
endfunction()

# The same for any library; MAP says what a library for Linux exports.
function(giveway_link_alone MODULE MAP)
  giveway_fmu_suffix("${GIVEWAY_SYSTEM}" _suffix)
  set_target_properties(${MODULE} PROPERTIES PREFIX "" SUFFIX ${_suffix} LINKER_LANGUAGE C)
  if(CMAKE_SYSTEM_NAME STREQUAL "Windows")
    # The headers of FMI say dllexport, and then nothing else is exported.
    target_link_options(${MODULE} PRIVATE -Wl,--gc-sections -s)
  elseif(CMAKE_SYSTEM_NAME STREQUAL "Darwin")
    # What is not hidden is exported: FMI's functions, which their headers mark.
    target_compile_options(${MODULE} PRIVATE -fvisibility-global-new-delete=force-hidden)
    # Without this name the library would be known by the path it was linked to.
    target_link_options(${MODULE} PRIVATE -dynamiclib "-Wl,-install_name,@rpath/${MODULE}${_suffix}" -Wl,-dead_strip -s)
  else()
    target_link_options(${MODULE} PRIVATE -static-libgcc -Wl,--gc-sections -Wl,--as-needed -Wl,--no-undefined
                        -Wl,--build-id=none -s "-Wl,--version-script=${MAP}")
    set_property(TARGET ${MODULE} APPEND PROPERTY LINK_DEPENDS "${MAP}")
  endif()
endfunction()
