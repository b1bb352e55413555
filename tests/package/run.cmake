# Installs the build tree into a prefix of its own, then configures, builds and runs a project that knows only that prefix.
set(scratch ${BUILD}/package)
file(REMOVE_RECURSE ${scratch})

function(run)
  execute_process(COMMAND ${ARGV} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    list(JOIN ARGV " " command)
    message(FATAL_ERROR "${command}\nfailed (${status}):\n${output}")
  endif()
endfunction()

run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${scratch}/prefix --config "${CONFIG}")
foreach(file bash-completion/completions/pointsweep zsh/site-functions/_pointsweep fish/vendor_completions.d/pointsweep.fish
    man/man1/pointsweep.1 man/man1/pointsweep-normals.1)
  if(NOT EXISTS ${scratch}/prefix/share/${file})
    message(FATAL_ERROR "${file} is not installed")
  endif()
endforeach()
run(${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR} -B ${scratch}/build -G ${GENERATOR} -D CMAKE_BUILD_TYPE=Release
  -D CMAKE_CXX_COMPILER=${CXX} -D CMAKE_PREFIX_PATH=${scratch}/prefix -D WANTED_VERSION=${VERSION})
run(${CMAKE_COMMAND} --build ${scratch}/build --config Release)
run(${scratch}/build/outside)
message(STATUS "installed, found, built and run in ${scratch}")
