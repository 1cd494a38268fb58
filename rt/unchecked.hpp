// Calls something from a real-time function that the checkers cannot prove harmless. Each use says
// why it is: the one wait of the cycle, a system call on a descriptor that does not block, the
// clock.
#pragma once

#include "rt/nonblocking.hpp"

#if defined(__has_feature)
#if __has_feature(realtime_sanitizer)
#define CARGOBAY_RTSAN 1
#include <sanitizer/rtsan_interface.h>
#endif
#endif

namespace cargobay::rt {

#if defined(__clang__) && __clang_major__ >= 20
#pragma clang diagnostic push
#pragma clang diagnostic ignored "-Wfunction-effects"
#endif
template <typename Function>
auto unchecked(Function&& function) CARGOBAY_NONBLOCKING {
#ifdef CARGOBAY_RTSAN
  const __rtsan::ScopedDisabler disabler;
#endif
  return function();
}
#if defined(__clang__) && __clang_major__ >= 20
#pragma clang diagnostic pop
#endif

}  // namespace cargobay::rt
