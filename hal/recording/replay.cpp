#include "hal/recording/replay.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <chrono>
#include <memory>
#include <span>
#include <string_view>

#include "hal/cycle/control_cycle.hpp"
#include "hal/cycle/cycle_parameters.hpp"
#include "hal/cycle/cycle_state.hpp"
#include "hal/cycle/request.hpp"
#include "hal/guard/guard_block.hpp"
#include "hal/guard/guard_mark.hpp"
#include "hal/stream/byte_stream.hpp"
#include "rt/unchecked.hpp"

namespace cargobay::hal {
namespace {

std::string text(double value) {
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.begin(), digits.end(), value);
  return {digits.data(), end.ptr};
}
std::string text(std::span<const std::uint8_t> bytes) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string out;
  for (const std::uint8_t byte : bytes) {
    if (!out.empty()) out += ' ';
    out += kDigits[byte >> 4U];
    out += kDigits[byte & 15U];
  }
  return out.empty() ? "nothing" : out;
}

std::string_view name(EntryKind kind) {
  switch (kind) {
    case EntryKind::waited: return "a wait";
    case EntryKind::clock: return "a look at the clock";
    case EntryKind::read: return "a read";
    case EntryKind::wrote: return "a write";
    case EntryKind::state: return "a tick";
    case EntryKind::ended: return "the end";
    case EntryKind::asked: return "a request";
  }
  return "";
}

// The recording as the cycle goes through it.
class Script {
 public:
  Script(const Recording& recording, const StateObserver& observer)
      : observer_{observer}, cursor_{std::span{recording.blocks()}.first(recording.unbroken())} {
    Entry entry;
    for (EntryCursor all = cursor_; all.next(entry);) {
      if (entry.kind == EntryKind::waited) ++waits_left_;
      if (entry.kind == EntryKind::ended) result_.end = entry.end;
    }
  }

  const ReplayResult& result() const { return result_; }
  rt::TimePoint time() const { return time_; }
  // The recording has ended, or no longer matches.
  bool over() const { return exhausted_ || result_.difference.has_value(); }

  // The next entry, if it is what the cycle asks for; otherwise `entry` means nothing.
  bool take(EntryKind asked, Entry& entry) {
    if (over()) return false;
    exhausted_ = !cursor_.next(entry);
    if (exhausted_) return false;
    if (entry.kind != asked) {
      differ("what the loop does next", std::string{name(entry.kind)}, std::string{name(asked)});
      return false;
    }
    if (!started_) start_ = entry.time;
    started_ = true;
    time_ = entry.time;
    if (asked == EntryKind::waited) --waits_left_;
    return true;
  }

  // What comes from outside shows in the recording only by what follows, or does not. The cycle
  // looks for it once per wait, so it may as well come in the last one.
  bool ends_here(CycleEnd end) const {
    return waits_left_ == 0 && result_.end.value_or(CycleEnd::asked) == end;
  }

  void compare_written(std::span<const std::uint8_t> recorded,
                       std::span<const std::uint8_t> bytes) {
    if (std::ranges::equal(recorded, bytes)) {
      ++result_.commands;
    } else {
      differ("bytes written", text(recorded), text(bytes));
    }
  }

  void compare(const CycleState& replayed) {
    Entry entry;
    if (!take(EntryKind::state, entry)) return;
    const CycleState& recorded = entry.state;
    compare_whole("tick", recorded.tick, replayed.tick);
    compare_whole("arrival", rt::nanoseconds(recorded.arrival), rt::nanoseconds(replayed.arrival));
    compare_whole("mode", static_cast<int>(recorded.mode), static_cast<int>(replayed.mode));
    compare_whole("remainder", static_cast<int>(recorded.remainder),
                  static_cast<int>(replayed.remainder));
    compare_whole("battery", recorded.battery_mv, replayed.battery_mv);
    compare_wheels("target", recorded.target, replayed.target);
    compare_wheels("set speed", recorded.set, replayed.set);
    compare_wheels("estimate", recorded.estimate, replayed.estimate);
    compare_wheels("command", recorded.command, replayed.command);
    if (over()) return;
    ++result_.frames;
    tick_ = recorded.tick;
    if (observer_.function != nullptr) observer_.function(observer_.context, replayed);
  }
  void note(const Event& event) const {
    if (!over() && observer_.event != nullptr) observer_.event(observer_.context, event);
  }

  // What was wanted in the present tick of the cycle.
  ControlAnswer wanted() const {
    Entry entry;
    for (EntryCursor ahead = cursor_; ahead.next(entry);) {
      if (entry.kind != EntryKind::state) continue;
      if (entry.state.setpoint_lapsed) return ControlAnswer::Kind::stand;
      return entry.state.target;
    }
    return rt::WheelSpeeds{};
  }

  // The requests of other threads, as the cycle takes them up in this pass.
  void give_requests(ControlCycle& cycle) const {
    Entry entry;
    for (EntryCursor ahead = cursor_; ahead.next(entry) && entry.kind != EntryKind::waited;) {
      if (entry.kind == EntryKind::asked) (void)cycle.request(entry.request);  // there was room
    }
  }
  void take_request() {
    Entry entry;
    (void)take(EntryKind::asked, entry);  // take() notes a difference
  }

  void finish(CycleEnd end) {
    Entry entry;
    if (over() || !take(EntryKind::ended, entry)) return;
    compare_whole("end", static_cast<int>(entry.end), static_cast<int>(end));
  }

