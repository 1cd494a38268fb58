// A link as a picture for a phone's camera, in characters.
#pragma once

#include <string>
#include <string_view>

namespace cargobay::web {

// The QR code of `text` in half blocks, two rows of squares to a line, with a margin; dark squares
// are spaces, for a dark terminal on which the rest is printed light. Empty if `text` is too long.
// Allocates. Any thread.
std::string qr_code(std::string_view text);

}  // namespace cargobay::web
