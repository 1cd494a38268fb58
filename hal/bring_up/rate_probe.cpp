#include "hal/bring_up/rate_probe.hpp"

#include <algorithm>
#include <array>
#include <chrono>

#include "hal/guard/farewell.hpp"
#include "oi/stream_budget.hpp"

namespace cargobay::hal {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kReplyTime{60};  // after the time on the wire
constexpr int kMostQuestions = 2;
constexpr int kAnswerFrames = 2;  // at one rate, before the robot counts as found there
constexpr auto kPassive = static_cast<std::uint8_t>(oi::Mode::passive);
constexpr auto kSearchList = oi::list_of<oi::PacketId, oi::kMaxStreamPackets>(
    oi::PacketId::oi_mode, oi::PacketId::charging_state, oi::PacketId::voltage);
// At a rate that cannot carry a stream, the robot is asked for this by Query List.
constexpr auto kAskedList = oi::list_of<oi::PacketId, oi::kMaxQueryPackets>(
    oi::PacketId::oi_mode, oi::PacketId::charging_state, oi::PacketId::oi_mode);
constexpr std::size_t kAskedBytes = 2 + 2 + 2 * kAskedList.size();  // Pause, Query List, the reply

}  // namespace

std::string at_baud(std::uint32_t baud) { return "at " + std::to_string(baud) + " baud"; }

const oi::StreamList& RateProbe::list_at(std::uint32_t baud) const {
  return baud == wanted_ ? packets_ : kSearchList;
}

bool RateProbe::answers(std::uint32_t baud) {
  set_port(baud);
  stream_.discard_input();
  tell_("Start", at_baud(baud));
  talk_.send(oi::Start{});
  talk_.pause(kModeChangeWait);
  const bool here = stirs(baud) && (oi::fits(list_at(baud), baud) ? streams(baud) : replies(baud));
  if (!here) note_silence(baud);
  return here;
}

// A robot at another rate reads other bytes than those sent, and commands in some of them: half a
// Script, a demo. It makes nothing of Start and this question, at any of its rates
// (tests/hal/bring_up/wrong_rate_test.cpp), so nothing else is sent until something answers.
bool RateProbe::stirs(std::uint32_t baud) {
  for (int i = 0; i < kMostQuestions; ++i) {
    talk_.send(oi::Sensors{oi::PacketId::wall});
    if (!talk_.reply(1, oi::wire_time(3, baud) + kReplyTime).empty()) return true;
  }
  return false;
}

bool RateProbe::streams(std::uint32_t baud) {
  tell_("Stream", at_baud(baud));
  talk_.send(oi::Stream{list_at(baud)});
  last_ = talk_.listen(list_at(baud), oi::Mode::passive, kAnswerFrames, kFrameTimeout);
  if (last_.battery_mv != 0) battery_mv_ = last_.battery_mv;
  return last_.in_mode >= kAnswerFrames;
}

bool RateProbe::replies(std::uint32_t baud) {
  tell_("Query List", at_baud(baud));
  talk_.send(oi::PauseResumeStream{oi::StreamState::pause});
  for (int i = 0; i < kAnswerFrames; ++i) {
    talk_.send(oi::QueryList{kAskedList});
    const std::vector<std::uint8_t> reply =
        talk_.reply(kAskedList.size(), oi::wire_time(kAskedBytes, baud) + kReplyTime);
    if (reply.size() < kAskedList.size() || reply.front() != kPassive || reply.back() != kPassive)
      return false;
  }
  return true;
}

bool RateProbe::answers_freed(std::uint32_t baud) {
  set_port(baud);
  tell_("resynchronise", at_baud(baud));
  talk_.resynchronise();
  if (talk_.over() || !answers(baud)) return false;
  freed_ = true;
  return true;
}

void RateProbe::set_port(std::uint32_t baud) {
  if (stream_.baud() == baud) return;
  (void)stream_.set_baud(baud);  // a port that cannot set it is silent at that rate
}

std::vector<std::uint32_t> RateProbe::rates_of_text(const oi::Dialect& dialect) const {
  std::vector<std::uint32_t> rates{dialect.default_baud, dialect.brc_baud};
  if (heard_noise()) rates.insert(rates.end(), kRatesOfOthers.begin(), kRatesOfOthers.end());
  return rates;
}

bool RateProbe::listen(std::uint32_t baud, rt::Duration duration) {
  set_port(baud);
  stream_.discard_input();
  tell_("listen", at_baud(baud));
  const bool goes_on = talk_.pause(duration);
  note_silence(baud);
  return goes_on;
}

void RateProbe::note_silence(std::uint32_t baud) {
  heard_.push_back({.baud = baud, .heard = talk_.heard()});
  talk_.forget();
}

bool RateProbe::heard_any(bool (Heard::*is)() const) const {
  return std::ranges::any_of(heard_, [is](const HeardAt& at) { return (at.heard.*is)(); });
}

bool RateProbe::heard_text() const { return heard_any(&Heard::is_text); }

bool RateProbe::heard_strangers_text() const {
  return heard_any(&Heard::is_strangers_text) && !heard_any(&Heard::is_robots_text);
}

bool RateProbe::heard_stranger() const {
  return heard_strangers_text() ||
         (heard_any(&Heard::is_echo) && !heard_any(&Heard::is_robots_text));
}

bool RateProbe::heard_noise() const {
  return !heard_text() && !heard_stranger() &&
         std::ranges::any_of(heard_, [](const HeardAt& at) { return at.heard.bytes > 0; });
}

}  // namespace cargobay::hal
