// How late the kernel wakes a thread that sleeps until an absolute time: what cyclictest measures,
// done the same way (rt-tests, src/cyclictest: clock_nanosleep, TIMER_ABSTIME, CLOCK_MONOTONIC).
#pragma once

#include "hal/jitter/channel.hpp"

namespace cargobay::hal::jitter {

std::unique_ptr<Channel> make_sleep_channel(const Settings& settings);

}  // namespace cargobay::hal::jitter
