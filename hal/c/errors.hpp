// What a C function returns and leaves behind when it fails: a code, and a line for a person.
#pragma once

#include <exception>
#include <new>
#include <string>
#include <string_view>

#include "hal/c/cargobay.h"
#include "hal/c/handles.hpp"
#include "hal/result.hpp"

namespace cargobay::c {

// Keeps the message for cargobay_error_message() on this thread; returns the code. One of up to 319
// bytes allocates nothing.
int fail(int code, std::string_view message) noexcept;
inline int fail(int code, const hal::Failure& failure) noexcept {
  return fail(code, std::string_view{failure.message});
}

// What was kept last on this thread; "" before the first.
const char* last_failure() noexcept;

// For mistakes that only the caller can make.
inline int bad_argument(std::string_view what) noexcept { return fail(CARGOBAY_E_ARGUMENT, what); }

// For a handle that is not an open one of this kind.
int bad_handle(const void* handle, HandleKind wanted) noexcept;

// Runs a function that returns such a code. No exception escapes into C.
template <typename Function>
int guarded(const Function& function) noexcept {
  try {
    return function();
  } catch (const std::bad_alloc&) {
    return fail(CARGOBAY_E_MEMORY, "out of memory; free some, or use a machine with more");
  } catch (const std::exception& error) {
    return fail(CARGOBAY_E_SYSTEM, std::string{"the system refused: "} + error.what());
  }
}

}  // namespace cargobay::c
