# What every one of our own targets is compiled with. Contracted or reassociated arithmetic would make
# results depend on the compiler, so contraction is off everywhere.
function(giveway_compile_options TARGET)
  target_compile_options(
    ${TARGET}
    PRIVATE -Wall -Wextra -Wconversion -Werror -ffp-contract=off
            "-ffile-prefix-map=${CMAKE_BINARY_DIR}=build" "-ffile-prefix-map=${CMAKE_SOURCE_DIR}=."
            $<$<COMPILE_LANGUAGE:CXX>:-fno-exceptions -fno-rtti>
            # -Wconversion of C++ means the same set of warnings with clang as with gcc.
            $<$<COMPILE_LANG_AND_ID:CXX,Clang>:-Wno-sign-conversion>)
  set_target_properties(${TARGET} PROPERTIES C_STANDARD 99 C_STANDARD_REQUIRED ON C_EXTENSIONS OFF
                                             CXX_STANDARD 20 CXX_STANDARD_REQUIRED ON CXX_EXTENSIONS OFF)
endfunction()

# Files that compute several designs side by side. gcc 12 contracts a * b +- c to one rounding when it makes vectors of
# scalar code by itself (vfmsubadd), whatever -ffp-contract says: it must not do that here.
set(GIVEWAY_LANES_4 -mavx2 -fno-tree-slp-vectorize)
set(GIVEWAY_LANES_8 -mavx512f -mavx512dq -mavx512vl -fno-tree-slp-vectorize)
# gcc copies and clears a state of lanes (2 kB) with `rep`, whose start alone takes as long as a vector loop.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  foreach(_lanes GIVEWAY_LANES_4 GIVEWAY_LANES_8)
    list(APPEND ${_lanes} -mmemcpy-strategy=vector_loop:-1:noalign -mmemset-strategy=vector_loop:-1:noalign)
  endforeach()
endif()
