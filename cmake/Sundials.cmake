# SUNDIALS 7.1.1 as one static, optimised library: target giveway_sundials.
#
# The C sources come from a Rust package registry (the crate sundials-sys carries them), pinned by
# cmake/sundials/Cargo.lock with its checksum. Only the files that ERK stepping (ARKODE) and BDF/Adams
# stepping (CVODE) with dense linear algebra need are compiled; no MPI, no profiling, no monitoring.
# Nothing but fmu/solver may link this target.

set(GIVEWAY_SUNDIALS_VENDOR "${CMAKE_BINARY_DIR}/sundials-source"
    CACHE PATH "where the SUNDIALS sources are fetched to; several build trees can share it")
set(_sundials_vendor "${GIVEWAY_SUNDIALS_VENDOR}")
set(GIVEWAY_SUNDIALS_SOURCE "${_sundials_vendor}/sundials-sys-0.6.2/vendor")
set(_sundials_in_archive "${PROJECT_SOURCE_DIR}/vendor/sundials") # of the source archive (release/sdist.py)
set(_sundials_lock "${CMAKE_CURRENT_LIST_DIR}/sundials/Cargo.lock")
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${_sundials_lock}")

if(EXISTS "${_sundials_in_archive}/LICENSE")
  set(GIVEWAY_SUNDIALS_SOURCE "${_sundials_in_archive}")
elseif(NOT EXISTS "${GIVEWAY_SUNDIALS_SOURCE}/LICENSE"
   OR "${_sundials_lock}" IS_NEWER_THAN "${_sundials_vendor}/fetched")
  find_program(GIVEWAY_CARGO cargo DOC "cargo, to fetch the SUNDIALS sources")
  if(NOT GIVEWAY_CARGO)
    message(FATAL_ERROR "cargo was not found; it fetches the SUNDIALS sources. "
                        "Install it (Debian 12: apt-get install cargo-web).")
  endif()
  message(STATUS "Fetching the SUNDIALS sources with ${GIVEWAY_CARGO}")
  execute_process(
    COMMAND "${GIVEWAY_CARGO}" vendor --quiet --locked --versioned-dirs --manifest-path
            "${CMAKE_CURRENT_LIST_DIR}/sundials/Cargo.toml" "${_sundials_vendor}"
    RESULT_VARIABLE _failed
    OUTPUT_QUIET
    ERROR_VARIABLE _message)
  if(_failed)
    message(FATAL_ERROR "Fetching the SUNDIALS sources failed (cargo 1.78 or newer is needed, on "
                        "Debian 12 the package cargo-web):\n${_message}")
  endif()
  # cargo also downloads the Rust packages that sundials-sys depends on; none is used here.
  file(GLOB _crates LIST_DIRECTORIES true "${_sundials_vendor}/*")
  list(REMOVE_ITEM _crates "${_sundials_vendor}/sundials-sys-0.6.2")
  file(REMOVE_RECURSE ${_crates})
  file(TOUCH "${_sundials_vendor}/fetched")
endif()
set(GIVEWAY_SUNDIALS_LICENCE "${GIVEWAY_SUNDIALS_SOURCE}/LICENSE")

