# Run by CPack when all files of the packages are in their folders, before these become packages: what Debian asks of files, and one time for all of them.
file(GLOB packages ${CPACK_TEMPORARY_DIRECTORY}/*)

# culprit-libs: the libraries that Ubuntu 22.04 or 24.04 lacks, with whatever these need of one another, and their licences. Each is found beside the other.
set(own_folder ${CPACK_TEMPORARY_DIRECTORY}/libs/usr/lib/culprit/debian-12) # one deeper than where CPack would have ldconfig look
execute_process(COMMAND ldd ${CPACK_TEMPORARY_DIRECTORY}/culprit/usr/bin/culprit ${CPACK_TEMPORARY_DIRECTORY}/lab/usr/bin/culprit-lab
                OUTPUT_VARIABLE linked COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCHALL "/[^ ]*/lib(cpp-httplib|fastcdr|fastrtps|fmt|foonathan_memory|tinyxml2|yaml-cpp|zstd)\\.so\\.[0-9.]+" libraries ${linked})
list(REMOVE_DUPLICATES libraries)
foreach(library ${libraries})
  get_filename_component(name ${library} NAME)
  get_filename_component(file ${library} REALPATH)
  execute_process(COMMAND dpkg-query --search ${file} OUTPUT_VARIABLE owner COMMAND_ERROR_IS_FATAL ANY)
  string(REGEX REPLACE "[: ].*" "" owner ${owner})
  file(MAKE_DIRECTORY ${own_folder})
  file(COPY_FILE ${file} ${own_folder}/${name})
  execute_process(COMMAND patchelf --set-rpath $ORIGIN ${own_folder}/${name} COMMAND_ERROR_IS_FATAL ANY)
  file(COPY_FILE /usr/share/doc/${owner}/copyright ${CPACK_TEMPORARY_DIRECTORY}/libs/usr/share/doc/culprit-libs/${owner}.copyright)
endforeach()

foreach(package ${packages})
  if(NOT IS_DIRECTORY ${package})
    continue()
  endif()
  file(GLOB_RECURSE pages ${package}/usr/share/man/*.1 ${package}/usr/share/doc/*/changelog ${package}/usr/share/doc/*/changelog.Debian)
  if(pages)
    execute_process(COMMAND gzip -9nf ${pages} COMMAND_ERROR_IS_FATAL ANY)
  endif()
  set(strip strip --remove-section=.comment --remove-section=.note)
  file(GLOB programs ${package}/usr/bin/*)
  if(programs)
    execute_process(COMMAND ${strip} ${programs} COMMAND_ERROR_IS_FATAL ANY)
  endif()
  file(GLOB_RECURSE libraries ${package}/usr/lib/*.a)
  if(libraries)
    execute_process(COMMAND ${strip} --strip-debug --enable-deterministic-archives ${libraries} COMMAND_ERROR_IS_FATAL ANY)
  endif()
  # Of files that differ from build to build: when they were made.
  if(DEFINED ENV{SOURCE_DATE_EPOCH})
    execute_process(COMMAND find ${package} -exec touch --no-dereference --date=@$ENV{SOURCE_DATE_EPOCH} {} +
                    COMMAND_ERROR_IS_FATAL ANY)
  endif()
endforeach()
