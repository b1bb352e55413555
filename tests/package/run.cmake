# Installs the build tree into a new prefix. Then configures, builds and runs a project that knows only that prefix, once with the
# static library and once with the shared one.
set(scratch ${BUILD}/package)
file(REMOVE_RECURSE ${scratch})

function(run)
  execute_process(COMMAND ${ARGV} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    list(JOIN ARGV " " command)
    message(FATAL_ERROR "${command}\nfailed (${status}):\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${scratch}/prefix --config "${CONFIG}")
foreach(file bash-completion/completions/pointsweep zsh/site-functions/_pointsweep fish/vendor_completions.d/pointsweep.fish
    man/man1/pointsweep.1 man/man1/pointsweep-normals.1)
  if(NOT EXISTS ${scratch}/prefix/share/${file})
    message(FATAL_ERROR "${file} is not installed")
  endif()
endforeach()

# Exactly the public headers are installed.
file(GLOB_RECURSE public RELATIVE ${SOURCE}/include ${SOURCE}/include/*)
file(GLOB_RECURSE installed RELATIVE ${scratch}/prefix/include ${scratch}/prefix/include/*)
if(NOT public STREQUAL installed)
  message(FATAL_ERROR "installed headers: ${installed}\npublic headers: ${public}")
endif()

foreach(shared OFF ON)
  run(${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR} -B ${scratch}/shared_${shared} -G ${GENERATOR} -D CMAKE_BUILD_TYPE=Release
    -D CMAKE_CXX_COMPILER=${CXX} -D CMAKE_PREFIX_PATH=${scratch}/prefix -D WANTED_VERSION=${VERSION} -D BUILD_SHARED_LIBS=${shared}
    -D HEADERS_ALONE=${shared})
  run(${CMAKE_COMMAND} --build ${scratch}/shared_${shared} --config Release)
  run(${scratch}/shared_${shared}/outside ${scratch})
endforeach()
run(${scratch}/shared_OFF/beside ${scratch})

# The shared library exports only names of pointsweep, at most a few hundred.
file(GLOB libraries ${scratch}/prefix/*/libpointsweep.so ${scratch}/prefix/*/*/libpointsweep.so)
list(GET libraries 0 library)
run(nm --dynamic --defined-only --demangle ${library})
string(REPLACE ";" "," output "${output}")
string(REGEX MATCHALL "[^\n]+" symbols "${output}")
list(LENGTH symbols count)
set(foreign ${symbols})
list(FILTER foreign EXCLUDE REGEX "pointsweep::|^[0-9a-f]+ [VWu] .*std::")
if(foreign OR count LESS 50 OR count GREATER 1000)
  message(FATAL_ERROR "${library} shows ${count} symbols, of others: ${foreign}")
endif()
message(STATUS "installed, found, built and run in ${scratch}")
