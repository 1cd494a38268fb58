// What the cycle sends: Drive Direct, the next frame's list, one request from another thread, and
// the zeros that complete a command that was cut in two. Two drive commands never reach the robot
// in the same tick.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "hal/cycle/outgoing.hpp"
#include "hal/cycle/request.hpp"
#include "hal/cycle/tick_ledger.hpp"
#include "hal/guard/guard_mark.hpp"
#include "hal/sensing/frame_lists.hpp"
#include "hal/sensing/frame_rotation.hpp"
#include "hal/sensing/hearing_watch.hpp"
#include "hal/stream/byte_stream.hpp"
#include "oi/command_table.hpp"
#include "rt/clock.hpp"
#include "rt/nonblocking.hpp"
#include "rt/wheel_speeds.hpp"

namespace cargobay::hal {

// abandon() from any thread, everything else on the control thread. No allocation.
class CommandSender {
 public:
  enum class Sent : std::uint8_t {
    whole,
    not_whole,  // the drive command was not taken whole, or the robot has only its beginning
    withheld,
    failed,  // port_error() says why
  };
  // When a write happens, and under what circumstances.
  struct Moment {
    rt::TimePoint now{};
    rt::TimePoint woken{};     // when this pass of the cycle began
    bool frames_read = false;  // in this pass, from the same port
    oi::Mode mode = oi::Mode::off;
    bool set_stands = true;  // the wheels are asked only to stand still
  };
  // The most that the robot may still wait for of one of the loop's own commands if the line was
  // cut: all of a Drive Direct except its opcode, or all ids of a list.
  static constexpr std::size_t kLongestOwnRest =
      std::max(oi::kDriveDirectBytes - 1, oi::kMostListed);
  // Our own work takes microseconds; if it takes longer, the thread was kept from the processor.
  static constexpr rt::Duration kOwnWork = std::chrono::milliseconds{1};

  // `stream` must outlive it and keep its rate, and `dialect` too. After `request_lasts` a request
  // must have arrived.
  CommandSender(ByteStream& stream, const oi::Dialect& dialect, rt::Duration tick,
                rt::Duration request_lasts);

  void set_guard(const GuardMark& guard) { guard_ = guard; }
  GuardMark& guard() CARGOBAY_NONBLOCKING { return guard_; }
  // Nothing more is written. A write in progress still goes out.
  void abandon() CARGOBAY_NONBLOCKING { abandoned_.store(true); }

  // The list for the next tick's frame. `axes`: the counters that are meant; `search`: the list in
  // which to look for the cause of a lost mode. Call once a tick.
  FrameList next_list(FrameRotation::Counters counters, const rt::Axes& axes,
                      std::optional<FrameList> search) CARGOBAY_NONBLOCKING;
  FrameRotation& rotation() CARGOBAY_NONBLOCKING { return rotation_; }
  // What one of the ticks since the last frame may have carried a reading of. A frame that never
  // came is missed late, so it may have been of an older list.
  rt::Axes may_have_read(bool never_came) const CARGOBAY_NONBLOCKING {
    const int within = never_came ? rt::TickClock::kPatience + 1 : 1;
    return {.distance = ticks_since_distance_ <= within, .turn = ticks_since_turn_ <= within};
  }
  // The counters of which the present frame would end a window: the frames before did not read
  // them.
  rt::Axes ends_window() const CARGOBAY_NONBLOCKING {
    const rt::Axes now = axes_of(list_);
    const rt::Axes before = axes_of(former_list_);
    return {.distance = !now.distance || !before.distance, .turn = !now.turn || !before.turn};
  }

  // Signs of whether the robot hears: a good frame, a missing one, a line that was dead.
  void see(std::optional<FrameList> list) CARGOBAY_NONBLOCKING { hearing_.see(list); }
  void see_missing() CARGOBAY_NONBLOCKING { hearing_.missed(); }
  void doubt_hearing() CARGOBAY_NONBLOCKING { hearing_in_doubt_ = true; }

