#include "hal/cli/drawing/svg_page.hpp"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>

#include "hal/cli/drawing/xml_text.hpp"

namespace cargobay::cli {
namespace {

constexpr double kTitleSize = 15.0;
constexpr double kSubtitleSize = 13.0;
constexpr double kLeading = 1.25;
constexpr double kPageMargin = 84.0;  // the least on both sides together
constexpr double kWidest = 0.62;      // of a letter, on average, over its size

std::vector<std::string> page_lines(const std::string& text, double width, double size) {
  const double columns = std::max((width - kPageMargin) / (kWidest * size), 10.0);
  return wrapped(text, static_cast<std::size_t>(columns));
}

}  // namespace

std::vector<std::string> wrapped(std::string_view text, std::size_t columns) {
  std::vector<std::string> all;
  while (!text.empty()) {
    std::size_t end = text.size();
    if (end > columns) {
      const std::size_t space = text.rfind(' ', columns);
      end = space == std::string_view::npos || space == 0 ? columns : space;
      // Not within a character of UTF-8.
      while (end > 1 && (static_cast<unsigned char>(text[end]) & 0xc0U) == 0x80U) --end;
    }
    all.emplace_back(text.substr(0, end));
    text.remove_prefix(end);
    while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  }
  return all;
}

double heading_height(const Heading& heading, double width) {
  const auto count = [width](const std::string& text, double size) {
    return static_cast<double>(page_lines(text, width, size).size()) * size * kLeading;
  };
  return 6.0 + count(heading.title, kTitleSize) + count(heading.subtitle, kSubtitleSize);
}

std::string svg_page(double width, double height, double left, const Heading& heading,
                     std::string_view body) {
  std::string svg = fmt::format(
      R"(<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {0} {1}" width="{0}" height="{1}" font-family="sans-serif" font-size="13" fill="#222">)"
      "\n"
      R"(<rect width="{0}" height="{1}" fill="white"/>)"
      "\n",
      width, height);
  double y = 6.0;
  const auto write = [&](const std::string& text, double size, const char* color) {
    for (const std::string& line : page_lines(text, width, size)) {
      y += size * kLeading;
      fmt::format_to(std::back_inserter(svg),
                     R"(<text x="{}" y="{:.1f}" font-size="{}" fill="{}">{}</text>)"
                     "\n",
                     left, y, size, color, xml_text(line));
    }
  };
  write(heading.title, kTitleSize, "#222");
  write(heading.subtitle, kSubtitleSize, "#555");
  svg += body;
  return svg + "</svg>\n";
}

}  // namespace cargobay::cli
