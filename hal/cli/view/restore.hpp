// A terminal as it was before a view took its whole screen, put back from wherever the process
// ends: from a signal handler, too, or from a thread that ends it.
#pragma once

#include <termios.h>

#include <optional>
#include <string_view>

namespace cargobay::cli {

// Remembers how to leave: by writing `leave` to the descriptor, and setting what was found. From
// here on a crash does that first. `leave` is at most 200 bytes; a longer one is not written.
void arm_restore(int descriptor, std::string_view leave, const std::optional<termios>& found);
// The view has left by itself.
void disarm_restore();
// Leaves, if armed. Async-signal-safe, any thread; does not wait for a terminal that takes nothing.
void restore_terminal() noexcept;

}  // namespace cargobay::cli
