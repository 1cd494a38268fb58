// Kinds of failure that a caller treats differently, where the system has no number for them.
#pragma once

#include <system_error>
#include <type_traits>

namespace cargobay::hal {

enum class Trouble {
  silent = 1,   // the robot does not answer
  unruly,       // it answered, but not at the wanted rate, or not for long
  wrong_mode,   // it does not go to the wanted mode
  cancelled,    // by the caller; equivalent to std::errc::operation_canceled
  pin,          // a GPIO line cannot be used
  hung_up,      // the port went away
  guard,        // the guard cannot be started, or has died
  unconfirmed,  // something failed, and the robot may be moving
  no_thread,    // no thread could be started
};

const std::error_category& trouble_category() noexcept;
inline std::error_code make_error_code(Trouble trouble) noexcept {
  return {static_cast<int>(trouble), trouble_category()};
}

}  // namespace cargobay::hal

template <>
struct std::is_error_code_enum<cargobay::hal::Trouble> : std::true_type {};
