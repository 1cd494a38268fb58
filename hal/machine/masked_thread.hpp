// A thread of the library's own, which takes no signal of the program's.
#pragma once

#include <functional>
#include <system_error>
#include <thread>

namespace cargobay::hal {

// Starts `body` on `thread`, which is not running; after an error it still is not. All signals are
// blocked in it: they are the business of the program's own threads.
[[nodiscard]] std::error_code start_masked(std::thread& thread, std::function<void()> body);

}  // namespace cargobay::hal
