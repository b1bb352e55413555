# The Rust crate in codecs/ as the static library pointsweep_codecs. POINTSWEEP_CODECS: ON needs cargo, OFF builds without LAZ and E57,
# AUTO (the default) builds the codecs if cargo 1.87 or newer and the crates of codecs/Cargo.lock, on this machine or from their registry,
# are available.
set(POINTSWEEP_CODECS AUTO CACHE STRING "Build the codecs for LAZ and E57, which need cargo: ON, OFF or AUTO")
set_property(CACHE POINTSWEEP_CODECS PROPERTY STRINGS AUTO ON OFF)
set(POINTSWEEP_HAS_CODECS OFF)
if(NOT POINTSWEEP_CODECS)
  return()
endif()

# POINTSWEEP_REMOTE: builds inputs and outputs by URL. The crate codecs/remote, which contains the codecs, then replaces the crate codecs,
# since two Rust libraries cannot be linked into one program.
option(POINTSWEEP_REMOTE "Build inputs and outputs by URL, which compile some hundred crates" OFF)
set(codecs ${PROJECT_SOURCE_DIR}/codecs)
set(manifest ${codecs}/Cargo.toml)
set(codecs_name pointsweep_codecs)
if(POINTSWEEP_REMOTE)
  set(manifest ${codecs}/remote/Cargo.toml)
  set(codecs_name pointsweep_remote)
endif()
set(POINTSWEEP_REMOTE_OPT_LEVEL "" CACHE STRING "Optimization of the crates for the network, 0 (default) to 3; 1 makes the library smaller and takes two minutes more")
cmake_path(REPLACE_FILENAME manifest Cargo.lock OUTPUT_VARIABLE lock_file)
set(crates ${PROJECT_BINARY_DIR}/codecs/crates)
set(POINTSWEEP_CARGO_OPTIONS --locked --offline --config source.crates-io.replace-with="crates" --config source.crates.directory="${crates}"
  --target-dir ${PROJECT_BINARY_DIR}/codecs)

if(POINTSWEEP_REMOTE AND POINTSWEEP_REMOTE_OPT_LEVEL)
  list(APPEND POINTSWEEP_CARGO_OPTIONS --config "profile.release.package.'*'.opt-level=${POINTSWEEP_REMOTE_OPT_LEVEL}")
endif()

# Copies the crates into the build folder and patches the crate laz there (patch_laz.cmake).
function(pointsweep_fetch_crates why)
  set(${why} "" PARENT_SCOPE)
  file(SHA256 ${lock_file} lock)
  file(SHA256 ${PROJECT_SOURCE_DIR}/cmake/patch_laz.cmake patch)
  if(EXISTS ${crates}/made_of)
    file(READ ${crates}/made_of made_of)
    if(made_of STREQUAL "${lock}${patch}")
      return()
    endif()
  endif()
  foreach(where --offline "")
    file(REMOVE_RECURSE ${crates})
    execute_process(COMMAND ${POINTSWEEP_CARGO} vendor --quiet --locked ${where} --manifest-path ${manifest} ${crates}
      RESULT_VARIABLE failed ERROR_VARIABLE told OUTPUT_QUIET)
    if(NOT failed)
      execute_process(COMMAND ${CMAKE_COMMAND} -D VENDOR=${crates} -P ${PROJECT_SOURCE_DIR}/cmake/patch_laz.cmake
        RESULT_VARIABLE failed ERROR_VARIABLE told)
    endif()
    if(NOT failed)
      file(WRITE ${crates}/made_of "${lock}${patch}")
      return()
    endif()
  endforeach()
  set(${why} "${told}" PARENT_SCOPE)
endfunction()
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
  pointsweep_fetch_crates(told)
  if(told)
    set(${why} "the crates cannot be fetched: ${told}" PARENT_SCOPE)
  else()
    set(${why} "" PARENT_SCOPE)
  endif()
endfunction()

pointsweep_find_cargo(codecs_missing)
if(codecs_missing AND NOT POINTSWEEP_CODECS STREQUAL AUTO)
  message(FATAL_ERROR "POINTSWEEP_CODECS: ${codecs_missing}")
elseif(codecs_missing)
  message(WARNING "LAZ and E57 will not be read: ${codecs_missing}")
  return()
endif()

set(POINTSWEEP_HAS_CODECS ON)
set(codecs_library ${PROJECT_BINARY_DIR}/codecs/release/${CMAKE_STATIC_LIBRARY_PREFIX}${codecs_name}${CMAKE_STATIC_LIBRARY_SUFFIX})
file(GLOB codecs_sources CONFIGURE_DEPENDS ${codecs}/src/*.rs ${codecs}/remote/src/*.rs)
add_custom_command(OUTPUT ${codecs_library}
  COMMAND ${CMAKE_COMMAND} -E env --unset=CARGO_TARGET_DIR ${POINTSWEEP_CARGO} build --quiet --release --lib
    --manifest-path ${manifest} ${POINTSWEEP_CARGO_OPTIONS}
  DEPENDS ${codecs_sources} ${codecs}/Cargo.toml ${manifest} ${lock_file} ${crates}/made_of
  COMMENT "Building the codecs with cargo" VERBATIM)
add_custom_target(pointsweep_build_codecs DEPENDS ${codecs_library})
add_library(pointsweep_codecs STATIC IMPORTED GLOBAL)
add_dependencies(pointsweep_codecs pointsweep_build_codecs)
find_package(Threads REQUIRED)
set_target_properties(pointsweep_codecs PROPERTIES IMPORTED_LOCATION ${codecs_library}
  INTERFACE_INCLUDE_DIRECTORIES ${codecs}/include INTERFACE_LINK_LIBRARIES "Threads::Threads;${CMAKE_DL_LIBS}")
if(POINTSWEEP_REMOTE AND NOT APPLE) # leaves out the code of the network crates that is not used, which is most of it
  set_property(TARGET pointsweep_codecs PROPERTY INTERFACE_LINK_OPTIONS LINKER:--gc-sections)
endif()
