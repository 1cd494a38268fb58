// Which program is run as the guard. It gets the robot's port and runs with the rights of the
// program that drives, so no other user may influence the choice.
#pragma once

#include <string>

#include "hal/result.hpp"

namespace cargobay::hal {

// `wanted` if it is not empty; else $CARGOBAY_GUARD, unless the program has rights that its user
// does not have (AT_SECURE, getauxval(3)); else the guard of the build tree, for code that itself
// lies in that tree; else the one of the installation that the code is in: PREFIX/lib/cargobay for
// PREFIX/lib and PREFIX/bin; else the one in the place that was configured. Neither PATH nor the
// folders beside or above the program are searched. The file must belong to root or to the user
// (in a build tree, also to the owner of the code), and neither it nor any folder that leads to it
// may be writable by others, except folders with the sticky bit. Fails with the reason and the
// remedy. Reads files; allocates.
Result<std::string> guard_program(const std::string& wanted);

}  // namespace cargobay::hal
