# One interface target, cargobay_sanitize, which every layer, test and executable links.
add_library(cargobay_sanitize INTERFACE)

set(sanitize_flags "")
if(CARGOBAY_SANITIZE STREQUAL "address")
  set(sanitize_flags -fsanitize=address,undefined -fno-sanitize-recover=all)
elseif(CARGOBAY_SANITIZE STREQUAL "thread")
  set(sanitize_flags -fsanitize=thread)
elseif(CARGOBAY_SANITIZE STREQUAL "realtime")
  set(sanitize_flags -fsanitize=realtime)
  target_compile_options(cargobay_sanitize INTERFACE
    -Wfunction-effects -Werror=function-effects)
elseif(NOT CARGOBAY_SANITIZE STREQUAL "")
  message(FATAL_ERROR "CARGOBAY_SANITIZE=${CARGOBAY_SANITIZE}: expected address, thread or realtime")
endif()

if(sanitize_flags)
  if(NOT CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    message(FATAL_ERROR "CARGOBAY_SANITIZE=${CARGOBAY_SANITIZE} needs clang; use the preset")
  endif()
  target_compile_options(cargobay_sanitize INTERFACE ${sanitize_flags} -fno-omit-frame-pointer)
  target_link_options(cargobay_sanitize INTERFACE ${sanitize_flags})
endif()