# sundials_config.h from SUNDIALS' own template: a release build with 64-bit indices.
function(_giveway_configure_sundials)
  set(PRECISION_LEVEL "#define SUNDIALS_DOUBLE_PRECISION 1")
  set(INDEX_TYPE "#define SUNDIALS_INT64_T 1")
  set(SUNDIALS_CINDEX_TYPE int64_t)
  set(SUNDIALS_DEPRECATED_MSG_MACRO "__attribute__((__deprecated__(msg)))")
  set(PACKAGE_VERSION 7.1.1)
  set(PACKAGE_VERSION_MAJOR 7)
  set(PACKAGE_VERSION_MINOR 1)
  set(PACKAGE_VERSION_PATCH 1)
  set(SUNDIALS_C_COMPILER_HAS_BUILTIN_EXPECT TRUE)
  set(SUNDIALS_C_COMPILER_HAS_ATTRIBUTE_UNUSED TRUE)
  # An FMU does not write to the console: errors reach us through an error handler instead.
  set(SUNDIALS_LOGGING_LEVEL 0)
  set(SUNDIALS_HAVE_POSIX_TIMERS ${UNIX})
  # The template also records how SUNDIALS was built. Whatever differs from machine to machine is left
  # out so that binaries do not depend on where they were built.
  foreach(_name CMAKE_C_FLAGS CMAKE_CXX_FLAGS CMAKE_C_COMPILER_VERSION CMAKE_CXX_COMPILER_VERSION
                CMAKE_C_COMPILER_ID CMAKE_CXX_COMPILER_ID)
    set(${_name} "")
  endforeach()
  configure_file("${GIVEWAY_SUNDIALS_SOURCE}/include/sundials/sundials_config.in"
                 "${CMAKE_BINARY_DIR}/sundials/include/sundials/sundials_config.h")
  # Static only: nothing is imported or exported.
  file(CONFIGURE OUTPUT "${CMAKE_BINARY_DIR}/sundials/include/sundials/sundials_export.h" CONTENT
"#ifndef SUNDIALS_EXPORT_H
#define SUNDIALS_EXPORT_H
#define SUNDIALS_EXPORT
#define SUNDIALS_NO_EXPORT
#define SUNDIALS_DEPRECATED __attribute__((__deprecated__))
#define SUNDIALS_DEPRECATED_EXPORT SUNDIALS_DEPRECATED
#define SUNDIALS_DEPRECATED_NO_EXPORT SUNDIALS_DEPRECATED
#endif
")
endfunction()
_giveway_configure_sundials()

set(_sundials_files
    arkode/arkode.c
    arkode/arkode_adapt.c
    arkode/arkode_butcher.c
    arkode/arkode_butcher_dirk.c
    arkode/arkode_butcher_erk.c
    arkode/arkode_erkstep.c
    arkode/arkode_erkstep_io.c
    arkode/arkode_interp.c
    arkode/arkode_io.c
    arkode/arkode_ls.c
    arkode/arkode_relaxation.c
    arkode/arkode_root.c
    arkode/arkode_user_controller.c
    cvode/cvode.c
    cvode/cvode_io.c
    cvode/cvode_ls.c
    cvode/cvode_nls.c
    cvode/cvode_proj.c
    nvector/serial/nvector_serial.c
    sunadaptcontroller/imexgus/sunadaptcontroller_imexgus.c
    sunadaptcontroller/soderlind/sunadaptcontroller_soderlind.c
    sundials/sundials_adaptcontroller.c
    sundials/sundials_band.c
    sundials/sundials_context.c
    sundials/sundials_dense.c
    sundials/sundials_direct.c
    sundials/sundials_errors.c
    sundials/sundials_hashmap.c
    sundials/sundials_iterative.c
    sundials/sundials_linearsolver.c
    sundials/sundials_logger.c
    sundials/sundials_math.c
    sundials/sundials_matrix.c
    sundials/sundials_memory.c
    sundials/sundials_nonlinearsolver.c
    sundials/sundials_nvector.c
    sundials/sundials_nvector_senswrapper.c
    sundials/sundials_version.c
    sunlinsol/dense/sunlinsol_dense.c
    sunmatrix/band/sunmatrix_band.c
    sunmatrix/dense/sunmatrix_dense.c
    sunmatrix/sparse/sunmatrix_sparse.c
    sunmemory/system/sundials_system_memory.c
    sunnonlinsol/fixedpoint/sunnonlinsol_fixedpoint.c
    sunnonlinsol/newton/sunnonlinsol_newton.c)
list(TRANSFORM _sundials_files PREPEND "${GIVEWAY_SUNDIALS_SOURCE}/src/")

add_library(giveway_sundials STATIC EXCLUDE_FROM_ALL ${_sundials_files})
target_include_directories(giveway_sundials SYSTEM PUBLIC "${CMAKE_BINARY_DIR}/sundials/include"
                                                          "${GIVEWAY_SUNDIALS_SOURCE}/include")
target_include_directories(giveway_sundials PRIVATE "${GIVEWAY_SUNDIALS_SOURCE}/src/sundials")
target_compile_definitions(giveway_sundials PUBLIC SUNDIALS_STATIC_DEFINE)
set_target_properties(giveway_sundials PROPERTIES C_STANDARD 11 C_EXTENSIONS ON)
target_compile_options(giveway_sundials PRIVATE -w -O3 -ffp-contract=off -ffunction-sections
                                                -fdata-sections "-ffile-prefix-map=${GIVEWAY_SUNDIALS_SOURCE}=sundials"
                                                "-ffile-prefix-map=${CMAKE_BINARY_DIR}=.")
