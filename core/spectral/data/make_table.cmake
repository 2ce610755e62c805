# cmake -DINPUT=<csv> -DOUTPUT=<inc> -P make_table.cmake
#
# A two-column CSV (lines that start with # are its source, then one header line) -> the initializers of two
# arrays, so that the program needs no file at run time.
file(STRINGS ${INPUT} lines REGEX "^[^#]")
list(POP_FRONT lines header)
set(x "")
set(y "")
foreach(line IN LISTS lines)
  if(NOT line MATCHES "^([0-9.eE+-]+),([0-9.eE+-]+)$")
    message(FATAL_ERROR "${INPUT}: not a row of two numbers: ${line}")
  endif()
  string(APPEND x "    ${CMAKE_MATCH_1},\n")
  string(APPEND y "    ${CMAKE_MATCH_2},\n")
endforeach()
get_filename_component(name ${INPUT} NAME)
file(WRITE ${OUTPUT} "// Made from ${name} (${header}) by make_table.cmake.\n"
     "constexpr double kAbscissa[] = {\n${x}};\nconstexpr double kOrdinate[] = {\n${y}};\n")
