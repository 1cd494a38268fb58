#include "hal/cycle/tick_ledger.hpp"

#include <algorithm>
#include <utility>

namespace cargobay::hal {
namespace {

constexpr std::size_t kNoiseBytes = 2;  // noise shortens or lengthens a frame by so many

}  // namespace

TickLedger::Account TickLedger::book(const Arrival& arrival) CARGOBAY_NONBLOCKING {
  Account account;
  counters_.good += static_cast<std::uint64_t>(arrival.frames);
  const std::uint64_t damaged = newly_damaged(arrival, account);
  if (!clock_.started()) {
    late_ = arrival.frames > 1;  // they had been waiting, and more may be
    clock_.start(arrival.time);  // the damage was to whatever was in flight when we began to listen
  } else {
    damaged_ += damaged;
    settle(arrival, account);
    // Of several together, all but the last are at least a tick late.
    late_ = arrival.frames > 1 || arrival.time - clock_.due_by(arrival.time) > late_margin_;
  }
  frames_ = arrival.frames;
  last_arrival_ = arrival.time;
  bytes_ = arrival.bytes.bytes;
  return account;
}

// The ticks since the last arrival: their frames have arrived, are bad, lost or still to come.
void TickLedger::settle(const Arrival& arrival, Account& account) CARGOBAY_NONBLOCKING {
  const std::int64_t before = clock_.ticks() + clock_.missing();
  account.lost = clock_.arrived(arrival.time, arrival.frames, damaged_);
  const std::int64_t passed = clock_.ticks() + clock_.missing() - before;
  const std::uint64_t bytes = arrival.bytes.bytes - bytes_;
  account.bytes_missing = bytes < static_cast<std::uint64_t>(passed) * frame_bytes_;
  account.incomplete = account.lost > 0 || clock_.missing() > 0;

  const int given_up = std::max(account.lost, 0);
  const std::uint64_t bad = std::min(damaged_, static_cast<std::uint64_t>(given_up));
  const std::uint64_t never_came = static_cast<std::uint64_t>(given_up) - bad;
  account.never_came = never_came > 0;
  counters_.bad += bad;
  counters_.lost += never_came;
  if (account.lost < 0) take_back(static_cast<std::uint64_t>(-account.lost));
  account.to_step = std::max(account.lost - foreseen_, 0);
  foreseen_ -= given_up - account.to_step;
  // Frames that were foreseen but are not lost have arrived.
  if (!clock_.in_doubt()) account.stepped_early = std::exchange(foreseen_, 0);
  // One frame may be damaged in several places, and noise between two frames damages none.
  damaged_ = clock_.missing() == 0 ? 0 : damaged_ - bad;
}

// Bad frames seen since the last good one. A frame whose header is damaged shows only by its bytes,
// as long as these are no more than the missing frames have: a robot sends other things too, and if
// it was not asked to, it may have misheard a command.
std::uint64_t TickLedger::newly_damaged(const Arrival& arrival, Account& account)
    CARGOBAY_NONBLOCKING {
  const std::uint64_t skipped =
      arrival.bytes.skipped - std::exchange(skipped_, arrival.bytes.skipped);
  if (skipped == 0) return arrival.corrupt;
  const auto ticks = static_cast<std::uint64_t>((arrival.time - last_arrival_) / tick_);
  account.says_more = skipped > ticks * (frame_bytes_ + kNoiseBytes);
  return account.says_more
             ? arrival.corrupt
             : std::max<std::uint64_t>(arrival.corrupt, skipped / (frame_bytes_ - kNoiseBytes));
}

// Frames that were given up have arrived. For those counted as bad, what looked like their remains
// was noise.
void TickLedger::take_back(std::uint64_t frames) CARGOBAY_NONBLOCKING {
  const std::uint64_t lost = std::min(frames, counters_.lost);
  counters_.lost -= lost;
  counters_.bad -= frames - lost;
}

// Ticks of the robot since the last frame. Call after a deadline has passed.
std::int64_t TickLedger::silent_ticks(rt::TimePoint now) const CARGOBAY_NONBLOCKING {
  return (now - clock_.expected()) / tick_ + 1;
}

int TickLedger::foresee(rt::TimePoint now) CARGOBAY_NONBLOCKING {
  if (clock_.started()) foreseen_ = static_cast<int>(silent_ticks(now));
  return foreseen_;
}

void TickLedger::close(rt::TimePoint now) CARGOBAY_NONBLOCKING {
  if (!clock_.started()) return;
  const auto due = static_cast<std::uint64_t>(clock_.missing() + silent_ticks(now));
  const std::uint64_t bad = std::min(damaged_, due);
  counters_.bad += bad;
  counters_.lost += due - bad;
}

}  // namespace cargobay::hal
