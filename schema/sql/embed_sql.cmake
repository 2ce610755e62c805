# cmake -DOUTPUT=<header> -DSOURCES=<a.sql|b.sql> -P embed_sql.cmake
#
# Every statement that follows a line "-- name: <identifier>" in SOURCES becomes irsig::sql::<identifier>.
set(text "// Made from schema/sql by embed_sql.cmake.\n#pragma once\n\nnamespace irsig::sql {\n\n")
set(mark "-- name: ")
string(LENGTH "${mark}" mark_length)

string(REPLACE "|" ";" sources "${SOURCES}")
foreach(source IN LISTS sources)
  file(READ "${source}" rest)
  string(FIND "${rest}" "${mark}" at)
  if(at EQUAL -1)
    message(FATAL_ERROR "${source}: no statement (a line \"${mark}<identifier>\")")
  endif()
  # Substrings only: a CMake list would split at the semicolons of the SQL.
  while(NOT at EQUAL -1)
    math(EXPR at "${at} + ${mark_length}")
    string(SUBSTRING "${rest}" ${at} -1 rest)
    string(FIND "${rest}" "\n" line_end)
    string(SUBSTRING "${rest}" 0 ${line_end} name)
    string(FIND "${rest}" "${mark}" at)
    string(SUBSTRING "${rest}" ${line_end} -1 body)
    if(NOT at EQUAL -1)
      math(EXPR body_length "${at} - ${line_end}")
      string(SUBSTRING "${body}" 0 ${body_length} body)
    endif()
    string(APPEND text "inline constexpr char ${name}[] = R\"sql(${body})sql\";\n\n")
  endwhile()
endforeach()

string(APPEND text "}  // namespace irsig::sql\n")
file(WRITE "${OUTPUT}" "${text}")
