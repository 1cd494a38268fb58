// Marks a function of the real-time path: it neither allocates, locks, waits nor throws. Checked by
// clang (-Wfunction-effects, RealtimeSanitizer), empty for other compilers. It stands behind
// noexcept: `void step() noexcept CARGOBAY_NONBLOCKING;`
#pragma once

#if defined(__has_cpp_attribute) && __has_cpp_attribute(clang::nonblocking)
#define CARGOBAY_NONBLOCKING [[clang::nonblocking]]
#else
#define CARGOBAY_NONBLOCKING
#endif
