# POINTSWEEP_INSTRUCTION_SETS: the sets that vector code is compiled for. `all` (the default) runs at full speed on every machine;
# `native` compiles the best set of this machine and the baseline, in two thirds of the time. The results have equal bytes, and the
# program also runs on machines that lack this set, with the baseline.
set(POINTSWEEP_INSTRUCTION_SETS all CACHE STRING "Instruction sets of the vector code: all, or native for that of this machine and the baseline")
set_property(CACHE POINTSWEEP_INSTRUCTION_SETS PROPERTY STRINGS all native)
if(NOT POINTSWEEP_INSTRUCTION_SETS MATCHES "^(all|native)$")
  message(FATAL_ERROR "POINTSWEEP_INSTRUCTION_SETS is '${POINTSWEEP_INSTRUCTION_SETS}'; it may be all or native")
endif()

set(POINTSWEEP_SETS_LEFT_OUT "")
if(POINTSWEEP_INSTRUCTION_SETS STREQUAL native)
  execute_process(COMMAND ${CMAKE_CXX_COMPILER} -march=native -dM -E -x c++ /dev/null OUTPUT_VARIABLE macros ERROR_QUIET)
  if(macros MATCHES "__AVX512BW__" AND macros MATCHES "__AVX512VL__")
    set(POINTSWEEP_SETS_LEFT_OUT "(HWY_SSE4|HWY_AVX2)")
  elseif(macros MATCHES "__AVX2__")
    set(POINTSWEEP_SETS_LEFT_OUT "(HWY_SSE4|HWY_AVX3)")
  endif()
endif()
