#include "hal/jitter/frame_source.hpp"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <ctime>

#include "hal/jitter/sample_frames.hpp"
#include "oi/command_parser.hpp"
#include "oi/commands.hpp"

namespace cargobay::hal::jitter {
namespace {

void sleep_until(rt::TimePoint time) {
  const timespec until = rt::as_timespec(time.time_since_epoch());
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) != 0) {
  }
}

class Source {
 public:
  Source(const Line& line, const Settings& settings, const HeldFrame& held, Stamps& stamps,
         Recorder& recorder)
      : line_{line}, settings_{settings}, held_{held}, stamps_{stamps}, recorder_{recorder} {}

  void run(const std::atomic<bool>& stop) {
    const std::size_t frames = settings_.warm_up + settings_.slice_frames;
    rt::TimePoint due = rt::Clock::now() + settings_.period;
    for (std::size_t frame = 0; frame < frames && !stop.load(std::memory_order_relaxed); ++frame) {
      sleep_until(due);
      if (arrived_ns_ != 0) book();
      send(frame);
      // A source that was delayed itself skips ticks but, like a robot, keeps its phase.
      do {
        due += settings_.period;
      } while (due < rt::Clock::now());
      look_for_command(due);
    }
    if (arrived_ns_ != 0) book();
    if (waiting_) recorder_.miss();  // the last frame: how long it waited is unknown
  }

 private:
  void send(std::size_t frame) {
    if (!waiting_) drop_stale_answers();
    // Read before the bytes are handed over: the measured thread may run before write() returns.
    const rt::TimePoint complete = rt::Clock::now();
    const bool held = held_.every != 0 && (frame + 1) % held_.every == 0;
    if (held) sleep_until(complete + held_.by);
    const FrameBytes& bytes = frames_[static_cast<std::size_t>(list_)];
    (void)!::write(line_.to_measured, bytes.data(), bytes.size());  // fits in a queue of 4 KiB
    if (waiting_) {
      ++now_.missed;
      return;
    }
    now_ = {};
    now_.complete_ns = rt::nanoseconds(complete);
    waiting_ = true;
  }

  // Waits until the command is here, or until `deadline`.
  void look_for_command(rt::TimePoint deadline) {
    while (waiting_) {
      const rt::Duration left = deadline - rt::Clock::now();
      if (left <= rt::Duration::zero()) return;
      const timespec timeout = rt::as_timespec(left);
      pollfd source{.fd = line_.from_measured, .events = POLLIN, .revents = 0};
      if (ppoll(&source, 1, &timeout, nullptr) <= 0) return;
      std::array<std::uint8_t, 256> bytes{};
      const ssize_t count = ::read(line_.from_measured, bytes.data(), bytes.size());
      if (count <= 0) return;
      for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) hear(bytes[i]);
    }
  }

  // After a frame that was answered late, the next one was answered at once as well.
  void drop_stale_answers() {
    std::array<std::uint8_t, 256> bytes{};
    for (;;) {
      const ssize_t count = ::read(line_.from_measured, bytes.data(), bytes.size());
      if (count <= 0) return;
      for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) hear(bytes[i]);
    }
  }

  void hear(std::uint8_t byte) {
    if (parser_.push(byte) != oi::CommandParser::Outcome::command) return;
    const std::uint8_t opcode = parser_.info().opcode;
    if (opcode == oi::DriveDirect::kOpcode && waiting_) {
      arrived_ns_ = rt::nanoseconds(rt::Clock::now());
      waiting_ = false;
    }
    if (opcode == oi::Stream::kOpcode) list_ = list_asked_for(parser_.bytes().subspan(2));
  }
  static FrameList list_asked_for(std::span<const std::uint8_t> ids) {
    for (std::size_t i = 0; i < oi::kFrameLists; ++i) {
      const auto list = static_cast<FrameList>(i);
      const oi::StreamList& wanted = oi::kCreate.list(list);
      const bool same = std::equal(ids.begin(), ids.end(), wanted.begin(), wanted.end(),
                                   [](std::uint8_t id, oi::PacketId packet) {
                                     return id == static_cast<std::uint8_t>(packet);
                                   });
      if (same) return list;
    }
    return FrameList::reading;
  }

  // By now the thread that wrote the command has stamped it, because it runs before this one. On
  // another processor it may be a moment later.
  void book() {
    const std::uint64_t answers = answers_ + 1;
    for (int i = 0; stamps_.answers.load(std::memory_order_acquire) < answers && i < 1'000'000;
         ++i) {
    }
    answers_ = stamps_.answers.load(std::memory_order_acquire);
    if (answers_ == answers) {
      now_.set(Stage::woken, stamps_.woken_ns.load(std::memory_order_relaxed));
      now_.set(Stage::decided, stamps_.decided_ns.load(std::memory_order_relaxed));
      now_.set(Stage::written, stamps_.written_ns.load(std::memory_order_relaxed));
    } else {
      now_.set(Stage::written, arrived_ns_);  // the stamps are of a later answer already
    }
    now_.set(Stage::arrived, arrived_ns_);
    recorder_.take(now_);
    arrived_ns_ = 0;
  }

  Line line_;
  const Settings& settings_;
  HeldFrame held_;
  Stamps& stamps_;
  Recorder& recorder_;
  std::array<FrameBytes, oi::kFrameLists> frames_ = sample_frames();
  FrameList list_ = FrameList::reading;
  oi::CommandParser parser_{};
  Instants now_{};
  bool waiting_ = false;
  std::int64_t arrived_ns_ = 0;
  std::uint64_t answers_ = 0;
};

}  // namespace

void send_frames(const Line& line, const Settings& settings, const HeldFrame& held, Stamps& stamps,
                 Recorder& recorder, const std::atomic<bool>& stop) {
  Source{line, settings, held, stamps, recorder}.run(stop);
}

}  // namespace cargobay::hal::jitter
