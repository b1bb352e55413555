# Unity builds: the sources of a folder are compiled as one file, because parsing the headers of most sources costs more than
# compiling their code. The preset dev (CMAKE_UNITY_BUILD=OFF) compiles every source alone, which shows missing includes.
if(PROJECT_IS_TOP_LEVEL AND NOT DEFINED CMAKE_UNITY_BUILD)
  set(CMAKE_UNITY_BUILD ON)
endif()

# pointsweep_group_by_folder(TARGET): one group for each folder. Sources that Highway compiles once per instruction set
# include themselves and stay alone.
function(pointsweep_group_by_folder target)
  set_target_properties(${target} PROPERTIES UNITY_BUILD_MODE GROUP)
  get_target_property(sources ${target} SOURCES)
  foreach(source ${sources})
    file(STRINGS ${source} once_per_instruction_set REGEX "foreach_target.h" LIMIT_COUNT 1)
    get_filename_component(folder ${source} DIRECTORY)
    file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR} ${folder})
    string(MAKE_C_IDENTIFIER "${folder}" group)
    if(NOT once_per_instruction_set)
      set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${group})
    endif()
  endforeach()
endfunction()
