#include "tests/campaign/verdict.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>

#include "hal/sensing/mode_watch.hpp"
#include "oi/checksum.hpp"
#include "oi/dialect.hpp"
#include "oi/frame.hpp"
#include "oi/limits.hpp"

namespace cargobay::campaign {
namespace {

using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""s;

// An adapter holds frames up for no more ticks than this.
constexpr std::uint64_t kLatest = 4;
// A robot that was told to stream more than fits sends sensor values up to this old.
constexpr std::uint64_t kLatestBehindLongFrames = 20;
// After the last frame, until the cycle ends: the link's second, the next deadline, and its margin.
constexpr rt::Duration kLongestSilence = 1s + 15ms + 5ms + 2ms;
constexpr double kDriven = 40.0;  // mm/s: how close the truth is to the setpoint, once settled
constexpr int kMostBackAfter = 2;
// The list must change before it shows that the robot does not hear; then come 510 zeros.
constexpr int kMostWaited = 64;

std::uint64_t sum(const hal::FrameCounters& frames) {
  return frames.good + frames.bad + frames.lost;
}

class Judge {
 public:
  Judge(const FaultCase& fault, const Observations& seen) : fault_{fault}, seen_{seen} {}

  Verdict verdict() {
    if (!seen_.brought_up || seen_.answers.empty()) {
      violation("was not brought up");
      return std::move(verdict_);
    }
    count_impostors();
    judge_course();
    judge_counters();
    for (const AnswerSeen& answer : seen_.answers) judge_published(answer);
    judge_commands(seen_.written, "sent");
    if (fault_.course != Course::either) judge_commands(seen_.obeyed, "obeyed");
    if (seen_.end == hal::CycleEnd::asked) judge_obedience();
    if (seen_.end == hal::CycleEnd::asked && !fault_.may_silence) judge_recovery();
    if (seen_.end == hal::CycleEnd::asked) judge_waiting();
    if (seen_.end == hal::CycleEnd::asked && !verdict_.deaf) count_disobedience();
    judge_restart();
    if (!seen_.passive_at_last) violation("was not left in Passive");
    if (seen_.commanded_at_last != rt::WheelSpeeds{}) violation("was left rolling");
    return std::move(verdict_);
  }

 private:
  // Each kind only once.
  void violation(const std::string& what) {
    if (std::ranges::find(verdict_.violations, what) == verdict_.violations.end())
      verdict_.violations.push_back(what);
  }

  const TickSeen* tick(std::uint64_t number) const {
    const std::uint64_t first = seen_.ticks.front().tick;
    if (number < first || number - first >= seen_.ticks.size()) return nullptr;
    return &seen_.ticks[number - first];
  }

  // The right end, and no later than necessary.
  void judge_course() {
    using hal::CycleEnd;
    const CycleEnd end = seen_.end;
    if (fault_.course == Course::goes_on && end != CycleEnd::asked) violation("ended");
    if (fault_.course == Course::link_lost && end != CycleEnd::link_lost)
      violation("did not lose the link");
    if (end == CycleEnd::link_lost) {
      const rt::Duration silence = seen_.ended - seen_.answers.back().state.arrival;
      // A damaged command may silence the robot for a while first: frames after that are not
      // answered at once.
      if (silence < 1s || (silence > kLongestSilence && !fault_.damages_commands))
        violation("lost the link at a wrong time");
    }
    if (end == CycleEnd::mode_lost && mode_held()) violation("lost a mode that held");
    if (end == CycleEnd::hung_up) violation("took the port for gone");
  }

  // In all the ticks in which the loss may have been seen and its cause sought: a damaged command
  // may have brought the mode back after it.
  bool mode_held() const {
    constexpr std::uint64_t kLook = kLatestBehindLongFrames + hal::ModeWatch::kSearchFrames;
    for (std::uint64_t back = 0; back <= kLook; ++back) {
      const TickSeen* const then = tick(seen_.last_tick - back);
      if (then != nullptr && then->mode != oi::Mode::safe) return false;
    }
    return true;
  }

  // A tick without a frame is a lost frame: the host cannot tell that the robot sent nothing.
  void judge_counters() {
    const std::uint64_t first = seen_.answers.front().tick;
    verdict_.due = seen_.last_tick - first + 1;
    for (std::uint64_t number = first; number <= seen_.last_tick; ++number) {
      if (!tick(number)->frame) ++verdict_.unsent;
    }
    // If the mode is lost, frames that may be late are not waited for; nor, at the end of a drive,
    // are those still in the robot's buffer, after answers to damaged commands.
    const bool waits = seen_.end != hal::CycleEnd::mode_lost && !seen_.backlog;
    // Some of those were given up, to be taken back if they come: judged by so late an arrival,
    // they may have been one tick too many.
    const std::uint64_t most = verdict_.due + (seen_.backlog ? 1 : 0);
    const std::uint64_t counted = sum(seen_.frames);
    if (counted > most || (waits && counted < verdict_.due)) {
      violation(std::to_string(verdict_.due) + " frames due, but " +
                std::to_string(seen_.frames.good) + " good, " + std::to_string(seen_.frames.bad) +
                " bad, " + std::to_string(seen_.frames.lost) + " lost");
    }
  }

