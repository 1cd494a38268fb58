// Scripts (OI p. 15) from commands in C++:
//
//   constexpr auto square =
//       ScriptBuilder{}
//           .drive({.velocity = MmPerSec{300}, .radius = kStraight})
//           .wait_distance(Mm{400})
//           .drive({.velocity = MmPerSec{300}, .radius = kTurnCounterClockwise})
//           .wait_angle(Deg{90})
//           .loop()
//           .script();
//
// A script can wait but not decide; while it waits, the robot reacts to nothing (OI p. 15).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <tuple>
#include <type_traits>
#include <variant>

#include "oi/command.hpp"
#include "oi/command_table.hpp"
#include "oi/commands.hpp"
#include "oi/encode.hpp"
#include "oi/limits.hpp"

namespace cargobay::oi {

namespace detail {

// The number that the table does not accept, if there is one.
struct RefusedNumber {
  const ArgumentInfo* argument = nullptr;
  std::int32_t value = 0;

  // Whether to go on searching.
  constexpr bool check(const ArgumentInfo& info, std::int32_t number) {
    if (info.accepts(number)) return true;
    argument = &info;
    value = number;
    return false;
  }
  constexpr bool check_element(Tail tail, const Note& note) {
    const auto infos = element_arguments(tail);
    return check(infos[0], note.number) && check(infos[1], note.duration.value);
  }
  template <typename Element>
  constexpr bool check_element(Tail tail, Element element) {
    return check(element_arguments(tail)[0], to_number(element));
  }
  template <typename Member>
  constexpr bool check_member(Tail tail, const ArgumentInfo& info, const Member& member) {
    if constexpr (is_list<Member>) {
      if (!check(info, static_cast<std::int32_t>(member.size()))) return false;
      for (const auto& element : member) {
        if (!check_element(tail, element)) return false;
      }
      return true;
    } else {
      return check(info, to_number(member));
    }
  }
};

template <CommandStruct C>
constexpr RefusedNumber find_refused(const C& command, const CommandInfo& info) {
  RefusedNumber refused;
  std::apply(
      [&](auto... pointers) {
        [[maybe_unused]] std::size_t index = 0;
        (void)(refused.check_member(info.tail, info.argument_slots[index++], command.*pointers) &&
               ...);  // the answer is in `refused`
      },
      C::kWire);
  return refused;
}

}  // namespace detail

class ScriptBuilder {
 public:
  // The first thing that went wrong.
  struct Error {
    enum class What : std::uint8_t {
      out_of_range,   // `value` is not one that `argument` accepts
      too_long,       // the script is longer than 100 bytes
      nested_script,  // a script cannot store another
    };
    What what = What::out_of_range;
    std::size_t index = 0;                   // of the command that failed, from 0
    const CommandInfo* command = nullptr;    // in the command table, as is `argument`
    const ArgumentInfo* argument = nullptr;  // out_of_range
    std::int32_t value = 0;                  // out_of_range
    std::size_t excess = 0;                  // too_long: how many bytes the whole script is over
  };

  // Appends any command except Script, which does not compile here. After an error nothing is
  // added.
  template <CommandStruct C>
    requires(!std::is_same_v<C, Script>)
  constexpr ScriptBuilder& add(const C& command) {
    const CommandInfo& info = kCommandInfo<C::kOpcode>;
    const auto bytes = encode(command);
    if (bytes) {
      append(info, *bytes);
    } else {
      const detail::RefusedNumber refused = detail::find_refused(command, info);
      fail({.what = Error::What::out_of_range,
            .command = &info,
            .argument = refused.argument,
            .value = refused.value});
    }
    ++count_;
    return *this;
  }
  ScriptBuilder& add(const Script&) = delete;
  // The same for a command known only at run time.
  ScriptBuilder& add(const Command& command) {
    std::visit(
        [this](const auto& one) {
          if constexpr (std::is_same_v<std::remove_cvref_t<decltype(one)>, Script>) {
            fail({.what = Error::What::nested_script, .command = &kCommandInfo<Script::kOpcode>});
            ++count_;
          } else {
            add(one);
          }
        },
        command);
    return *this;
  }

  // Driving.
  constexpr ScriptBuilder& drive(const Drive& drive) { return add(drive); }
  constexpr ScriptBuilder& drive_direct(const DriveDirect& wheels) { return add(wheels); }
  constexpr ScriptBuilder& stop() { return add(DriveDirect{}); }

  // Waiting. If the robot never reaches a distance or an angle, it waits until reset: backwards and
  // clockwise are negative, and the sign must be that of the drive command.
  constexpr ScriptBuilder& wait_time(Tenths time) { return add(WaitTime{time}); }
  constexpr ScriptBuilder& wait_distance(Mm distance) { return add(WaitDistance{distance}); }
  constexpr ScriptBuilder& wait_angle(Deg angle) { return add(WaitAngle{angle}); }
  constexpr ScriptBuilder& wait_event(ScriptEvent event) { return add(WaitEvent{event}); }

  // Lights, outputs, sound.
  constexpr ScriptBuilder& leds(const Leds& leds) { return add(leds); }
  constexpr ScriptBuilder& digital_outputs(BitSet<DigitalOutput> on) {
    return add(DigitalOutputs{on});
  }
  constexpr ScriptBuilder& low_side_drivers(BitSet<LowSideDriver> on) {
    return add(LowSideDrivers{on});
  }
  constexpr ScriptBuilder& pwm_low_side_drivers(const PwmLowSideDrivers& duty) { return add(duty); }
  constexpr ScriptBuilder& send_ir(std::uint8_t byte) { return add(SendIr{byte}); }
  constexpr ScriptBuilder& song(const Song& song) { return add(song); }
  constexpr ScriptBuilder& play(std::uint8_t slot) { return add(Play{slot}); }

  // Modes and demos. A demo ends in Passive, where nothing that moves is obeyed.
  constexpr ScriptBuilder& safe() { return add(Safe{}); }
  constexpr ScriptBuilder& full() { return add(Full{}); }
  constexpr ScriptBuilder& demo(DemoNumber demo) { return add(Demo{demo}); }

  // Play Script, as the last command: the script starts again, for ever.
  constexpr ScriptBuilder& loop() { return add(PlayScript{}); }

  constexpr const std::optional<Error>& error() const { return error_; }
  // The script; nothing after an error.
  constexpr std::optional<Script> script() const {
    if (error_) return std::nullopt;
    return script_;
  }

 private:
  constexpr void append(const CommandInfo& info, std::span<const std::uint8_t> bytes) {
    if (error_) {
      if (error_->what == Error::What::too_long) error_->excess += bytes.size();
      return;
    }
    if (script_.body.append(bytes)) return;
    fail({.what = Error::What::too_long,
          .command = &info,
          .excess = script_.body.size() + bytes.size() - kMaxScriptBytes});
  }
  constexpr void fail(Error error) {
    if (error_) return;
    error.index = count_;
    error_ = error;
  }

  Script script_{};
  std::size_t count_ = 0;
  std::optional<Error> error_;
};

}  // namespace cargobay::oi
