#include "hal/bring_up/bring_up.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "gpio/pulse_train.hpp"
#include "hal/bring_up/bring_up_failure.hpp"
#include "hal/bring_up/dialogue.hpp"
#include "hal/bring_up/rate_probe.hpp"
#include "hal/guard/farewell.hpp"
#include "hal/port/port_users.hpp"
#include "oi/commands.hpp"
#include "oi/limits.hpp"
#include "oi/stream_budget.hpp"

namespace cargobay::hal {
namespace {

using gpio::Level;
using std::chrono::milliseconds;

constexpr milliseconds kModeTimeout{800};
constexpr milliseconds kBootTime{3500};  // from the toggle until the robot listens
constexpr milliseconds kBootMargin{2500};
constexpr milliseconds kIndicatorTimeout{1000};
constexpr milliseconds kSendTimeout{1000};
constexpr int kGoodFrames = 3;   // in the wanted mode, before the mode is believed
constexpr int kMostToggles = 2;  // the first may have switched off a robot that was on and deaf
constexpr int kMostTries = 2;    // of pulses, of Baud commands, of mode commands
constexpr std::uint32_t kLeastFreedRate = 2400;  // frees a robot in two seconds
constexpr std::size_t kChangeBytes = 5;          // Start, Pause Stream, Baud

std::string milliseconds_text(std::chrono::nanoseconds time) {
  return std::to_string(std::chrono::duration_cast<milliseconds>(time).count()) + " ms";
}

bool widths_good(const gpio::PlayReport& report) {
  return report.complete() && std::ranges::all_of(report.pulses(), [](const auto& pulse) {
           return pulse.lasted >= gpio::kBrcLeastWidth && pulse.lasted <= gpio::kBrcMostWidth;
         });
}

class BringUp {
 public:
  BringUp(ByteStream& stream, const BringUpRequest& request)
      : stream_{stream},
        request_{request},
        pins_{request.pins, stream},
        talk_{stream, request.cancelled, *request.dialect},
        wanted_{stream.baud()},
        began_{stream.now()},
        powered_at_{began_},
        probe_{stream, talk_, request.packets,
               [this](std::string_view step, const std::string& detail) { tell(step, detail); }} {}

  Result<BringUpReport> run();

 private:
  enum class Step : std::uint8_t {
    check_power,
    power_on,
    greet,           // at the wanted rate
    pulse,           // on the BRC pin
    search,          // at the other rates, the likely ones first
    search_deeper,   // at the likely rates, freeing it from a half-sent command
    listen,          // for a robot that boots, or prints that it is off or charging
    search_deepest,  // at the other rates, freeing it there too
    change_rate,     // by the Baud command
    take_mode,
    done,
    failed,
  };

  // Each step returns the next.
  Step take(Step step);
  Step check_power();
  Step power_on();
  Step greet();
  Step pulse();
  Step search();
  Step search_deeper();
  Step listen();
  Step search_deepest();
  Step change_rate();
  Step take_mode();

  // How to get from the rate at which it was found to the wanted one.
  Step from(std::uint32_t baud);
  Step give_up(BringUpTrouble trouble) {
    trouble_ = trouble;
    return Step::failed;
  }
  // What is sent comes back also from a line that nothing drives, as that of a robot that is off.
  Step no_robot() {
    const bool may_be_off = toggle_left() && !probe_.heard_strangers_text();
    return may_be_off ? Step::power_on : give_up(BringUpTrouble::silent);
  }
  bool pulses_wanted() const {
    return pins_.has_brc() && wanted_ == request_.dialect->brc_baud && pulse_tries_ < kMostTries;
  }
  bool toggle_left() const {
    // A robot that is on would be switched off.
    return pins_.has_power_toggle() && toggles_ < kMostToggles && known_on_ != true;
  }
  bool verify_pulsed();

  void tell(std::string_view step, std::string detail = "") {
    step_ = step;
    if (request_.progress)
      request_.progress(
          {.time = stream_.now() - began_, .step = step_, .detail = std::move(detail)});
  }
  Failure failure();

