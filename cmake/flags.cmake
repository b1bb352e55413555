# Compiler flags of every target of this project. Warnings are errors in our own presets and scripts alone
# (CMAKE_COMPILE_WARNING_AS_ERROR), because compilers that the project is not tested with warn of other things. Values are made of plain
# IEEE operations: contraction into fused multiply-adds is off, so that a result has the same bytes on every instruction set.
add_library(pointsweep_flags INTERFACE)
target_compile_options(pointsweep_flags INTERFACE -ffp-contract=off -Wall -Wextra -Wshadow -Wconversion -Wno-sign-conversion)
# GCC 12 warns wrongly of overlapping copies inside std::string (its bug 105651).
# In a unity build GCC takes the anonymous namespaces of included sources for those of headers.
target_compile_options(pointsweep_flags INTERFACE "$<$<CXX_COMPILER_ID:GNU>:-Wno-restrict;-Wno-subobject-linkage>")
set(CMAKE_CXX_EXTENSIONS OFF)
set(POINTSWEEP_SANITIZE "" CACHE STRING "Sanitizers, e.g. address,undefined or thread")
option(POINTSWEEP_CHECK_POINTERS "With the sanitizers address,undefined: check every pointer for null and misalignment" OFF)
if(POINTSWEEP_SANITIZE)
  add_compile_options(-fsanitize=${POINTSWEEP_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${POINTSWEEP_SANITIZE})
  # A failed check of undefined behaviour traps, and the address sanitizer prints its place in the source (script/sanitize). The tables for
  # messages would be most of each program and of its time to start, and the tests start the tool thousands of times.
  if(POINTSWEEP_SANITIZE MATCHES address.*undefined)
    add_compile_options(-fsanitize-undefined-trap-on-error)
    # These two checks take a third of the time to compile. The address sanitizer finds the use of a null pointer as well.
    if(NOT POINTSWEEP_CHECK_POINTERS)
      add_compile_options(-fno-sanitize=null,alignment)
    endif()
  endif()
  # GCC warns wrongly of std::regex, because the sanitizers change its inlining.
  target_compile_options(pointsweep_flags INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
endif()
