# Unity builds: the sources of a layer are compiled as one file, because parsing the headers of most sources costs more than
# compiling their code. The preset dev (CMAKE_UNITY_BUILD=OFF) compiles every source alone, which shows missing includes.
if(PROJECT_IS_TOP_LEVEL AND NOT DEFINED CMAKE_UNITY_BUILD)
  set(CMAKE_UNITY_BUILD ON)
endif()
set(POINTSWEEP_COMPILED_ALONE "" CACHE STRING "Sources of the library and of cli/ that are compiled alone, as paths from the top")
mark_as_advanced(POINTSWEEP_COMPILED_ALONE)

# pointsweep_group_by_layer(TARGET [GROUPS]): makes one group for each layer, or GROUPS groups. The folders inside a layer are compiled
# together, except for the folders of formats/, which include nothing of each other. Sources that Highway compiles
# once per instruction set include themselves and stay alone, as do those in POINTSWEEP_COMPILED_ALONE: script/mutants
# changes one at a time, and compiles it at -O1, which takes half the time and gives the same bytes in every result.
# threads.cpp stays alone, so that a program can link other definitions of its functions (bench/span).
# Vector code makes many temporaries. With the address sanitizer's check of scopes curvature_kernel.cpp takes 7 minutes of CPU time
# to compile (GCC 12.2), without it 8 seconds, so the check is off there. In a release the vector code of operators is compiled with -O2:
# it takes half the time of -O3, and runs as fast. The rest of the library takes 8 % more CPU time to run with -O2.
function(pointsweep_group_by_layer target)
  set_target_properties(${target} PROPERTIES UNITY_BUILD_MODE GROUP)
  get_target_property(sources ${target} SOURCES)
  set(groups ${ARGN} 1)
  list(GET groups 0 groups)
  set(place 0)
  foreach(source ${sources})
    file(RELATIVE_PATH name ${PROJECT_SOURCE_DIR} ${source})
    file(STRINGS ${source} once_per_instruction_set REGEX "foreach_target.h" LIMIT_COUNT 1)
    get_filename_component(folder ${source} DIRECTORY)
    file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR} ${folder})
    if(NOT folder MATCHES "^pointsweep/(formats|verify/formulas)")
      string(REGEX REPLACE "^(cli|pointsweep/[^/]*)/.*" "\\1" folder "${folder}")
    endif()
    string(MAKE_C_IDENTIFIER "${folder}" group)
    if(name IN_LIST POINTSWEEP_COMPILED_ALONE)
      set_source_files_properties(${source} PROPERTIES COMPILE_OPTIONS -O1 SKIP_PRECOMPILE_HEADERS ON)
    elseif(once_per_instruction_set)
      if(POINTSWEEP_SETS_LEFT_OUT)
        set_source_files_properties(${source} PROPERTIES COMPILE_DEFINITIONS "POINTSWEEP_SETS_LEFT_OUT=${POINTSWEEP_SETS_LEFT_OUT}")
      endif()
      if(POINTSWEEP_SANITIZE MATCHES address)
        set_source_files_properties(${source} PROPERTIES COMPILE_OPTIONS -fno-sanitize-address-use-after-scope)
      elseif(name MATCHES "^pointsweep/operators/")
        set_source_files_properties(${source} PROPERTIES COMPILE_OPTIONS "$<$<CONFIG:Release>:-O2>")
      endif()
    elseif(NOT name STREQUAL "pointsweep/threads.cpp")
      math(EXPR part "${place} % ${groups}")
      math(EXPR place "${place} + 1")
      set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${group}_${part})
    endif()
  endforeach()
endfunction()
