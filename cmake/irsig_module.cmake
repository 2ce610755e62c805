# irsig_module(<name> SOURCES ... HEADERS ... DEPENDS <irsig modules> [EXTERNAL <third-party targets>])
#
# One folder = one static library = one line of permissions. DEPENDS is the only place where a
# dependency is declared: CMake links from it (and refuses cycles), and the test architecture.layers
# fails any #include that it does not allow.
set_property(GLOBAL PROPERTY GLOBAL_DEPENDS_NO_CYCLES ON)
file(WRITE ${PROJECT_BINARY_DIR}/layers.txt "")

function(irsig_module name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES;HEADERS;DEPENDS;EXTERNAL")
  if(arg_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "irsig_module(${name}): unknown arguments ${arg_UNPARSED_ARGUMENTS}")
  endif()
  add_library(${name} STATIC ${arg_SOURCES})
  target_sources(${name} PUBLIC FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR} FILES ${arg_HEADERS})
  target_link_libraries(${name} PUBLIC ${arg_DEPENDS} ${arg_EXTERNAL} PRIVATE irsig_warnings)
  irsig_declare_layer(${name} "${arg_DEPENDS}")
endfunction()

# Executables, tests and generated-code libraries declare their place in the layers with this alone.
function(irsig_declare_layer name depends)
  file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
  string(REPLACE ";" " " allowed "${depends}")
  file(APPEND ${PROJECT_BINARY_DIR}/layers.txt "${name} ${folder} : ${allowed}\n")
endfunction()

# irsig_test(<name> SOURCES ... DEPENDS <libraries> [LABELS ...]): one GoogleTest executable; each
# TEST becomes one ctest entry named <folder>.<name>.<suite>.<test>.
function(irsig_test name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES;DEPENDS;LABELS")
  get_filename_component(folder ${CMAKE_CURRENT_SOURCE_DIR} NAME)
  set(target ${folder}_${name})
  add_executable(${target} ${arg_SOURCES})
  target_link_libraries(${target} PRIVATE ${arg_DEPENDS} GTest::gmock_main irsig_warnings)
  set_target_properties(${target} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/tests)
  gtest_discover_tests(${target} TEST_PREFIX ${folder}.${name}. DISCOVERY_MODE PRE_TEST
                       PROPERTIES LABELS "${folder};${arg_LABELS}" TIMEOUT 600)
endfunction()
