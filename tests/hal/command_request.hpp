// A command that another thread asks the control cycle to send.
#pragma once

#include <algorithm>
#include <cstdint>
#include <initializer_list>

#include "hal/cycle/request.hpp"

namespace cargobay::hal::test {

inline Request command(std::initializer_list<std::uint8_t> bytes,
                       Request::WhenLong when_long = Request::WhenLong::wait) {
  Request request;
  request.when_long = when_long;
  request.size = static_cast<std::uint8_t>(bytes.size());
  std::ranges::copy(bytes, request.bytes.begin());
  return request;
}

}  // namespace cargobay::hal::test
