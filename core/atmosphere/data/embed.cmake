# cmake -DINPUT=<file> -DOUTPUT=<inc> -P embed.cmake
#
# A text file -> one raw string literal, so that the program needs no file at run time.
file(READ ${INPUT} text)
file(WRITE ${OUTPUT} "R\"irsig(")
file(APPEND ${OUTPUT} "${text}")
file(APPEND ${OUTPUT} ")irsig\"")
