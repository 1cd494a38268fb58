// The device files of GPIO chips.
#pragma once

#include <string>
#include <vector>

namespace cargobay::gpio {

// Every character device /dev/gpiochip*, in the order of their numbers; links are left out, since
// they lead to a chip that is listed anyway.
std::vector<std::string> chip_files();
// The group that owns the file; empty if it has no name.
std::string owning_group(const std::string& path);

}  // namespace cargobay::gpio
