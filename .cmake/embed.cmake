# Makes a source that holds files as arrays: cmake -D OUT=... -D LIST=... -P embed.cmake
# LIST: a file of lines `PATH FILE`: under which path the file is served, and where it is.
file(STRINGS ${LIST} lines)
set(type_html "text/html; charset=utf-8")
set(type_css "text/css; charset=utf-8")
set(type_js "text/javascript; charset=utf-8")
set(type_txt "text/plain; charset=utf-8")
set(type_svg image/svg+xml)
set(type_png image/png)
set(type_webmanifest application/manifest+json)
set(arrays "")
set(rows "")
set(number 0)
foreach(line IN LISTS lines)
  string(REGEX MATCH "^([^ ]+) (.+)$" matched "${line}")
  set(path ${CMAKE_MATCH_1})
  set(file ${CMAKE_MATCH_2})
  cmake_path(GET path EXTENSION LAST_ONLY extension)
  string(REPLACE "." "" extension "${extension}")
  if(path STREQUAL "/")
    set(extension html)
  endif()
  if(NOT DEFINED type_${extension})
    message(FATAL_ERROR "${file}: of which type is .${extension}?")
  endif()
  set(type "${type_${extension}}")
  file(READ ${file} hex HEX)
  string(LENGTH "${hex}" length)
  math(EXPR length "${length} / 2")
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "'\\\\x\\1'," bytes "${hex}")
  # An array of none is not C++.
  string(APPEND arrays "constexpr char kFile${number}[] = {${bytes}'\\0'};\n")
  string(APPEND rows "    {\"${path}\", \"${type}\", {kFile${number}, ${length}}},\n")
  math(EXPR number "${number} + 1")
endforeach()
file(WRITE ${OUT} "// Made by .cmake/embed.cmake.
#include \"hal/web/page_files.hpp\"

#include <array>

namespace cargobay::web {
namespace {

${arrays}
constexpr auto kFiles = std::to_array<PageFile>({
${rows}});

}  // namespace

std::span<const PageFile> page_files() { return kFiles; }

}  // namespace cargobay::web
")
