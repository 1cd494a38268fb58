// A token that is kept in a file, for whoever may read that.
#pragma once

#include <string>

#include "hal/result.hpp"

namespace cargobay::web {

// The token in the file: its only line. If there is no such file, one is made with a new token, for
// its owner and, to read, its group. Fails if others could use the file, or if it has no token; the
// message says what to do. Blocks for the file system; one thread, since it sets the umask.
hal::Result<std::string> token_in(const std::string& path);

}  // namespace cargobay::web
