#include "hal/cycle/command_sender.hpp"

#include <algorithm>
#include <cerrno>
#include <span>

#include "hal/stream/spaced_stream.hpp"
#include "oi/dialect.hpp"
#include "oi/stream_budget.hpp"

namespace cargobay::hal {
namespace {

// The latency that adapter and kernel may add to a frame and its answer together: 2 ms of the
// robot's 15.
constexpr rt::Duration way_around(rt::Duration tick) { return tick * 2 / 15; }

// Time for each byte of a longer write.
rt::Duration time_of_byte(std::uint32_t baud) {
  return sending_time(2, baud) - sending_time(1, baud);
}

// Zeros that fit between a frame and the command that answers it in the same tick.
std::size_t most_fill(rt::Duration tick, std::uint32_t baud, std::size_t frame_bytes) {
  const rt::Duration room = tick - oi::wire_time(frame_bytes, baud) -
                            sending_time(oi::kDriveDirectBytes, baud) - way_around(tick);
  const rt::Duration least = std::max(room, rt::Duration::zero());
  const auto bytes = static_cast<std::size_t>(least / time_of_byte(baud));
  return std::clamp(bytes, CommandSender::kLongestOwnRest, Outgoing::kMostFill);
}

// Bytes that can go out besides the loop's longest commands, a drive and a list, before the next
// tick; no more than the backlog that the guard allows before its stop.
std::size_t spare_bytes(rt::Duration tick, std::uint32_t baud) {
  constexpr std::size_t kOwn = oi::kDriveDirectBytes + 2 + oi::kMostListed;
  constexpr std::size_t kMostSpare = kMostBacklog - kOwn;
  const rt::Duration room = tick - sending_time(kOwn, baud) - way_around(tick);
  const auto bytes = std::max(room, rt::Duration::zero()) / time_of_byte(baud);
  return std::min(static_cast<std::size_t>(bytes), kMostSpare);
}

}  // namespace

CommandSender::Line CommandSender::line_at(std::uint32_t baud, std::size_t frame_bytes,
                                           rt::Duration tick, rt::Duration request_lasts) {
  return {.tick = tick,
          .way_around = way_around(tick),
          .lead = oi::wire_time(frame_bytes, baud) + sending_time(oi::kDriveDirectBytes, baud),
          .byte_time = time_of_byte(baud),
          .request_lasts = request_lasts,
          .spare_bytes = hal::spare_bytes(tick, baud),
          .most_fill = hal::most_fill(tick, baud, frame_bytes)};
}

CommandSender::CommandSender(ByteStream& stream, const oi::Dialect& dialect, rt::Duration tick,
                             rt::Duration request_lasts)
    : stream_{stream},
      dialect_{dialect},
      line_{line_at(stream.baud(), dialect.frame_bytes, tick, request_lasts)} {}

FrameList CommandSender::next_list(FrameRotation::Counters counters, const rt::Axes& axes,
                                   std::optional<FrameList> search) CARGOBAY_NONBLOCKING {
  FrameList next = search ? *search : rotation_.next(counters, axes);
  if (hearing_.deaf() && !search) next = hearing_.probe();
  former_list_ = list_;
  const rt::Axes now = axes_of(next);
  const rt::Axes before = axes_of(former_list_);
  ticks_since_distance_ = now.distance || before.distance ? 0 : ticks_since_distance_ + 1;
  ticks_since_turn_ = now.turn || before.turn ? 0 : ticks_since_turn_ + 1;
  return next;
}

bool CommandSender::must_withhold(rt::TimePoint now, const TickLedger& ledger) const
    CARGOBAY_NONBLOCKING {
  // After a long command, the next would arrive stale.
  if (line_free_ - now > line_.way_around) return true;
  const rt::TimePoint reaches = std::max(now, line_free_) + time_of(fill(ledger.last_arrival()));
  return tick_has_command(reaches, ledger);
}

// Whether the robot may get a command sent at `sent` in the same tick as the last one: a frame that
// was very late has been answered in the tick of the next. Unless this frame is certainly on time,
// commands are kept nearly a tick apart in any case: if all frames are late, the phase does not
// show.
bool CommandSender::tick_has_command(rt::TimePoint sent, const TickLedger& ledger) const
    CARGOBAY_NONBLOCKING {
  if (!ledger.on_time(line_.way_around) && sent - last_command_ < line_.tick - line_.way_around)
    return true;
  if (!ledger.clock().in_phase()) return false;
  // A command reaches the robot in a new tick if it is sent at least the lead before that tick's
  // frame.
  const rt::TimePoint tick_began = ledger.clock().due_by(sent + line_.lead) - line_.lead;
  return last_command_ > tick_began - line_.way_around;
}

CommandSender::Sent CommandSender::drive(const rt::WheelSpeeds& command, FrameList list,
                                         const Moment& moment) CARGOBAY_NONBLOCKING {
  const std::size_t zeros = fill(moment.woken);
  last_command_ = moment.now + time_of(zeros);
  // The rest of a drive command counts as one: another after it would be the second in this tick. A
  // stop does not wait for the next tick.
  const bool only_rest = outgoing_.drives() && command != rt::WheelSpeeds{};
  if (!only_rest) {
    outgoing_.add_fill(zeros);
    outgoing_.add_drive(command);
    add_list(list);
    add_request(moment);
  }
  const Sent sent = write_out(moment);
  return only_rest && sent == Sent::whole ? Sent::withheld : sent;
}

CommandSender::Sent CommandSender::keep(FrameList list, std::optional<oi::Mode> mode,
                                        const Moment& moment) CARGOBAY_NONBLOCKING {
  acting_ = {};
  if (mode) outgoing_.add_mode(*mode);
  outgoing_.add_fill(fill(moment.woken));
  add_list(list);
  add_request(moment);
  return write_out(moment);
}

// If the line was dead for a while, a command may have been cut in two, and the robot takes the
// next one for its rest: so zeros come first, which are harmless as data and nothing as opcodes.
// What they complete may be a list, which is why the list follows. A robot that does not stream
// what it was told to gets as many zeros as there is room for: a command that it misread may want
// hundreds.
std::size_t CommandSender::fill(rt::TimePoint woken) const CARGOBAY_NONBLOCKING {
  // The rest of a command comes before anything else, and completes it.
  if (!outgoing_.empty()) return 0;
  if (hearing_.deaf()) return line_.most_fill;
  return hearing_in_doubt_ || hearing_.misheard() ? longest_rest(woken) : 0;
}

// The longest rest of the commands whose beginning the robot may have received before the line was
// cut. A request is one of them until it must have arrived.
std::size_t CommandSender::longest_rest(rt::TimePoint woken) const CARGOBAY_NONBLOCKING {
  const bool lately = woken - last_request_ < line_.request_lasts;
  const std::size_t rest = lately ? std::max(kLongestOwnRest, last_request_rest_) : kLongestOwnRest;
  return std::min(rest, Outgoing::kMostFill);
}

void CommandSender::add_list(FrameList list) CARGOBAY_NONBLOCKING {
  const bool again = list_in_doubt_ || !hears();
  if (list != list_ || again) outgoing_.add_list(list);
}

// If the robot hears, its mode allows it, and there is room: one command per frame.
void CommandSender::add_request(const Moment& moment) CARGOBAY_NONBLOCKING {
  if (!request_) return;
  const std::span<const std::uint8_t> bytes = request_->command();
  const oi::CommandInfo* info = bytes.empty() ? nullptr : dialect_.find_command(bytes[0]);
  if (info == nullptr || !info->available_in(moment.mode)) {
    request_.reset();  // the mode was lost after it was requested
    return;
  }
  const rt::TimePoint now = stream_.now();
  if (!hears() || line_free_ > now) return;
  const bool stands = acting_ == rt::WheelSpeeds{} && moment.set_stands;
  const bool is_long = bytes.size() > line_.spare_bytes;
  if (is_long && !stands && request_->when_long == Request::WhenLong::wait) return;
  outgoing_.add_request(bytes);
  if (is_long) line_free_ = now + time_of(outgoing_.bytes().size());
  last_request_ = now;
  last_request_rest_ = bytes.size() - 1;
}

// Writes what is outgoing to the port, in one write. There is no need to check that it still is the
// port if a whole frame, checksum and all, was just read from the same descriptor: nothing else
// sends those.
CommandSender::Sent CommandSender::write_out(const Moment& moment) CARGOBAY_NONBLOCKING {
  if (outgoing_.empty()) return Sent::whole;
  const bool proven = moment.frames_read && moment.now - moment.woken <= kOwnWork;
  if (!proven && !stream_.still_open()) return Sent::failed;
  // The owner has given up this thread and said farewell to the robot in its place.
  if (abandoned_.load()) return Sent::withheld;
  // The next pass ends the cycle.
  if (!guard_.begin_write(outgoing_.bytes().size())) return Sent::withheld;
  const ByteStream::Transfer transfer = stream_.write(outgoing_.bytes());
  if (transfer.error != 0 && transfer.error != EAGAIN) {
    port_error_ = transfer.error;
    return Sent::failed;
  }
  const Outgoing::Taken taken = outgoing_.took(transfer.count);
  if (outgoing_.empty()) guard_.end_write();
  if (taken.fill) {
    hearing_in_doubt_ = false;
    list_in_doubt_ = true;
  }
  if (taken.request) request_.reset();
  if (taken.list) {
    list_ = taken.streamed;
    list_in_doubt_ = false;
    hearing_.told(list_);
  }
  if (taken.drive) acting_ = taken.speeds;
  return taken.missed_drive ? Sent::not_whole : Sent::whole;
}

void CommandSender::note_hung_up(int error) CARGOBAY_NONBLOCKING {
  port_error_ = stream_.still_open() ? error : EBADF;
}

}  // namespace cargobay::hal