  void judge_published(const AnswerSeen& answer) {
    bool mode_was = false;
    const std::uint64_t latest = fault_.damages_commands ? kLatestBehindLongFrames : kLatest;
    for (std::uint64_t late = 0; late <= latest; ++late) {
      const TickSeen* const then = tick(answer.tick - late);
      mode_was = mode_was || (then != nullptr && then->mode == answer.state.mode);
    }
    if (!mode_was) violation("published a mode that was not");
    if (answer.state.battery_mv != 0 && !battery_was(answer.state.battery_mv))
      violation("published a voltage that was not");
    const TickSeen* const now = tick(answer.tick);
    if (now == nullptr) return;
    const rt::WheelSpeeds& estimate = answer.state.estimate;
    const double error_mm_s = std::max(std::abs(estimate.left_mm_s - now->truth.left_mm_s),
                                       std::abs(estimate.right_mm_s - now->truth.right_mm_s));
    verdict_.worst_error_mm_s = std::max(verdict_.worst_error_mm_s, error_mm_s);
    if (!(error_mm_s <= fault_.most_error_mm_s)) {
      violation("published an estimate wrong by " + std::to_string(error_mm_s) + " mm/s");
    }
  }
  bool battery_was(std::int32_t battery_mv) const {
    return std::ranges::any_of(
        seen_.ticks, [battery_mv](const TickSeen& tick) { return tick.battery_mv == battery_mv; });
  }

  // The last answer is followed, in the same tick, by the stop that ends the cycle.
  void judge_commands(const std::vector<std::uint64_t>& ticks, const std::string& how) {
    for (std::size_t i = 1; i < ticks.size(); ++i) {
      if (ticks[i] != ticks[i - 1] || ticks[i] >= seen_.answers.back().tick) continue;
      violation("two commands " + how + " in tick " + std::to_string(ticks[i]));
    }
  }

  // By the end the robot has the command before the last.
  void judge_obedience() {
    const bool obeys = seen_.states.size() >= 2 &&
                       seen_.commanded == seen_.states[seen_.states.size() - 2].command;
    if (obeys) return;
    verdict_.deaf = fault_.may_silence;
    if (!verdict_.deaf) violation("did not obey at the end");
  }

  // In other cases the robot is in the middle of one of the loop's own commands.
  bool waits(const TickSeen& tick) const { return tick.waits && fault_.course == Course::either; }

  void judge_waiting() {
    verdict_.waited = static_cast<int>(
        std::ranges::count_if(seen_.ticks, [this](const TickSeen& tick) { return waits(tick); }));
    if (verdict_.waited > kMostWaited && !fault_.may_silence)
      violation("waited for " + std::to_string(verdict_.waited) + " ticks");
  }

  // The answers to the last frames may still be in flight.
  void count_disobedience() {
    int behind = 0;
    verdict_.obeys_after = 1;
    for (const TickSeen& tick : seen_.ticks) {
      if ((behind == 0 && !tick.clean) || waits(tick) || tick.tick + kLatest >= seen_.last_tick)
        continue;
      ++behind;
      if (!std::ranges::binary_search(seen_.obeyed, tick.tick)) verdict_.obeys_after = behind + 1;
    }
    if (verdict_.obeys_after > kMostBackAfter && !fault_.may_silence)
      violation("obeyed after " + std::to_string(verdict_.obeys_after) + " ticks");
  }

  // Recovered: from that frame on each one is answered in its tick, and counted one by one.
  void judge_recovery() {
    int clean = 0;
    verdict_.back_after = 1;
    for (const TickSeen& tick : seen_.ticks) {
      const bool excused = tick.waits && fault_.damages_commands;
      if (!tick.clean || excused || tick.tick >= seen_.last_tick) continue;
      ++clean;
      if (!answered(tick.tick)) verdict_.back_after = clean + 1;
    }
    if (clean < 50) violation("had no time to come back");
    if (verdict_.back_after > kMostBackAfter) {
      violation("was back after " + std::to_string(verdict_.back_after) + " frames");
    }
  }
  bool answered(std::uint64_t number) const {
    const auto answer = std::ranges::lower_bound(seen_.answers, number, {}, &AnswerSeen::tick);
    if (answer == seen_.answers.end() || answer->tick != number) return false;
    const AnswerSeen& last = seen_.answers.back();
    return last.frames.good - answer->frames.good == last.tick - number &&
           std::ranges::binary_search(seen_.written, number);
  }

  void judge_restart() {
    if (!seen_.restarted) return;
    if (!seen_.brought_up_again) return violation("was not brought up again");
    if (seen_.second_end != hal::CycleEnd::asked) violation("ended again");
    if (seen_.second_frames.good != kSecondFrames || sum(seen_.second_frames) != kSecondFrames)
      violation("lost frames when all was well again");
    if (std::abs(seen_.second_truth.left_mm_s - kSecondSpeed) > kDriven ||
        std::abs(seen_.second_truth.right_mm_s - kSecondSpeed) > kDriven) {
      violation("did not drive as it was asked when all was well again");
    }
  }

  void count_impostors() {
    const std::span<const std::uint8_t> bytes{seen_.received};
    for (std::size_t i = 0; fault_.damages_frames && i + oi::kMinFrameBytes <= bytes.size(); ++i) {
      const std::size_t size = bytes[i + 1] + oi::kFrameOverhead;
      if (bytes[i] != oi::kFrameHeader || i + size > bytes.size()) continue;
      const auto frame = bytes.subspan(i, size);
      if (!oi::is_well_formed(frame, oi::kCreate.item_sizes)) continue;
      if (!oi::checksum_matches(frame, oi::Checksum::including_header)) continue;
      if (std::ranges::search(seen_.sent, frame).empty()) ++verdict_.impostors;
    }
  }

  const FaultCase& fault_;
  const Observations& seen_;
  Verdict verdict_{};
};

}  // namespace

Verdict judge(const FaultCase& fault, const Observations& seen) {
  return Judge{fault, seen}.verdict();
}

}  // namespace cargobay::campaign
