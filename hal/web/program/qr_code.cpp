#include "hal/web/program/qr_code.hpp"

#include <qrencode.h>

#include <memory>

namespace cargobay::web {

std::string qr_code(std::string_view text) {
  const std::unique_ptr<QRcode, void (*)(QRcode*)> code{
      QRcode_encodeString8bit(std::string{text}.c_str(), 0, QR_ECLEVEL_L), QRcode_free};
  if (!code) return {};
  constexpr int kMargin = 2;  // the standard asks for 4; cameras do with 2, and terminals are small
  const int width = code->width;
  const auto is_light = [&](int x, int y) {
    if (x < 0 || y < 0 || x >= width || y >= width) return true;
    return (code->data[y * width + x] & 1U) == 0;
  };
  std::string picture;
  for (int y = -kMargin; y < width + kMargin; y += 2) {
    for (int x = -kMargin; x < width + kMargin; ++x) {
      const bool upper = is_light(x, y);
      const bool lower = y + 1 < width + kMargin && is_light(x, y + 1);
      picture += upper ? (lower ? "█" : "▀") : (lower ? "▄" : " ");
    }
    picture += '\n';
  }
  return picture;
}

}  // namespace cargobay::web