  // Whether a command sent now would arrive stale, after a long one, or might reach the robot in
  // the same tick as the last one.
  bool must_withhold(rt::TimePoint now, const TickLedger& ledger) const CARGOBAY_NONBLOCKING;
  // One write: the command and whatever else is due. `whole` means that this command was taken
  // whole.
  Sent drive(const rt::WheelSpeeds& command, FrameList list, const Moment& moment)
      CARGOBAY_NONBLOCKING;
  // The same without a command for the wheels, of which the robot obeys none now; with the mode, if
  // it should be sent.
  Sent keep(FrameList list, std::optional<oi::Mode> mode, const Moment& moment)
      CARGOBAY_NONBLOCKING;
  // What the robot was last told to stream.
  FrameList list() const CARGOBAY_NONBLOCKING { return list_; }
  // The last drive command that the robot received whole.
  const rt::WheelSpeeds& acting() const CARGOBAY_NONBLOCKING { return acting_; }

  // Whether a command of another thread waits for room.
  bool request_waits() const CARGOBAY_NONBLOCKING { return request_.has_value(); }
  void take_request(const Request& request) CARGOBAY_NONBLOCKING { request_ = request; }
  // How many bytes of a request go out besides the loop's own commands; for more, the loop pauses.
  std::size_t spare_bytes() const CARGOBAY_NONBLOCKING { return line_.spare_bytes; }
  // Bytes still missing of a command whose beginning the robot has received.
  std::size_t owed_bytes() const CARGOBAY_NONBLOCKING { return outgoing_.bytes().size(); }
  int port_error() const CARGOBAY_NONBLOCKING { return port_error_; }
  // The port hung up, with this errno; EBADF if the descriptor is no longer the port's.
  void note_hung_up(int error) CARGOBAY_NONBLOCKING;

 private:
  // What follows from the rate.
  struct Line {
    rt::Duration tick;
    rt::Duration way_around;  // what lies between port and robot may add, both ways together
    rt::Duration lead;        // of a command before its tick's frame: both of them on the wire
    rt::Duration byte_time;
    rt::Duration request_lasts;
    std::size_t spare_bytes;
    std::size_t most_fill;  // zeros that leave the command after them in its tick
  };
  static Line line_at(std::uint32_t baud, std::size_t frame_bytes, rt::Duration tick,
                      rt::Duration request_lasts);

  // As far as is known.
  bool hears() const CARGOBAY_NONBLOCKING {
    return !hearing_in_doubt_ && !hearing_.misheard() && !hearing_.deaf();
  }
  rt::Duration time_of(std::size_t bytes) const CARGOBAY_NONBLOCKING {
    return static_cast<std::int64_t>(bytes) * line_.byte_time;
  }
  bool tick_has_command(rt::TimePoint sent, const TickLedger& ledger) const CARGOBAY_NONBLOCKING;
  std::size_t fill(rt::TimePoint woken) const CARGOBAY_NONBLOCKING;
  std::size_t longest_rest(rt::TimePoint woken) const CARGOBAY_NONBLOCKING;
  void add_list(FrameList list) CARGOBAY_NONBLOCKING;
  void add_request(const Moment& moment) CARGOBAY_NONBLOCKING;
  Sent write_out(const Moment& moment) CARGOBAY_NONBLOCKING;

  ByteStream& stream_;
  const oi::Dialect& dialect_;
  Line line_;
  GuardMark guard_{};
  FrameRotation rotation_{};
  FrameList list_ = FrameList::reading;
  FrameList former_list_ = FrameList::reading;  // a frame of it may still be on its way
  int ticks_since_distance_ = 0;                // since one of the two read that counter
  int ticks_since_turn_ = 0;
  HearingWatch hearing_{FrameList::reading};
  bool hearing_in_doubt_ = false;  // the line has been dead since the last fill
  bool list_in_doubt_ = false;     // filled, and no list sent since
  rt::WheelSpeeds acting_{};
  rt::TimePoint last_command_{};
  rt::TimePoint line_free_{};     // after a long command
  rt::TimePoint last_request_{};  // when it was sent, and all of it but its opcode
  std::size_t last_request_rest_ = 0;
  int port_error_ = 0;
  std::atomic<bool> abandoned_{false};
  Outgoing outgoing_{dialect_};
  std::optional<Request> request_{};
};

}  // namespace cargobay::hal
