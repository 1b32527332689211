# Writes OUT, a C file with the text of FILE: `const char NAME_text[]`, NUL-terminated, and `const size_t NAME_size`
# without the NUL. HEADER declares them.
file(READ ${FILE} hex HEX)
string(LENGTH "${hex}" digits)
math(EXPR size "${digits} / 2")
string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${hex}")
file(WRITE ${OUT} "#include \"${HEADER}\"\n\nconst char ${NAME}_text[] = { ${bytes}0x00 };\nconst size_t ${NAME}_size = ${size};\n")
