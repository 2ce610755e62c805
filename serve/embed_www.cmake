# cmake -DOUTPUT=<source> -DSOURCES=<a.html|b.js> [-DFUNCTION=<name>] -P embed_www.cmake
#
# The files as bytes of the function irsig::www_files() (serve/www_files.h), or of that name.
if(NOT FUNCTION)
  set(FUNCTION www_files)
endif()
set(text "// Made from serve/www by embed_www.cmake.\n#include \"serve/www_files.h\"\n\nnamespace irsig {\nnamespace {\n\n")
set(table "")
string(REPLACE "|" ";" sources "${SOURCES}")
set(number 0)
foreach(source IN LISTS sources)
  file(READ "${source}" hex HEX)
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${hex}")
  get_filename_component(name "${source}" NAME)
  string(APPEND text "constexpr unsigned char file${number}[] = {${bytes}};\n\n")
  string(APPEND table "      {\"${name}\", {reinterpret_cast<const char*>(file${number}), sizeof file${number}}},\n")
  math(EXPR number "${number} + 1")
endforeach()
string(APPEND text "}  // namespace\n\nconst std::vector<WwwFile>& ${FUNCTION}() {\n  static const std::vector<WwwFile> files = {\n"
       "${table}  };\n  return files;\n}\n\n}  // namespace irsig\n")
file(WRITE "${OUTPUT}" "${text}")
