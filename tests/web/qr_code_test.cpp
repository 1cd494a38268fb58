#include "hal/web/program/qr_code.hpp"

#include <qrencode.h>

#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

namespace {

namespace web = cargobay::web;

// Rows of squares, true where light, from half blocks.
std::vector<std::vector<bool>> squares(std::string_view picture) {
  std::vector<std::vector<bool>> rows{{}, {}};
  const auto add = [&](bool upper, bool lower) {
    rows[rows.size() - 2].push_back(upper);
    rows.back().push_back(lower);
  };
  while (!picture.empty()) {
    if (picture.starts_with("\n")) {
      rows.emplace_back();
      rows.emplace_back();
    } else {
      add(picture.starts_with("█") || picture.starts_with("▀"),
          picture.starts_with("█") || picture.starts_with("▄"));
    }
    picture.remove_prefix(picture.starts_with(" ") || picture.starts_with("\n") ? 1 : 3);
  }
  rows.resize(rows.size() - 2);
  return rows;
}

TEST(QrCode, IsWhatTheLibraryMadeWithAMargin) {
  const std::string link = "http://192.168.0.7:8080/#token=0123456789abcdef0123456789abcdef";
  const auto rows = squares(web::qr_code(link));
  QRcode* const code = QRcode_encodeString8bit(link.c_str(), 0, QR_ECLEVEL_L);
  ASSERT_NE(code, nullptr);
  const auto width = static_cast<std::size_t>(code->width);
  ASSERT_GE(rows.size(), width + 4);
  for (std::size_t y = 0; y < width + 4; ++y) {
    ASSERT_EQ(rows[y].size(), width + 4);
    for (std::size_t x = 0; x < width + 4; ++x) {
      const bool inside = x >= 2 && y >= 2 && x < width + 2 && y < width + 2;
      const bool dark = inside && (code->data[(y - 2) * width + x - 2] & 1) != 0;
      EXPECT_EQ(rows[y][x], !dark) << x << ", " << y;
    }
  }
  QRcode_free(code);
}

TEST(QrCode, IsEmptyForWhatFitsInNone) { EXPECT_EQ(web::qr_code(std::string(10000, 'x')), ""); }

}  // namespace
