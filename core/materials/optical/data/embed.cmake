# cmake -DINPUT=<yml;yml;...> -DOUTPUT=<inc> -P embed.cmake
#
# The library's entries as initializers of {file name, text}, so that the program needs no file at run time.
set(out "// Made from the .yml files of core/materials/optical/data by embed.cmake.\n")
foreach(file IN LISTS INPUT)
  file(READ ${file} text)
  get_filename_component(name ${file} NAME)
  string(APPEND out "{\"${name}\", R\"irsig(${text})irsig\"},\n")
endforeach()
file(WRITE ${OUTPUT} "${out}")