 private:
  void compare_whole(const std::string& what, std::int64_t recorded, std::int64_t replayed) {
    if (!over() && recorded != replayed)
      differ(what, std::to_string(recorded), std::to_string(replayed));
  }
  void compare_wheels(const std::string& what, const rt::WheelSpeeds& recorded,
                      const rt::WheelSpeeds& replayed) {
    compare_bits("left " + what, recorded.left_mm_s, replayed.left_mm_s);
    compare_bits("right " + what, recorded.right_mm_s, replayed.right_mm_s);
  }
  void compare_bits(const std::string& what, double recorded, double replayed) {
    if (!over() && std::bit_cast<std::uint64_t>(recorded) != std::bit_cast<std::uint64_t>(replayed))
      differ(what, text(recorded), text(replayed));
  }
  void differ(const std::string& what, const std::string& recorded, const std::string& replayed) {
    result_.difference = ReplayDifference{.tick = tick_,
                                          .since_start = time_ - start_,
                                          .what = what,
                                          .recorded = recorded,
                                          .replayed = replayed};
  }

  const StateObserver observer_;
  EntryCursor cursor_;
  std::uint64_t waits_left_ = 0;
  bool exhausted_ = false;
  bool started_ = false;
  rt::TimePoint start_{};
  rt::TimePoint time_{};
  std::int64_t tick_ = 0;
  ReplayResult result_{};
};

// A replay is not in real time: if it finds a difference, it allocates.
class ReplayStream final : public ByteStream {
 public:
  ReplayStream(Script& script, std::uint32_t baud) : script_{script}, baud_{baud} {}

  // Call before the cycle runs; this must outlive the run.
  void attach(ControlCycle& cycle) {
    cycle_ = &cycle;
    guard_.state.store(GuardState::driving);
    cycle.set_guard(GuardMark{guard_, 0});
  }

  Wait wait(rt::TimePoint /*deadline*/) CARGOBAY_NONBLOCKING override {
    return rt::unchecked([this] {
      Entry entry;
      if (!script_.take(EntryKind::waited, entry)) return Wait::hung_up;
      if (script_.ends_here(CycleEnd::asked)) cycle_->request_stop();
      if (script_.ends_here(CycleEnd::guarded)) guard_.state.store(GuardState::taken);
      if (script_.ends_here(CycleEnd::guard_lost)) guard_.state.store(GuardState::guard_lost);
      // A silence that the cycle survived had been announced.
      cycle_->expect_silence(script_.ends_here(CycleEnd::link_lost) ? rt::Duration::zero()
                                                                    : std::chrono::hours{1});
      script_.give_requests(*cycle_);
      return entry.wait;
    });
  }
  Transfer read(std::span<std::uint8_t> bytes) CARGOBAY_NONBLOCKING override {
    return rt::unchecked([&]() -> Transfer {
      Entry entry;
      if (!script_.take(EntryKind::read, entry)) return {};
      entry.transfer.count = std::min(entry.transfer.count, bytes.size());
      std::ranges::copy(entry.bytes.first(entry.transfer.count), bytes.begin());
      return entry.transfer;
    });
  }
  Transfer write(std::span<const std::uint8_t> bytes) CARGOBAY_NONBLOCKING override {
    return rt::unchecked([&]() -> Transfer {
      Entry entry;
      if (!script_.take(EntryKind::wrote, entry)) return {.count = bytes.size()};
      script_.compare_written(entry.bytes, bytes);
      return entry.transfer;
    });
  }
  rt::TimePoint now() const CARGOBAY_NONBLOCKING override {
    return rt::unchecked([this] {
      Entry entry;
      return script_.take(EntryKind::clock, entry) ? entry.time : script_.time();
    });
  }
  std::uint32_t baud() const override { return baud_; }
  std::error_code set_baud(std::uint32_t baud) override {
    baud_ = baud;
    return {};
  }
  std::error_code set_wake_threshold(std::size_t /*bytes*/) override { return {}; }
  void discard_input() override {}
  bool drain(rt::Duration /*timeout*/) override { return true; }
  void sleep(rt::Duration /*duration*/) override {}

 private:
  Script& script_;  // outlives it
  std::uint32_t baud_;
  ControlCycle* cycle_ = nullptr;
  GuardBlock guard_{};  // no guard watches it
};

ControlAnswer wanted(void* context, const CycleState& /*state*/, double /*seconds*/)
    CARGOBAY_NONBLOCKING {
  return rt::unchecked([context] { return static_cast<const Script*>(context)->wanted(); });
}

void take_request(void* context, const Request& /*request*/) CARGOBAY_NONBLOCKING {
  rt::unchecked([&] { static_cast<Script*>(context)->take_request(); });
}

void compare(void* context, const CycleState& state) CARGOBAY_NONBLOCKING {
  rt::unchecked([&] { static_cast<Script*>(context)->compare(state); });
}

void note(void* context, const Event& event) CARGOBAY_NONBLOCKING {
  rt::unchecked([&] { static_cast<const Script*>(context)->note(event); });
}

}  // namespace

Result<ReplayResult> replay(const Recording& recording, const StateObserver& observer) {
  if (recording.unbroken() == 0) {
    return Failure{recording.blocks().empty()
                       ? "holds nothing of a drive yet"
                       : "does not hold the beginning of the drive, without which it cannot be "
                         "replayed; cargobay plot can show the rest"};
  }
  Script script{recording, observer};
  ReplayStream stream{script, recording.header().baud};
  const auto cycle = std::make_unique<ControlCycle>(stream, recording.header().parameters);
  stream.attach(*cycle);
  cycle->set_control({.function = &wanted, .context = &script});
  cycle->set_observer(
      {.function = &compare, .context = &script, .request = &take_request, .event = &note});
  if (script.ends_here(CycleEnd::asked)) cycle->request_stop();
  script.finish(cycle->run());
  return script.result();
}

}  // namespace cargobay::hal
