# Run as a script (cmake -P): writes OUTPUT, a C++ source that defines `const std::string_view NAME` with the bytes of INPUT.
file(READ ${INPUT} bytes HEX)
string(REGEX REPLACE "([0-9a-f][0-9a-f])" "'\\\\x\\1'," bytes "${bytes}")
file(WRITE ${OUTPUT} "#include <string_view>\nnamespace trueblade {\nnamespace {\nconstexpr char bytes[] = {${bytes}};\n}\n"
                     "extern const std::string_view ${NAME};\nconst std::string_view ${NAME}(bytes, sizeof bytes);\n}\n")
