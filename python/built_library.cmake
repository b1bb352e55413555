# The targets pointsweep_whole, pointsweep_flags and the libraries beside the core that the module links, with the static libraries
# in POINTSWEEP_BUILT.
cmake_path(GET CMAKE_CURRENT_SOURCE_DIR PARENT_PATH repository)
include(${repository}/cmake/flags.cmake)
foreach(package TBB fmt hwy PNG Threads)
  find_package(${package} REQUIRED)
endforeach()
add_library(pointsweep STATIC IMPORTED)
set_target_properties(pointsweep PROPERTIES IMPORTED_LOCATION ${POINTSWEEP_BUILT}/libpointsweep.a
  INTERFACE_INCLUDE_DIRECTORIES ${repository}/include)
set(codecs "")
foreach(library pointsweep_remote pointsweep_codecs) # pointsweep_remote contains pointsweep_codecs
  if(NOT codecs AND EXISTS ${POINTSWEEP_BUILT}/codecs/release/lib${library}.a)
    set(codecs ${POINTSWEEP_BUILT}/codecs/release/lib${library}.a)
  endif()
endforeach()
target_link_libraries(pointsweep INTERFACE fmt::fmt TBB::tbb hwy::hwy hwy::hwy_contrib ${codecs} Threads::Threads ${CMAKE_DL_LIBS})
foreach(part info render shapes verify)
  add_library(pointsweep_${part} STATIC IMPORTED)
  set_target_properties(pointsweep_${part} PROPERTIES IMPORTED_LOCATION ${POINTSWEEP_BUILT}/libpointsweep_${part}.a
    INTERFACE_LINK_LIBRARIES pointsweep)
endforeach()
set_property(TARGET pointsweep_render APPEND PROPERTY INTERFACE_LINK_LIBRARIES PNG::PNG)
add_library(pointsweep_whole INTERFACE)
target_link_libraries(pointsweep_whole INTERFACE pointsweep)
target_include_directories(pointsweep_whole INTERFACE ${repository})
add_custom_target(pointsweep_cli)
