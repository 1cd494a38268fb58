// One slice of a channel whose frames come from a FrameSource: the measured thread and the source,
// both with real-time rights, the source just below, so that on a single processor the measured
// thread has gone back to sleep before the source reads what it wrote.
#pragma once

#include <functional>

#include "hal/jitter/channel.hpp"
#include "hal/jitter/frame_source.hpp"

namespace cargobay::hal::jitter {

// For the pseudo-terminals: they pass bytes at any rate.
inline constexpr std::uint32_t kPtyBaud = 115200;

// `answer` runs on the measured thread until `end` makes it return; `end` is called once, when the
// source has sent all its frames. Fails if a thread cannot be made.
Result<void> run_line_slice(const Line& line, const Settings& settings, const HeldFrame& held,
                            Stamps& stamps, Measured& measured, rt::RealtimeGrant& grant,
                            const std::function<void()>& answer, const std::function<void()>& end,
                            const std::atomic<bool>& stop);

}  // namespace cargobay::hal::jitter
