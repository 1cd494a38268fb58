#include "hal/cli/send/listening.hpp"

#include <algorithm>
#include <chrono>
#include <optional>

#include <fmt/format.h>

#include "hal/cli/connect/conversation.hpp"
#include "hal/cli/terminal/print.hpp"
#include "hal/cli/terminal/standard_streams.hpp"
#include "hal/cli/view/progress.hpp"

namespace cargobay::cli {
namespace {

constexpr std::chrono::milliseconds kBetweenLooks{100};  // until a signal is noticed

}  // namespace

Sent listen_only(hal::ByteStream& port, StopSignals& signals, double listen_s) {
  Conversation talk{port, signals};
  talk.show_frames();
  talk.show_bytes();
  std::optional<Progress> progress{std::in_place, "listening"};
  const rt::TimePoint end = port.now() + std::chrono::duration_cast<rt::Duration>(
                                             std::chrono::duration<double>{listen_s});
  while (port.now() < end && !talk.signal() && !output_error()) {
    if (talk.bytes() > 0) progress.reset();
    if (!talk.listen(std::min<rt::Duration>(kBetweenLooks, end - port.now())))
      return hal::Failure{"the port hung up; plug it in and start again"};
  }
  progress.reset();
  talk.end_text();
  if (talk.bytes() == 0 && !talk.signal()) {
    print_remark(
        fmt::format("nothing arrived in {} s at {} baud; a robot sends by itself only "
                    "while a stream runs, and while it starts or charges",
                    listen_s, port.baud()));
  }
  return talk.signal();
}

}  // namespace cargobay::cli
