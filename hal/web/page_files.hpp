// The files of the page, which are part of the program: made from hal/web/page at build.
#pragma once

#include <span>
#include <string_view>

namespace cargobay::web {

struct PageFile {
  std::string_view path;  // `/main.js`; that of index.html is `/`
  std::string_view type;  // for Content-Type
  std::string_view bytes;
};

std::span<const PageFile> page_files();

}  // namespace cargobay::web
