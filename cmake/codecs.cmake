# The Rust crate in codecs/ as the static library pointsweep_codecs. POINTSWEEP_CODECS: ON needs cargo, OFF does without LAZ and E57,
# AUTO (the default) takes what is there: cargo 1.87 or newer, and the crates of codecs/Cargo.lock, here or from their registry.
set(POINTSWEEP_CODECS AUTO CACHE STRING "Build the codecs for LAZ and E57, which need cargo: ON, OFF or AUTO")
set_property(CACHE POINTSWEEP_CODECS PROPERTY STRINGS AUTO ON OFF)
set(POINTSWEEP_HAS_CODECS OFF)
if(NOT POINTSWEEP_CODECS)
  return()
endif()

set(codecs ${PROJECT_SOURCE_DIR}/codecs)
function(pointsweep_find_cargo why)
  find_program(POINTSWEEP_CARGO cargo HINTS $ENV{CARGO_HOME}/bin $ENV{HOME}/.cargo/bin)
  if(NOT POINTSWEEP_CARGO)
    set(${why} "cargo was not found" PARENT_SCOPE)
    return()
  endif()
  execute_process(COMMAND ${POINTSWEEP_CARGO} --version OUTPUT_VARIABLE version ERROR_QUIET)
  string(REGEX MATCH "[0-9]+\\.[0-9]+" version "${version}")
  if(version VERSION_LESS 1.87)
    set(${why} "${POINTSWEEP_CARGO} is older than 1.87" PARENT_SCOPE)
    return()
  endif()
  foreach(where --offline "")
    execute_process(COMMAND ${POINTSWEEP_CARGO} fetch --quiet --locked ${where} --manifest-path ${codecs}/Cargo.toml
      RESULT_VARIABLE failed ERROR_VARIABLE told)
    if(NOT failed)
      set(${why} "" PARENT_SCOPE)
      return()
    endif()
  endforeach()
  set(${why} "the crates cannot be fetched: ${told}" PARENT_SCOPE)
endfunction()

pointsweep_find_cargo(codecs_missing)
if(codecs_missing AND NOT POINTSWEEP_CODECS STREQUAL AUTO)
  message(FATAL_ERROR "POINTSWEEP_CODECS: ${codecs_missing}")
elseif(codecs_missing)
  message(WARNING "LAZ and E57 will not be read: ${codecs_missing}")
  return()
endif()

set(POINTSWEEP_HAS_CODECS ON)
set(codecs_library ${PROJECT_BINARY_DIR}/codecs/release/${CMAKE_STATIC_LIBRARY_PREFIX}pointsweep_codecs${CMAKE_STATIC_LIBRARY_SUFFIX})
file(GLOB codecs_sources CONFIGURE_DEPENDS ${codecs}/src/*.rs)
add_custom_command(OUTPUT ${codecs_library}
  COMMAND ${CMAKE_COMMAND} -E env --unset=CARGO_TARGET_DIR ${POINTSWEEP_CARGO} build --quiet --release --locked --offline
    --lib --manifest-path ${codecs}/Cargo.toml --target-dir ${PROJECT_BINARY_DIR}/codecs
  DEPENDS ${codecs_sources} ${codecs}/Cargo.toml ${codecs}/Cargo.lock
  COMMENT "Building the codecs with cargo" VERBATIM)
add_custom_target(pointsweep_build_codecs DEPENDS ${codecs_library})
add_library(pointsweep_codecs STATIC IMPORTED GLOBAL)
add_dependencies(pointsweep_codecs pointsweep_build_codecs)
find_package(Threads REQUIRED)
set_target_properties(pointsweep_codecs PROPERTIES IMPORTED_LOCATION ${codecs_library}
  INTERFACE_INCLUDE_DIRECTORIES ${codecs}/include INTERFACE_LINK_LIBRARIES "Threads::Threads;${CMAKE_DL_LIBS}")
