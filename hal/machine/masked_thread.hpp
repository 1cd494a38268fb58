// A thread of the library's own, which takes none of the program's signals.
#pragma once

#include <functional>
#include <system_error>
#include <thread>

namespace cargobay::hal {

// Starts `body` on `thread`, which must not be running; after an error it still is not. All signals
// are blocked in it: they are for the program's own threads.
[[nodiscard]] std::error_code start_masked(std::thread& thread, std::function<void()> body);

}  // namespace cargobay::hal
