// A page for an SVG drawing: its own white background, so that it reads on dark pages too, and a
// title that is wrapped. Self-contained: no style sheet, no script.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace cargobay::cli {

// Lines of at most `columns` characters (bytes, not 0), broken at spaces; a longer word is cut.
std::vector<std::string> wrapped(std::string_view text, std::size_t columns);

struct Heading {
  std::string title{};     // plain text, like the next
  std::string subtitle{};  // smaller and lighter; may be empty
};

// Pixels from the top of the page to the end of the heading.
double heading_height(const Heading& heading, double width);

// The whole document. `body` is SVG, below the heading; labels in it are sans-serif of 13 pixels.
std::string svg_page(double width, double height, double left, const Heading& heading,
                     std::string_view body);

}  // namespace cargobay::cli
