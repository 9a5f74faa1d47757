# Writes a source file that holds text files: -DOUT=x.cpp -DFILES="name=path;..." Each becomes
# `extern const std::string_view NAME` in app::embedded.
set(text "#include <string_view>\nnamespace app::embedded {\n")
foreach(entry IN LISTS FILES)
  string(REGEX MATCH "^([^=]+)=(.*)$" _ "${entry}")
  set(name "${CMAKE_MATCH_1}")
  file(READ "${CMAKE_MATCH_2}" content)
  if(content MATCHES "[)]embedded\"")
    message(FATAL_ERROR "${CMAKE_MATCH_2} holds the mark that ends a text")
  endif()
  string(APPEND text "extern const std::string_view ${name};\nconst std::string_view ${name} = R\"embedded(${content})embedded\";\n")
endforeach()
string(APPEND text "}  // namespace app::embedded\n")
file(WRITE "${OUT}" "${text}")
