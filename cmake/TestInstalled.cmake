# Installs culprit::core from the build folder BUILD into a folder of its own, and builds and runs an example against that.
set(prefix ${BUILD}/installed)
file(REMOVE_RECURSE ${prefix} ${BUILD}/examples-installed)
function(run)
  execute_process(COMMAND ${ARGV} COMMAND_ERROR_IS_FATAL ANY)
endfunction()
run(${CMAKE_COMMAND} --install ${BUILD} --component core --prefix ${prefix})
run(${CMAKE_COMMAND} -S ${SOURCE}/examples -B ${BUILD}/examples-installed -G Ninja -DCMAKE_PREFIX_PATH=${prefix}
    -DCMAKE_BUILD_TYPE=Debug)
run(${CMAKE_COMMAND} --build ${BUILD}/examples-installed --target t01_embed_the_manager)
run(${BUILD}/examples-installed/t01_embed_the_manager)
