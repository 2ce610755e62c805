# irsig_module(<name> SOURCES ... HEADERS ... DEPENDS <irsig modules> [EXTERNAL <third-party targets>]
#              [PRECOMPILE <headers>] [HOT])        HOT: without the standard library's assertions in a release,
#                                                   but in the sources named after CHECKED
# irsig_program(<name> ...), the same for an executable.
#
# One folder = one static library = one line of permissions. DEPENDS is the only place where a
# dependency is declared: CMake links from it (and refuses cycles), and the test architecture.layers
# fails any #include that it does not allow.
set_property(GLOBAL PROPERTY GLOBAL_DEPENDS_NO_CYCLES ON)
file(WRITE ${PROJECT_BINARY_DIR}/layers.txt "")
file(WRITE ${PROJECT_BINARY_DIR}/batches.txt "")

# target_precompile_headers without its false alarms: GCC 12 takes copies within std::string for wrong
# (its bug 105651), and no longer knows that they stand in a system header when that is precompiled.
function(irsig_precompile target)
  target_precompile_headers(${target} ${ARGN})
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    target_compile_options(${target} PRIVATE -Wno-array-bounds -Wno-restrict -Wno-stringop-overflow
                                             -Wno-stringop-overread)
  endif()
endfunction()

# With IRSIG_UNITY the sources of a target are compiled in batches of nearly equal size, each as one translation unit:
# most of a source's time is its headers. Sources with options or definitions of their own are compiled alone. A name
# in an anonymous namespace is unique in its target: the test architecture.unity reads batches.txt (target | sources).
set(IRSIG_UNITY_BATCH 10)
function(irsig_batches target)
  set(sources ${ARGN})
  list(FILTER sources INCLUDE REGEX "[.]cpp$")
  set(named)
  foreach(source IN LISTS sources)
    cmake_path(ABSOLUTE_PATH source BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR} NORMALIZE)
    cmake_path(RELATIVE_PATH source BASE_DIRECTORY ${PROJECT_SOURCE_DIR})
    list(APPEND named ${source})
  endforeach()
  list(JOIN named " " named)
  file(APPEND ${PROJECT_BINARY_DIR}/batches.txt "${target} | ${named}\n")
  list(LENGTH sources count)
  if(NOT IRSIG_UNITY OR count LESS 2)
    return()
  endif()
  math(EXPR batches "(${count} + ${IRSIG_UNITY_BATCH} - 1) / ${IRSIG_UNITY_BATCH}")
  math(EXPR size "(${count} + ${batches} - 1) / ${batches}")
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${size})
  # GCC takes every file that a batch includes for a header.
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
endfunction()

function(irsig_module name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "HOT" "" "SOURCES;CHECKED;HEADERS;DEPENDS;EXTERNAL;PRECOMPILE")
  if(arg_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "irsig_module(${name}): unknown arguments ${arg_UNPARSED_ARGUMENTS}")
  endif()
  add_library(${name} STATIC ${arg_SOURCES})
  set_property(GLOBAL APPEND PROPERTY IRSIG_MODULES ${name})
  set_target_properties(${name} PROPERTIES IRSIG_HOT ${arg_HOT})
  target_sources(${name} PUBLIC FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR} FILES ${arg_HEADERS})
  target_link_libraries(${name} PUBLIC ${arg_DEPENDS} ${arg_EXTERNAL} PRIVATE irsig_warnings)
  if(arg_PRECOMPILE)
    irsig_precompile(${name} PRIVATE ${arg_PRECOMPILE})
  endif()
  irsig_batches(${name} ${arg_SOURCES})
  if(arg_CHECKED)
    add_library(${name}_checked OBJECT ${arg_CHECKED})
    target_link_libraries(${name}_checked PRIVATE ${arg_DEPENDS} ${arg_EXTERNAL} irsig_warnings)
    target_sources(${name} PRIVATE $<TARGET_OBJECTS:${name}_checked>)
    irsig_batches(${name}_checked ${arg_CHECKED})
  endif()
  irsig_declare_layer(${name} "${arg_DEPENDS}" "${arg_SOURCES};${arg_CHECKED};${arg_HEADERS}")
endfunction()

