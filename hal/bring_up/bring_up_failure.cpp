#include "hal/bring_up/bring_up_failure.hpp"

#include <algorithm>

#include "hal/trouble.hpp"
#include "oi/dialect.hpp"
#include "oi/stream_budget.hpp"
#include "oi/value_names.hpp"

namespace cargobay::hal {
namespace {

// The rates in the order in which they were tried, each once: "57600, 19200 and 115200 baud"; or
// all.
std::string rates(const BringUpFailure& why) {
  std::vector<std::uint32_t> tried;
  for (const HeardAt& at : why.heard) {
    if (std::ranges::find(tried, at.baud) == tried.end()) tried.push_back(at.baud);
  }
  if (tried.size() == why.dialect->baud_rates.size()) return "all its rates";
  std::string text;
  for (std::size_t i = 0; i < tried.size(); ++i) {
    if (i > 0) text += i + 1 == tried.size() ? " and " : ", ";
    text += std::to_string(tried[i]);
  }
  return text + " baud";
}

// What was tried besides the rates.
std::string tried(const BringUpFailure& why) {
  std::string text;
  if (why.toggled) text += ", after the power toggle";
  if (why.pulses_played) text += ", after the BRC pulses";
  return text;
}

std::string quoted(std::uint32_t baud, std::string line) {
  while (line.ends_with(' ')) line.pop_back();
  return " at " + std::to_string(baud) + " baud (" + line + ")";
}

// The first for which `is` holds; null if there is none.
const HeardAt* first(const BringUpFailure& why, bool (Heard::*is)() const) {
  const auto at =
      std::ranges::find_if(why.heard, [is](const HeardAt& each) { return (each.heard.*is)(); });
  return at == why.heard.end() ? nullptr : &*at;
}

}  // namespace

std::string what_sends(const BringUpFailure& why) {
  if (const HeardAt* const robot = first(why, &Heard::is_robots_text)) {
    return "the robot sends text" + quoted(robot->baud, robot->heard.known_line) +
           " and answers nothing" + tried(why) +
           ": it is charging or switched off; press its power button, and unplug the charger to "
           "drive";
  }
  if (const HeardAt* const other = first(why, &Heard::is_strangers_text)) {
    return std::string{describe(other->heard.source)} + " is at this port and no robot: it sends" +
           quoted(other->baud, other->heard.known_line) +
           "; find the robot's port with: cargobay ports, or plug its cable in here";
  }
  if (const HeardAt* const echo = first(why, &Heard::is_echo)) {
    return "what is sent at " + std::to_string(echo->baud) +
           " baud comes back, and no robot answers: TX and RX are connected to each other, by a "
           "loopback plug or a short circuit, or a device that echoes is there; connect them to "
           "the robot";
  }
  if (const HeardAt* const text = first(why, &Heard::is_text)) {
    return "something sends text" + quoted(text->baud, text->heard.last_line) +
           " that is not the robot's, and answers nothing" + tried(why) +
           "; find the robot's port with: cargobay ports, or plug its cable in here";
  }
  return "";
}

namespace {

std::string no_answer(const BringUpFailure& why) {
  const auto& heard = why.heard;
  if (std::string sender = what_sends(why); !sender.empty()) return sender;
  if (why.charging) {
    return "the robot is silent at " + rates(why) + tried(why) +
           ", and charging according to its pin 13; press its power button, and check TX and RX";
  }
  const auto noise =
      std::ranges::max_element(heard, {}, [](const HeardAt& at) { return at.heard.bytes; });
  if (noise != heard.end() && noise->heard.bytes > 0) {
    return "heard " + std::to_string(noise->heard.bytes) + " bytes at " +
           std::to_string(noise->baud) + " baud but no whole frame at " + rates(why) + tried(why) +
           "; check ground, level shifter and that no console uses the port; or switch the robot "
           "off and on";
  }
  return "the robot is silent at " + rates(why) + tried(why) +
         "; is it switched on, its battery charged, and are TX and RX the right way round, behind "
         "a level shifter? A robot waiting in a script is deaf: switch it off and on";
}

std::string no_port_pin(std::error_code error) {
  return "RTS or DTR of the port cannot be set (" + error.message() +
         "): a pseudo-terminal has none, and some adapters lead neither out; use one that does, or "
         "wire the pin to a GPIO line";
}

std::string text(const BringUpFailure& why) {
  switch (why.trouble) {
    case BringUpTrouble::silent: return no_answer(why);
    case BringUpTrouble::switched_off:
      return "the robot is switched off: its power indicator is low; press its power button, or "
             "name the line of its power toggle (pin 3)";
    case BringUpTrouble::stays_off:
      return "the power toggle did not switch the robot on: its power indicator stays low; check "
             "the wiring of pins 3 and 8, their polarity, and the battery";
    case BringUpTrouble::pin_failed:
      if (why.pins_of_port) return no_port_pin(why.pin_error);
      return "the GPIO line cannot be set: " + why.pin_error.message() +
             "; is its chip still there?";
    case BringUpTrouble::keeps_its_rate:
      return "the robot answers at " + std::to_string(why.found_baud) + " baud but not at " +
             std::to_string(why.wanted_baud) + tried(why) +
             " and the Baud command; check BRC transistor and polarity, or use --baud " +
             std::to_string(why.found_baud);
    case BringUpTrouble::wrong_mode:
      return "the robot streams, but stays in " + std::string{oi::name(why.mode)} +
             " mode instead of " + std::string{oi::name(why.wanted_mode)} +
             "; set it on its wheels, away from edges, and unplug the charger";
    case BringUpTrouble::stream_ended:
      return "the robot answered at " + std::to_string(why.found_baud) +
             " baud and then fell silent; check the cable and the battery, then start again";
    case BringUpTrouble::hung_up:
      return "the port hung up during bring-up; check the cable and that the robot's end is "
             "running";
    case BringUpTrouble::cancelled: return "interrupted";
  }
  return "";
}

Trouble code_of(BringUpTrouble trouble) {
  switch (trouble) {
    case BringUpTrouble::pin_failed: return Trouble::pin;
    case BringUpTrouble::hung_up: return Trouble::hung_up;
    case BringUpTrouble::cancelled: return Trouble::cancelled;
    case BringUpTrouble::wrong_mode: return Trouble::wrong_mode;
    case BringUpTrouble::keeps_its_rate:
    case BringUpTrouble::stream_ended: return Trouble::unruly;
    case BringUpTrouble::silent:
    case BringUpTrouble::switched_off:
    case BringUpTrouble::stays_off: return Trouble::silent;
  }
  return Trouble::silent;
}

// Who else takes the bytes that were missed.
std::string others(const BringUpFailure& why) {
  const bool bytes_missed = why.trouble == BringUpTrouble::silent ||
                            why.trouble == BringUpTrouble::keeps_its_rate ||
                            why.trouble == BringUpTrouble::stream_ended;
  return bytes_missed && !why.others.empty() ? ". " + why.others : "";
}

}  // namespace

Failure explain(const BringUpFailure& why) {
  const std::string step = why.step.empty() ? "" : " at step " + why.step;
  return {"bring-up failed" + step + ": " + text(why) + others(why), code_of(why.trouble)};
}

Failure too_long(const oi::StreamList& packets, std::uint32_t baud, const oi::Dialect& dialect) {
  const auto enough = std::ranges::find_if(
      dialect.baud_rates, [&](std::uint32_t rate) { return oi::fits(packets, rate, dialect); });
  const std::string remedy = enough == dialect.baud_rates.end()
                                 ? "stream fewer packets"
                                 : "choose " + std::to_string(*enough) + " baud or more";
  return {"frames of " + std::to_string(oi::frame_bytes(packets, dialect)) +
          " bytes every 15 ms do not fit " + std::to_string(baud) + " baud, which carries " +
          std::to_string(oi::bytes_per_tick(baud)) + " bytes in that time; " + remedy};
}

}  // namespace cargobay::hal
