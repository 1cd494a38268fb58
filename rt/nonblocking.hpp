// Marks a function of the real-time path: it neither throws, allocates, locks nor waits. Checked by
// clang (-Wfunction-effects, RealtimeSanitizer); other compilers see only noexcept.
//
//   void step() CARGOBAY_NONBLOCKING;
//   double speed() const CARGOBAY_NONBLOCKING { return speed_; }
#pragma once

#if defined(__has_cpp_attribute) && __has_cpp_attribute(clang::nonblocking)
#define CARGOBAY_NONBLOCKING noexcept [[clang::nonblocking]]
#else
#define CARGOBAY_NONBLOCKING noexcept
#endif