# A library that no code of a program reaches is not loaded when the program starts (--as-needed).
function(irsig_program name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES;HEADERS;DEPENDS;EXTERNAL;PRECOMPILE")
  if(arg_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "irsig_program(${name}): unknown arguments ${arg_UNPARSED_ARGUMENTS}")
  endif()
  add_executable(${name} ${arg_SOURCES} ${arg_HEADERS})
  target_link_libraries(${name} PRIVATE ${arg_DEPENDS} ${arg_EXTERNAL} irsig_warnings)
  target_link_options(${name} PRIVATE -Wl,--as-needed)
  if(arg_PRECOMPILE)
    irsig_precompile(${name} PRIVATE ${arg_PRECOMPILE})
  endif()
  irsig_batches(${name} ${arg_SOURCES})
  irsig_declare_layer(${name} "${arg_DEPENDS}" "${arg_SOURCES};${arg_HEADERS}")
endfunction()

# Libraries of generated code declare their place in the layers, and their generated headers, with
# this alone. One line of layers.txt: name | modules it may include | its files.
function(irsig_declare_layer name depends files)
  list(REMOVE_ITEM files "")
  set(owned)
  foreach(file IN LISTS files)
    cmake_path(ABSOLUTE_PATH file BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR} NORMALIZE)
    cmake_path(IS_PREFIX PROJECT_BINARY_DIR ${file} NORMALIZE generated)
    if(generated)
      cmake_path(RELATIVE_PATH file BASE_DIRECTORY ${PROJECT_BINARY_DIR})
    else()
      cmake_path(RELATIVE_PATH file BASE_DIRECTORY ${PROJECT_SOURCE_DIR})
    endif()
    list(APPEND owned ${file})
  endforeach()
  string(REPLACE ";" " " allowed "${depends}")
  string(REPLACE ";" " " owned "${owned}")
  file(APPEND ${PROJECT_BINARY_DIR}/layers.txt "${name} | ${allowed} | ${owned}\n")
endfunction()

# irsig_test(<name> SOURCES ... DEPENDS <libraries> [LABELS ...] [LONG] [ONE_PROCESS]): one GoogleTest executable; each
# TEST becomes one ctest entry named <folder>.<name>.<suite>.<test>. ONE_PROCESS: one entry <folder>.<name> runs them
# all, because they share something that takes long to prepare. LONG: the executable has a long form
# (tests/long_form.h), one ctest entry <folder>.<name>.long that only `ctest -C Long` runs.
function(irsig_test name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "LONG;ONE_PROCESS" "" "SOURCES;DEPENDS;LABELS")
  get_filename_component(folder ${CMAKE_CURRENT_SOURCE_DIR} NAME)
  set(target ${folder}_${name})
  add_executable(${target} ${arg_SOURCES})
  target_link_libraries(${target} PRIVATE ${arg_DEPENDS} GTest::gmock_main irsig_warnings)
  irsig_precompile(${target} REUSE_FROM irsig_test_headers)
  irsig_batches(${target} ${arg_SOURCES})
  set_target_properties(${target} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/tests)
  add_dependencies(${target} irsig-import)  # looked for beside the executable
  if(arg_ONE_PROCESS)
    add_test(NAME ${folder}.${name} COMMAND ${target})
    set_tests_properties(${folder}.${name} PROPERTIES LABELS "${folder};${arg_LABELS}" TIMEOUT ${IRSIG_TEST_TIMEOUT_S})
  else()
    gtest_discover_tests(${target} TEST_PREFIX ${folder}.${name}. DISCOVERY_MODE PRE_TEST DISCOVERY_TIMEOUT 300
                         PROPERTIES LABELS "${folder};${arg_LABELS}" TIMEOUT ${IRSIG_TEST_TIMEOUT_S})
  endif()
  if(arg_LONG)
    add_test(NAME ${folder}.${name}.long CONFIGURATIONS Long COMMAND ${target})
    set_tests_properties(${folder}.${name}.long PROPERTIES LABELS "${folder};long" TIMEOUT ${IRSIG_TEST_TIMEOUT_S}
                         ENVIRONMENT IRSIG_LONG=1)
  endif()
endfunction()
