// Drawings as files: SVG or, by their name, PNG.
#pragma once

#include <string>

#include "hal/result.hpp"

namespace cargobay::cli {

// To be asked before anything is done for the drawing. "x.png" (in any case) becomes a PNG;
// "x.svg", "-" and names without the ending of another kind of picture are SVG. Fails, and says
// what to do, for the endings of other kinds (.jpg, .pdf), and for .png if librsvg's rsvg-convert
// is not installed. An empty path is an option that was not given. `option` is for the message.
// Reads the environment; allocates.
hal::Result<void> check_picture_name(const std::string& option, const std::string& path);

// What belongs into the file of that name. Starts rsvg-convert for a PNG, and blocks until it is
// done. Fails if it does.
hal::Result<std::string> picture(std::string svg, const std::string& path);

}  // namespace cargobay::cli
