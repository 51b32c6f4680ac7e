# The house of the design: one folder, one library, and only the listed links.
#
# A folder's headers are found as "folder/header.h" through a directory that holds nothing but that folder, and that
# directory is a property of its library. So code can include only what its library links: an arrow that
# src/CMakeLists.txt does not draw does not compile.

add_library(culprit_options INTERFACE)
# Fused multiplications would make decisions differ between kinds of processors.
target_compile_options(culprit_options INTERFACE -ffp-contract=off)
target_compile_options(culprit_options INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor
                                                 -Wold-style-cast -Wcast-qual)
if(CMAKE_CXX_COMPILER_ID MATCHES "Clang")
  target_compile_options(culprit_options INTERFACE -Wthread-safety) # base/mutex.h
endif()
if(CULPRIT_WERROR)
  target_compile_options(culprit_options INTERFACE -Werror)
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  # g++ 12 sees overlaps in std::string's operator+ that are not there (GCC bug 105651), and at -O1 takes what an empty
  # optional would hold for a value that is read.
  target_compile_options(culprit_options INTERFACE -Wno-restrict -Wno-maybe-uninitialized)
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_UNITY_BUILD)
  # Compiled several at a time, files look like headers to this warning: their private types would not be private.
  target_compile_options(culprit_options INTERFACE $<$<COMPILE_LANGUAGE:CXX>:-Wno-subobject-linkage>)
