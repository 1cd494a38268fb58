// Which program is run as the guard: it gets the robot's port and runs with the rights of the
// program that drives, so nobody else may have a say in it.
#pragma once

#include <string>

#include "hal/result.hpp"

namespace cargobay::hal {

// `wanted` if it is not empty; else $CARGOBAY_GUARD, unless the program has rights that its user
// has not (AT_SECURE, getauxval(3)); else the guard of the build tree, for code that itself lies in
// that tree; else the one at the place where this library is installed. Nothing is looked for in
// PATH, or beside or above the program. The file must belong to root or to the user (in a build
// tree to the owner of the code as well), and neither it nor any folder that leads to it may be
// writable by others, but for folders with the sticky bit. Fails with the reason and the remedy.
// Reads files; allocates.
Result<std::string> guard_program(const std::string& wanted);

}  // namespace cargobay::hal