  ByteStream& stream_;
  const BringUpRequest& request_;
  BoundPins pins_;
  Dialogue talk_;
  std::uint32_t wanted_;
  rt::TimePoint began_;
  rt::TimePoint powered_at_;  // if unknown: the beginning, the latest that it can be
  std::optional<bool> known_on_{};
  int toggles_ = 0;
  int pulse_tries_ = 0;
  int rate_tries_ = 0;
  bool searched_ = false;
  bool listened_ = false;
  std::string step_{};
  BringUpTrouble trouble_ = BringUpTrouble::silent;
  std::error_code pin_error_{};
  FramesHeard last_{};  // in the mode that was asked for
  BringUpReport report_{};
  RateProbe probe_;
};

BringUp::Step BringUp::take(Step step) {
  if (talk_.over()) return Step::failed;
  switch (step) {
    case Step::check_power: return check_power();
    case Step::power_on: return power_on();
    case Step::greet: return greet();
    case Step::pulse: return pulse();
    case Step::search: return search();
    case Step::search_deeper: return search_deeper();
    case Step::listen: return listen();
    case Step::search_deepest: return search_deepest();
    case Step::change_rate: return change_rate();
    case Step::take_mode: return take_mode();
    case Step::done:
    case Step::failed: break;
  }
  return step;
}

// Terminates: each way back to an earlier step is counted and limited.
Result<BringUpReport> BringUp::run() {
  stream_.discard_input();
  if (const std::error_code error = pins_.release())
    return explain(
        {.trouble = BringUpTrouble::pin_failed, .pin_error = error, .pins_of_port = true});
  Step step = Step::check_power;
  while (step != Step::done && step != Step::failed) step = take(step);
  if (step == Step::failed || talk_.over()) return failure();
  report_.took = stream_.now() - began_;
  report_.resynchronised = report_.resynchronised || probe_.freed();
  if (report_.battery_mv == 0) report_.battery_mv = probe_.battery_mv();
  return report_;
}

BringUp::Step BringUp::check_power() {
  const std::optional<Level> level = pins_.power_sense();
  if (!level) return Step::greet;
  known_on_ = *level == Level::high;
  tell("power", *known_on_ ? "on" : "off");
  if (*known_on_) return Step::greet;
  return toggle_left() ? Step::power_on : give_up(BringUpTrouble::switched_off);
}

BringUp::Step BringUp::power_on() {
  ++toggles_;
  tell("power on", "toggle: low, high, low");
  const gpio::PlayReport played =
      gpio::play(gpio::power_toggle(), *pins_.power_toggle(), talk_, Level::low);
  powered_at_ = stream_.now();
  pin_error_ = played.line_error;
  if (pin_error_) return give_up(BringUpTrouble::pin_failed);
  if (pins_.has_power_sense()) {
    const rt::TimePoint limit = stream_.now() + kIndicatorTimeout;
    while (pins_.power_sense() != Level::high && stream_.now() < limit) {
      if (!talk_.pause(milliseconds{10})) return Step::failed;
    }
    known_on_ = pins_.power_sense() == Level::high;
    if (!*known_on_) return toggle_left() ? Step::power_on : give_up(BringUpTrouble::stays_off);
  }
  report_.powered_on = true;
  searched_ = false;
  pulse_tries_ = 0;
  if (pulses_wanted()) return Step::pulse;
  tell("boot", "until it listens, " + milliseconds_text(kBootTime));
  if (!talk_.wait_until(powered_at_ + kBootTime)) return Step::failed;
  talk_.forget();  // what it prints while it boots
  return Step::greet;
}

BringUp::Step BringUp::greet() {
  // A robot that has just been switched on may take its time.
  const rt::TimePoint limit = toggles_ > 0 ? powered_at_ + kBootTime + kBootMargin : stream_.now();
  do {
    if (probe_.answers(wanted_)) return from(wanted_);
  } while (!talk_.over() && stream_.now() < limit);
  // If the robot may be off, pulses would go unnoticed.
  return pulses_wanted() && !toggle_left() ? Step::pulse : Step::search;
}

BringUp::Step BringUp::pulse() {
  ++pulse_tries_;
  probe_.set_port(wanted_);
  const rt::TimePoint ready = powered_at_ + gpio::kBrcWaitAfterPowerOn;
  if (stream_.now() < ready) {
    tell("BRC wait", "until 2 s after power-on");
    if (!talk_.wait_until(ready)) return Step::failed;
  }
  tell("BRC pulses", "three of " + milliseconds_text(gpio::kBrcWidth));
  const auto train = gpio::brc_pulses();
  if (!train) return give_up(BringUpTrouble::pin_failed);
  report_.brc = gpio::play(*train, *pins_.brc(), talk_, Level::high);
  pin_error_ = report_.brc.line_error;
  if (pin_error_) return give_up(BringUpTrouble::pin_failed);
  talk_.forget();
  if (widths_good(report_.brc) && verify_pulsed()) {
    report_.rate_change = RateChange::brc;
    return from(wanted_);
  }
  if (talk_.over()) return Step::failed;
  if (pulses_wanted()) return Step::pulse;
  return searched_ && report_.found_baud != 0 ? from(report_.found_baud) : Step::search;
}

// While booting, the robot is deaf for a while after the pulses.
bool BringUp::verify_pulsed() {
  const rt::TimePoint limit = std::max<rt::TimePoint>(
      powered_at_ + (toggles_ > 0 ? kBootTime + kBootMargin : milliseconds{0}),
      stream_.now() + 2 * kFrameTimeout);
  while (!talk_.over() && stream_.now() < limit) {
    if (probe_.answers(wanted_)) return true;
  }
  return !talk_.over() && probe_.answers_freed(wanted_);
}

BringUp::Step BringUp::from(std::uint32_t baud) {
  if (report_.found_baud == 0) report_.found_baud = baud;
  if (baud == wanted_) return Step::take_mode;
  if (pulses_wanted()) return Step::pulse;
  report_.found_baud = baud;
  return Step::change_rate;
}

BringUp::Step BringUp::search() {
  searched_ = true;
  for (const std::uint32_t baud : request_.dialect->likely_rates) {
    if (baud != wanted_ && probe_.answers(baud)) return from(baud);
    if (talk_.over()) return Step::failed;
  }
  if (probe_.heard_stranger()) return no_robot();
  // Before freeing, which sends hundreds of bytes to a robot at another rate.
  for (const std::uint32_t baud : request_.dialect->baud_rates) {
    if (request_.dialect->is_likely(baud)) continue;
    // In vain: it boots or charges, or was searched for before.
    if (probe_.heard_text() || listened_ || talk_.over()) break;
    if (baud != wanted_ && probe_.answers(baud)) return from(baud);
  }
  return probe_.heard_stranger() ? no_robot() : Step::search_deeper;
}

BringUp::Step BringUp::search_deeper() {
  std::vector<std::uint32_t> rates{wanted_};
  for (const std::uint32_t baud : request_.dialect->likely_rates) {
    if (baud != wanted_) rates.push_back(baud);
  }
  for (const std::uint32_t baud : rates) {
    if (probe_.answers_freed(baud)) return from(baud);
    if (talk_.over()) return Step::failed;
  }
  probe_.set_port(wanted_);
  return listened_ ? Step::search_deepest : Step::listen;
}

// Last, because few robots are at these rates, and not where freeing takes too many seconds.
// Slowest first: zeros that come more slowly than the robot listens mean nothing to it.
BringUp::Step BringUp::search_deepest() {
  if (toggle_left()) return Step::power_on;
  for (const std::uint32_t baud : request_.dialect->baud_rates) {
    if (request_.dialect->is_likely(baud)) continue;
    if (probe_.heard_text() || talk_.over()) break;
    if (baud != wanted_ && baud >= kLeastFreedRate && probe_.answers_freed(baud)) return from(baud);
  }
  probe_.set_port(wanted_);
  return give_up(BringUpTrouble::silent);
}

BringUp::Step BringUp::listen() {
  listened_ = true;
  for (const std::uint32_t baud : probe_.rates_of_text(*request_.dialect)) {
    if (!probe_.listen(baud, kTimeOfALine)) return Step::failed;
  }
  return Step::greet;
}

BringUp::Step BringUp::change_rate() {
  ++rate_tries_;
  const std::uint32_t former = report_.found_baud;
  probe_.set_port(former);
  tell("Baud", std::to_string(former) + " to " + std::to_string(wanted_));
  talk_.send(oi::Start{});
  talk_.pause(kModeChangeWait);
  talk_.send(oi::PauseResumeStream{oi::StreamState::pause});
  talk_.send(oi::Baud{
      request_.dialect->baud_code(wanted_).value_or(0)});  // one of the robot's: checked before
  // A command that did not leave is not obeyed; the probe will show it.
  (void)stream_.drain(kSendTimeout + oi::wire_time(kChangeBytes, former));
  probe_.set_port(wanted_);
  if (!talk_.pause(oi::kBaudChangeWait + kModeChangeWait)) return Step::failed;
  if (probe_.answers(wanted_) || probe_.answers_freed(wanted_)) {
    report_.rate_change = RateChange::command;
    return Step::take_mode;
  }
  if (talk_.over()) return Step::failed;
  return rate_tries_ < kMostTries ? Step::change_rate : give_up(BringUpTrouble::keeps_its_rate);
}

BringUp::Step BringUp::take_mode() {
  for (int i = 0; i < kMostTries && !talk_.over(); ++i) {
    if (i > 0) {
      // A robot that already streams may hear no command: it takes what comes for data.
      tell("resynchronise", at_baud(wanted_));
      talk_.resynchronise();
      report_.resynchronised = true;
    }
    if (request_.mode == oi::Mode::safe) {
      tell("Safe");
      talk_.send(oi::Safe{});
    } else if (request_.mode == oi::Mode::full) {
      tell("Full");
      talk_.send(oi::Full{});
    } else {
      tell("Passive");
    }
    last_ = talk_.listen(request_.packets, request_.mode, kGoodFrames, kModeTimeout);
    if (last_.in_mode < kGoodFrames) continue;
    report_.mode = last_.mode;
    if (last_.battery_mv != 0) report_.battery_mv = last_.battery_mv;
    return Step::done;
  }
  return give_up(last_.frames > 0 ? BringUpTrouble::wrong_mode : BringUpTrouble::stream_ended);
}

Failure BringUp::failure() {
  if (talk_.hung_up()) trouble_ = BringUpTrouble::hung_up;
  if (talk_.cancelled()) trouble_ = BringUpTrouble::cancelled;
  BringUpFailure why{.dialect = request_.dialect,
                     .trouble = trouble_,
                     .step = step_,
                     .wanted_baud = wanted_,
                     .found_baud = report_.found_baud,
                     .heard = probe_.heard(),
                     .wanted_mode = request_.mode,
                     .mode = last_.mode,
                     .charging = pins_.charging() == Level::high,
                     .pulses_played = report_.brc.count > 0,
                     .toggled = toggles_ > 0,
                     .pin_error = pin_error_,
                     .pins_of_port = request_.pins.any_of_port()};
  const bool heard = report_.found_baud != 0;
  if (!heard) probe_.set_port(wanted_);  // the rate that was tried last may be slow
  if (trouble_ == BringUpTrouble::keeps_its_rate) probe_.set_port(report_.found_baud);
  why.others = others_at(stream_.terminal().descriptor);
  // One that never answered has been told nothing that moves it: it is as it was found.
  const bool as_found = !heard && trouble_ == BringUpTrouble::cancelled;
  Parting left = as_found ? Parting::standing : farewell(stream_);
  if (!heard && probe_.heard_strangers_text()) left = Parting::standing;  // not a robot
  if (request_.left != nullptr) *request_.left = left;
  probe_.set_port(wanted_);
  return explain(why);
}

}  // namespace

Result<BringUpReport> bring_up(ByteStream& stream, const BringUpRequest& request) {
  if (request.left != nullptr) *request.left = Parting::standing;  // as found: nothing sent yet
  if (!oi::fits(request.packets, stream.baud(), *request.dialect)) {
    return too_long(request.packets, stream.baud(), *request.dialect);
  }
  return BringUp{stream, request}.run();
}

}  // namespace cargobay::hal