endif()
if(CULPRIT_SANITIZE)
  target_compile_options(culprit_options INTERFACE -fsanitize=${CULPRIT_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_link_options(culprit_options INTERFACE -fsanitize=${CULPRIT_SANITIZE})
  if(NOT CULPRIT_FUZZ)
    # Tests do without what the address sanitizer or the processor finds as well: it takes half of the time of compiling. Fuzzers look for it.
    target_compile_options(culprit_options INTERFACE -fno-sanitize=null,object-size,vptr,alignment,pointer-overflow,function)
    # Each access is checked by a call, not in place: a fifth less to compile.
    if(CULPRIT_SANITIZE MATCHES "address")
      target_compile_options(culprit_options INTERFACE "SHELL:-mllvm -asan-instrumentation-with-call-threshold=0")
    endif()
  endif()
endif()

# Without collecting garbage g++ needs 1.3 GB for the largest file instead of 1.0, and a tenth less time: where that is there for each of the files that
# ninja compiles at a time. Not for packages (CULPRIT_SMALL): nothing of the machine is to show in their bytes.
cmake_host_system_information(RESULT culprit_memory QUERY TOTAL_PHYSICAL_MEMORY) # MiB
cmake_host_system_information(RESULT culprit_processors QUERY NUMBER_OF_LOGICAL_CORES)
math(EXPR culprit_memory_needed "1500 * (${culprit_processors} + 2)")
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND NOT CULPRIT_SMALL AND culprit_memory GREATER_EQUAL culprit_memory_needed)
  target_compile_options(culprit_options INTERFACE $<BUILD_INTERFACE:--param=ggc-min-expand=1000>
                                                   $<BUILD_INTERFACE:--param=ggc-min-heapsize=1048576>)
endif()

# Some hundred programs and tests are linked: in a third of the time by lld, if it is there.
if(CULPRIT_TESTS)
  find_program(culprit_lld ld.lld)
  if(culprit_lld)
    target_link_options(culprit_options INTERFACE -fuse-ld=lld)
  endif()
endif()

# For what fuzzers may look into, as fuzz/CMakeLists.txt has it: not for programs and tests, which would only compile longer.
add_library(culprit_library_options INTERFACE)
target_link_libraries(culprit_library_options INTERFACE culprit_options)

# Checks includes and compiles nothing (preset walls): each file, and each header, alone. What would be made of it is an empty file, so a second run checks
# what changed.
if(CULPRIT_WALLS)
  set(CMAKE_UNITY_BUILD OFF)
  set(CMAKE_DISABLE_PRECOMPILE_HEADERS ON)
  set(CMAKE_CXX_COMPILE_OBJECT "<CMAKE_CXX_COMPILER> <DEFINES> <INCLUDES> <FLAGS> -fsyntax-only <SOURCE>" "touch <OBJECT>")
  set(CMAKE_CXX_ARCHIVE_CREATE "touch <TARGET>")
  set(CMAKE_CXX_ARCHIVE_FINISH "")
  set(CMAKE_CXX_LINK_EXECUTABLE "touch <TARGET>")
  add_custom_target(headers)
endif()

# culprit_check_headers(<target> FOLDER <path> USES <target>... HEADERS <folder/header.h>...): compiles each header alone, but for those that a file of the
# same name includes first: that file is the check.
function(culprit_check_headers target)
  cmake_parse_arguments(ARG "" "FOLDER" "USES;HEADERS" ${ARGN})
  if(NOT CULPRIT_WALLS)
    return()
  endif()
  set(sources "")
  foreach(header ${ARG_HEADERS})
    string(REGEX REPLACE "\\.h$" "" name ${header})
    foreach(file ${name}.cpp ${name}_test.cpp)
      set(first "")
      if(EXISTS ${ARG_FOLDER}/../${file})
        file(STRINGS ${ARG_FOLDER}/../${file} first REGEX "^#include" LIMIT_COUNT 1)
      endif()
      if(first STREQUAL "#include \"${header}\"")
        set(header "")
        break()
      endif()
    endforeach()
    if(header)
      set(source ${CMAKE_BINARY_DIR}/headers/${header}.cpp)
      file(CONFIGURE OUTPUT ${source} CONTENT "#include \"${header}\"\n")
      list(APPEND sources ${source})
    endif()
  endforeach()
  if(NOT sources)
    return()
  endif()
  add_library(${target} OBJECT ${sources})
  target_link_libraries(${target} PRIVATE ${ARG_USES})
  add_dependencies(headers ${target})
endfunction()

# culprit_precompile(<name> USES <target>... HEADERS <header>...): what many files include, parsed once. What is declared later and has the same options
# takes the latest of that name: culprit_reuse_precompiled(<target> <name>). But for what all tests include only where all is built as a whole:
# elsewhere each file says what it includes, or does not compile.
set(culprit_standard_headers <algorithm> <atomic> <chrono> <condition_variable> <filesystem> <fstream> <functional> <map> <memory> <mutex>
                             <optional> <set> <span> <sstream> <string> <thread> <unordered_map> <variant> <vector>)
set(culprit_precompiled_source ${CMAKE_CURRENT_LIST_DIR}/precompiled.cpp)
function(culprit_precompile name)
  cmake_parse_arguments(ARG "" "" "USES;HEADERS" ${ARGN})
  if(NOT CMAKE_UNITY_BUILD AND NOT name STREQUAL "test")
    return()
  endif()
  get_property(number GLOBAL PROPERTY culprit_count_of_${name})
  math(EXPR number "0${number} + 1")
  set(target culprit_precompiled_${name}_${number})
  add_library(${target} OBJECT ${culprit_precompiled_source})
  target_precompile_headers(${target} PRIVATE ${culprit_standard_headers} ${ARG_HEADERS})
  target_link_libraries(${target} PRIVATE ${ARG_USES})
  set_property(GLOBAL PROPERTY culprit_count_of_${name} ${number})
endfunction()
function(culprit_reuse_precompiled target name)
  get_property(number GLOBAL PROPERTY culprit_count_of_${name})
  if(number)
    target_precompile_headers(${target} REUSE_FROM culprit_precompiled_${name}_${number})
  endif()
endfunction()
culprit_precompile(library USES culprit_library_options)

# Tests are compiled to be built soon: what they test is optimised as for users.
add_library(culprit_test_options INTERFACE)
target_link_libraries(culprit_test_options INTERFACE culprit_options)
target_compile_options(culprit_test_options INTERFACE -O0)
if(CULPRIT_SANITIZE)
  # What a sanitizer says of a test's own code has the test's name; lines are told of what is tested. A seventh less to compile.
  target_compile_options(culprit_test_options INTERFACE -g0)
endif()

# The main function of all tests.
if(CULPRIT_TESTS)
  add_custom_target(offline_tests) # those of culprit itself that start no processes of a robot
  add_custom_target(soak_tests) # those of them that only `make soak` runs under the address sanitizer
  add_custom_target(live_tests) # those that start the processes of a robot
  add_custom_target(unsanitized_tests) # all that the address sanitizer does not look at in `make test`
  add_library(culprit_test_main OBJECT ${CMAKE_CURRENT_LIST_DIR}/test_main.cpp)
  if(CULPRIT_SANITIZE STREQUAL "thread")
    target_sources(culprit_test_main PRIVATE ${CMAKE_CURRENT_LIST_DIR}/tsan_clocklock.cpp)
  endif()
  target_link_libraries(culprit_test_main PRIVATE GTest::gtest GTest::gmock rapidcheck culprit_test_options)
  set(culprit_test_headers <gmock/gmock.h> <gtest/gtest.h> <rapidcheck/gtest.h>)
  culprit_precompile(test USES culprit_test_options GTest::gtest GTest::gmock rapidcheck HEADERS ${culprit_test_headers})
endif()

# Live tests run side by side, each as if on a machine of its own, where the one who builds may make one; else one after the other.
if(CULPRIT_TESTS)
  set(culprit_own_machine ${CMAKE_CURRENT_LIST_DIR}/in_own_machine.sh)
  execute_process(COMMAND ${culprit_own_machine} true RESULT_VARIABLE refused OUTPUT_QUIET ERROR_QUIET)
  if(refused)
    set(culprit_own_machine "")
    message(STATUS "Live tests run one after the other: no right to make namespaces")
  endif()
endif()

# culprit_library(<floor>/<folder> [USES <folder>...] [PACKAGES <target>...]
#                 [TEST_USES <folder>...] [TEST_PACKAGES <target>...] [TEST_SERIAL] [TEST_WAITS]
#                 [TEST_LABELS <label>...] [TEST_CASES n] [TEST_ALONE <pattern>...]
#                 [TEST_UNSANITIZED <pattern>...]
#                 [LIVE_TEST_USES <folder>...] [LIVE_PROCESSORS n])
#
# Builds the library <folder> of src/<floor>/<folder>/**.cpp, but for its tests and programs (*_main.cpp); the library
# <folder>_testing of what only tests use (test_*.cpp), for others' tests too; and the test program <folder>_test of
# *_test.cpp.
# USES are other folders whose headers may appear in this one's; PACKAGES are targets from outside the project.
# *_live_test.cpp make a program of their own, <folder>_live_test: they start the processes of a robot, so each has a
# machine of its own (in_own_machine.sh) or runs alone, and carries the label "live". The label "soak",
# which all of lab/ has, is for those that the address sanitizer repeats only in `make soak`. TEST_ALONE, as --gtest_filter= takes it, are tests that need a
# process of their own where otherwise many share one (culprit_add_shards); TEST_UNSANITIZED, of the laboratory, those that no sanitizer runs: their results
# are statistics.
function(culprit_library path)
  cmake_parse_arguments(ARG "TEST_SERIAL;TEST_WAITS" "" "USES;PACKAGES;TEST_PACKAGES;TEST_USES;TEST_LABELS;TEST_CASES;TEST_ALONE;TEST_UNSANITIZED;LIVE_TEST_USES;LIVE_PROCESSORS" ${ARGN})
  get_filename_component(folder ${path} NAME)
  if(path MATCHES "^lab/")
    list(APPEND ARG_TEST_LABELS soak)
  endif()
  set(dir ${PROJECT_SOURCE_DIR}/src/${path})
  culprit_check_floors(${path} ${ARG_USES})
  set_property(GLOBAL PROPERTY culprit_path_of_${folder} ${path})
  set(headers ${CMAKE_BINARY_DIR}/include/${folder})
  file(MAKE_DIRECTORY ${headers})
  file(CREATE_LINK ${dir} ${headers}/${folder} SYMBOLIC)

  file(GLOB_RECURSE all CONFIGURE_DEPENDS ${dir}/*.cpp)
  foreach(kind sources testing tests live_tests)
    set(${kind} ${all})
  endforeach()
  list(FILTER sources EXCLUDE REGEX "(_test|_main|/test_[a-z_]+)\\.cpp$")
  list(FILTER testing INCLUDE REGEX "/test_[a-z_]+\\.cpp$")
  list(FILTER tests INCLUDE REGEX "_test\\.cpp$")
  list(FILTER tests EXCLUDE REGEX "_live_test\\.cpp$")
  list(FILTER live_tests INCLUDE REGEX "_live_test\\.cpp$")

  if(sources)
    add_library(${folder} STATIC ${sources})
    culprit_compile_together(${folder} 40 ${dir} ${sources})
    set_target_properties(${folder} PROPERTIES UNITY_BUILD_MODE GROUP)
    set(scope PUBLIC)
  else()
    add_library(${folder} INTERFACE)
    set(scope INTERFACE)
  endif()
  target_include_directories(${folder} ${scope} $<BUILD_INTERFACE:${headers}> $<INSTALL_INTERFACE:include/culprit>)
  target_link_libraries(${folder} ${scope} ${ARG_USES} ${ARG_PACKAGES})
  if(sources)
    target_link_libraries(${folder} PRIVATE $<BUILD_INTERFACE:culprit_library_options>)
    culprit_reuse_precompiled(${folder} library)
  endif()
  if(path MATCHES "^(base$|core/)")
    culprit_install_library(${folder} ${dir})
  endif()
  file(GLOB_RECURSE folder_headers CONFIGURE_DEPENDS RELATIVE ${dir} ${dir}/*.h)
  list(FILTER folder_headers EXCLUDE REGEX "(^|/)peers/")
  list(TRANSFORM folder_headers PREPEND ${folder}/)
  set(test_headers ${folder_headers})
  list(FILTER folder_headers EXCLUDE REGEX "/test_[a-z0-9_]+\\.h$")
  list(FILTER test_headers INCLUDE REGEX "/test_[a-z0-9_]+\\.h$")
  culprit_check_headers(${folder}_headers FOLDER ${dir} USES ${folder} culprit_options HEADERS ${folder_headers})

  if(NOT CULPRIT_TESTS)
    return()
  endif()
  set(with ${folder} ${ARG_TEST_USES})
  if(testing)
    add_library(${folder}_testing STATIC EXCLUDE_FROM_ALL ${testing})
    culprit_reuse_precompiled(${folder}_testing test)
    target_link_libraries(${folder}_testing PUBLIC ${with} ${ARG_TEST_PACKAGES} GTest::gtest GTest::gmock rapidcheck
                                            PRIVATE culprit_test_options)
    list(APPEND with ${folder}_testing)
  endif()
  culprit_check_headers(${folder}_test_headers FOLDER ${dir} HEADERS ${test_headers}
                        USES ${with} ${ARG_LIVE_TEST_USES} ${ARG_TEST_PACKAGES} GTest::gtest GTest::gmock rapidcheck culprit_test_options)
  culprit_compile_together(${folder}_test 10 ${CMAKE_CURRENT_SOURCE_DIR} ${tests}) # in each preset the same files, so that names that clash are seen in each
  if(tests)
    set(manner "")
    if(ARG_TEST_SERIAL)
      set(manner SERIAL)
    endif()
    if(ARG_TEST_WAITS)
      list(APPEND manner WAITS)
    endif()
    culprit_test(${folder}_test SOURCES ${tests} USES ${with} PACKAGES ${ARG_TEST_PACKAGES}
                 LABELS ${ARG_TEST_LABELS} CASES ${ARG_TEST_CASES} ALONE ${ARG_TEST_ALONE}
                 UNSANITIZED ${ARG_TEST_UNSANITIZED} ${manner})
  endif()
  if(live_tests)
    culprit_test(${folder}_live_test SOURCES ${live_tests} USES ${with} ${ARG_LIVE_TEST_USES} PACKAGES ${ARG_TEST_PACKAGES}
                 LIVE LABELS live PROCESSORS ${ARG_LIVE_PROCESSORS})
  endif()
endfunction()

# culprit_compile_together(<target> <most> <folder> <file>...): where CMAKE_UNITY_BUILD is set, the files of one folder are compiled so many at a time; 40 in
# place of 10 take half the time. Those of its subfolders are compiled apart, for they are often variants of one thing and call their parts by the same
# names; so do tests, ten at a time. A file stays in the group that it was given first.
function(culprit_compile_together target most dir)
  foreach(file ${ARGN})
    get_source_file_property(together ${file} UNITY_GROUP)
    if(together)
      continue()
    endif()
    get_filename_component(group ${file} DIRECTORY)
    file(RELATIVE_PATH group ${dir} ${group})
    string(MAKE_C_IDENTIFIER "part_${group}" group)
    set_property(GLOBAL APPEND PROPERTY culprit_files_${target}_${group} ${file})
    get_property(files GLOBAL PROPERTY culprit_files_${target}_${group})
    list(LENGTH files count)
    math(EXPR batch "${count} / ${most}")
    set_source_files_properties(${file} PROPERTIES UNITY_GROUP ${group}_${batch})
  endforeach()
endfunction()

# An arrow goes down, or stays on its floor; the laboratory is used by nobody, and uses all but cli.
set(culprit_floors base core adapters tools live web ros_api terminal cli)
function(culprit_check_floors path)
  string(REGEX REPLACE "/.*" "" floor ${path})
  list(FIND culprit_floors ${floor} height)
  foreach(used ${ARGN})
    get_property(other GLOBAL PROPERTY culprit_path_of_${used})
    string(REGEX REPLACE "/.*" "" other "${other}")
    list(FIND culprit_floors "${other}" other_height)
    if(floor STREQUAL "lab")
      set(is_fit NOT other STREQUAL "cli")
    else()
      set(is_fit NOT other STREQUAL "lab" AND NOT other_height GREATER height)
    endif()
    if(NOT (${is_fit}))
      message(FATAL_ERROR "src/${path} may not use ${used}: it is in src/${other}, on a higher floor")
    endif()
  endforeach()
endfunction()

# base and core are for others, too: find_package(culprit), culprit::core (examples/).
function(culprit_install_library folder dir)
  target_compile_features(${folder} PUBLIC cxx_std_20)
  install(TARGETS ${folder} EXPORT culprit ARCHIVE DESTINATION lib/culprit COMPONENT core)
  install(DIRECTORY ${dir}/ DESTINATION include/culprit/${folder} COMPONENT core
          FILES_MATCHING PATTERN "*.h" PATTERN "test_*.h" EXCLUDE PATTERN "golden" EXCLUDE)
endfunction()

# culprit_embed(<folder> <header> <file>...): makes <folder>/<header> of <header>.in in that folder, with the text of rules/some-name.rules in
# place of @SOME_NAME_RULES@ (of report.css in place of @REPORT_CSS@), so that a program needs no file beside it.
function(culprit_embed folder header)
  foreach(file ${ARGN})
    get_filename_component(name ${file} NAME)
    string(MAKE_C_IDENTIFIER ${name} name)
    string(TOUPPER ${name} name)
    file(READ ${PROJECT_SOURCE_DIR}/${file} ${name})
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/${file})
  endforeach()
  get_property(path GLOBAL PROPERTY culprit_path_of_${folder})
  configure_file(${PROJECT_SOURCE_DIR}/src/${path}/${header}.in ${CMAKE_BINARY_DIR}/include/${folder}-generated/${folder}/${header} @ONLY)
  target_include_directories(${folder} PRIVATE ${CMAKE_BINARY_DIR}/include/${folder}-generated)
endfunction()

# culprit_program(<name> <source> USES <folder>... [COMPONENT <of what is installed>]): lands in build/<preset>/bin.
add_custom_target(programs)
function(culprit_program name source)
  cmake_parse_arguments(ARG "" "COMPONENT" "USES" ${ARGN})
  add_executable(${name} ${source})
  target_link_libraries(${name} PRIVATE ${ARG_USES} culprit_options)
  culprit_reuse_precompiled(${name} library)
  add_dependencies(programs ${name})
  install(TARGETS ${name} RUNTIME DESTINATION bin COMPONENT ${ARG_COMPONENT})
endfunction()

# culprit_test(<name> SOURCES ... USES ... [PACKAGES ...] [SERIAL] [WAITS] [LIVE [PROCESSORS n]] [LABELS ...] [CASES n] [ALONE ...] [UNSANITIZED ...]): one CTest
# test for each TEST. Where it is built as users build, what the address sanitizer looks at in `make test` has the label "sanitized". SERIAL tests run one after
# the other, beside those of other programs. LIVE tests have a machine of their own (in_own_machine.sh), or run alone. They and those of WAITS wait more than
# they compute, so two of them may run where one of the others does: PROCESSORS says of how many of the four that two cores count for. Properties are tried on n
# random cases each instead of 100.
function(culprit_test name)
  cmake_parse_arguments(ARG "SERIAL;WAITS;LIVE" "" "SOURCES;USES;PACKAGES;LABELS;CASES;ALONE;UNSANITIZED;PROCESSORS" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  culprit_reuse_precompiled(${name} test)
  culprit_compile_together(${name} 10 ${CMAKE_CURRENT_SOURCE_DIR} ${ARG_SOURCES})
  set_target_properties(${name} PROPERTIES UNITY_BUILD_MODE GROUP)
  target_link_libraries(${name} PRIVATE ${ARG_USES} ${ARG_PACKAGES} culprit_test_main GTest::gtest GTest::gmock
                                        rapidcheck culprit_test_options)
  if(CULPRIT_WALLS)
    return() # there is no program to run
  endif()
  set(properties TIMEOUT 300)
  if(ARG_LIVE) # first: they take longest; before all, those beside which little else runs
    math(EXPR cost "1000 + 10 * 0${ARG_PROCESSORS}")
    list(APPEND properties COST ${cost})
  endif()
  if(ARG_SERIAL)
    list(APPEND properties RESOURCE_LOCK ${name} COST 900) # early: a long row of tests that wait, too
  endif()
  if(ARG_LIVE AND NOT culprit_own_machine)
    list(APPEND properties RUN_SERIAL TRUE)
  endif()
  if(ARG_LIVE)
    set_target_properties(${name} PROPERTIES CROSSCOMPILING_EMULATOR "${culprit_own_machine}")
    if(ARG_PROCESSORS)
      list(APPEND properties PROCESSORS ${ARG_PROCESSORS})
    endif()
  elseif(NOT ARG_WAITS OR CULPRIT_SANITIZE STREQUAL "thread") # which makes them compute
    list(APPEND properties PROCESSORS 2)
  endif()
  set(kinds offline sanitized)
  if(ARG_LIVE)
    set(kinds live unsanitized)
  elseif("soak" IN_LIST ARG_LABELS)
    set(kinds soak unsanitized)
  endif()
  foreach(kind IN LISTS kinds)
    if(TARGET ${kind}_tests)
      add_dependencies(${kind}_tests ${name})
    endif()
  endforeach()
  set(environment "")
  if(ARG_CASES)
    list(APPEND environment "RC_PARAMS=max_success=${ARG_CASES}")
  endif()
  if(CULPRIT_SANITIZE)
    if(ARG_LABELS)
      list(APPEND properties LABELS "${ARG_LABELS}")
    endif()
    list(LENGTH ARG_SOURCES files)
    math(EXPR shards "1 + ${files} / 8")
    culprit_add_shards(${name} ${shards} ALONE ${ARG_ALONE} UNSANITIZED ${ARG_UNSANITIZED}
                       PROPERTIES ${properties} ENVIRONMENT ${environment})
    return()
  endif()
  if(environment)
    list(APPEND properties ENVIRONMENT "${environment}")
  endif()
  if("sanitized" IN_LIST kinds)
    set(ARG_LABELS sanitized)
  endif()
  gtest_discover_tests(${name} WORKING_DIRECTORY ${PROJECT_SOURCE_DIR} DISCOVERY_TIMEOUT 60
                       PROPERTIES ${properties} LABELS ${ARG_LABELS})
endfunction()

# culprit_add_shards(<test program> <shards> ALONE <pattern>... UNSANITIZED <pattern>... PROPERTIES ... ENVIRONMENT ...): its tests in so many processes, and
# in one for each pattern of ALONE. A process with a sanitizer takes longer to begin than most tests take. Each leaves what came of its tests in test-results/.
function(culprit_add_shards name shards)
  cmake_parse_arguments(ARG "" "" "ALONE;UNSANITIZED;PROPERTIES;ENVIRONMENT" ${ARGN})
  set(left_out ${ARG_ALONE} ${ARG_UNSANITIZED})
  list(JOIN left_out ":" left_out)
  math(EXPR last "${shards} - 1")
  foreach(shard RANGE ${last})
    culprit_add_process(${name} ${shard} "*-${left_out}" GTEST_TOTAL_SHARDS=${shards} GTEST_SHARD_INDEX=${shard})
  endforeach()
  set(number ${shards})
  foreach(pattern IN LISTS ARG_ALONE)
    culprit_add_process(${name} ${number} "${pattern}")
    math(EXPR number "${number} + 1")
  endforeach()
endfunction()

macro(culprit_add_process name number filter)
  set(test ${name}.${number})
  add_test(NAME ${test} COMMAND ${name} WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
  set_tests_properties(${test} PROPERTIES ${ARG_PROPERTIES})
  set_property(TEST ${test} PROPERTY TIMEOUT 1200) # of many tests
  set_property(TEST ${test} PROPERTY ENVIRONMENT ${ARG_ENVIRONMENT} GTEST_FILTER=${filter}
    GTEST_OUTPUT=xml:${PROJECT_BINARY_DIR}/test-results/${test}.xml ${ARGN})
endmacro()
