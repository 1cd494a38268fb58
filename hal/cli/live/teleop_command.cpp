// `cargobay teleop`: a person steers the robot, by the keyboard or a gamepad.

#include <algorithm>
#include <chrono>
#include <csignal>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "hal/cli/commands.hpp"
#include "hal/cli/drive/drive_options.hpp"
#include "hal/cli/live/gamepad_helper.hpp"
#include "hal/cli/live/own_robot.hpp"
#include "hal/cli/live/steering.hpp"
#include "hal/cli/live/steering_keys.hpp"
#include "hal/cli/live/teleop_view.hpp"
#include "hal/cli/live/typed.hpp"
#include "hal/cli/terminal/exit_codes.hpp"
#include "hal/cli/terminal/print.hpp"
#include "hal/cli/terminal/signals.hpp"
#include "hal/cli/terminal/standard_streams.hpp"
#include "hal/cli/view/screen.hpp"
#include "oi/limits.hpp"
#include "rt/clock.hpp"

namespace cargobay::cli {
namespace {

constexpr rt::Duration kTeleopRefresh = std::chrono::milliseconds{100};
// In mm/s.
constexpr double kLeastSpeed = 20.0;
constexpr double kSpeedStep = 20.0;
constexpr const char* kTeleopMessages = R"({"do":"subscribe","types":["state","truth"],"every":6})";

struct TeleopOptions {
  DriveOptions drive{};  // of a robot of its own
  bool take = false;
  double speed_mm_s = 200.0;
  std::optional<std::string> gamepad{};  // its device; empty for any
};

// A person at a feed.
class Teleop {
 public:
  // The reader outlives it.
  Teleop(const TeleopOptions& options, hal::FeedReader& reader)
      : speed_mm_s_{options.speed_mm_s}, reader_{reader}, steering_{reader, news_} {}

  hal::Result<void> begin(const TeleopOptions& options) {
    if (options.gamepad) {
      auto helper = GamepadHelper::start(*options.gamepad);
      if (!helper) return helper.failure();
      gamepad_.emplace(std::move(*helper));
    }
    if (const auto begun = steering_.begin(options.take); !begun) return begun;
    return reader_.ask(kTeleopMessages);
  }

  // Until a signal, a q, or the feed's end. The robot is then told to stand.
  hal::Result<void> run(StopSignals& signals) {
    screen_ = Screen::open(ControlZ::ends);
    hal::Result<void> result;
    while (result && !over_ && !signals.wait(rt::Duration::zero()).has_value() && !output_error())
      result = turn();
    steering_.end();
    screen_.reset();
    return result;
  }

 private:
  hal::Result<void> turn() {
    auto heard = take_news(reader_, news_, [this](hal::FeedType type) { steering_.hear(type); });
    if (!heard) return heard;
    const rt::TimePoint now = rt::Clock::now();
    hal::Result<void> done;
    if (now - last_turn_ > HeldKeys::kCounts) forget_typed();
    last_turn_ = now;
    decoder_.take(typed(), [&](SteeringKey key) {
      if (done) done = press(key, now);
    });
    if (!done) return done;
    if (gamepad_) {
      if (const auto taken = gamepad_->take(now); !taken) return taken;
    }
    const Wish by_gamepad = stick_.of(gamepad_ ? gamepad_->wish(now) : Wish{});
    const Wish wish = by_gamepad == Wish{} ? keys_.wish(now) : by_gamepad;
    if (wish != Wish{} && before_ == Wish{}) {
      if (const auto asked = begin_to_move(); !asked) return asked;
    }
    before_ = wish;
    asked_ = speeds_for(wish, speed_mm_s_);
    if (const auto steered = steering_.steer(asked_, now); !steered) return steered;
    draw(now);
    wait_for_input(reader_, gamepad_ ? gamepad_->descriptor() : -1, now + kWake);
    return {};
  }

  // This process was suspended, or its output was stuck: what was typed then was meant for then.
  void forget_typed() {
    for (int i = 0; i < kMostReads && !typed().empty(); ++i) continue;
    keys_.let_go();
    if (gamepad_) gamepad_->skip_to_now();
    stick_.stop();
  }

  // Somebody may have stopped the robot, and the lease is free: who moves it now takes it. From
  // another it is only taken by a key of its own.
  hal::Result<void> begin_to_move() {
    if (steering_.holds() || !news_.holder.empty()) return {};
    return steering_.ask_again(false);
  }

  hal::Result<void> press(SteeringKey key, rt::TimePoint now) {
    keys_.press(key, now);
    if (key == SteeringKey::stop) stick_.stop();
    switch (key) {
      case SteeringKey::quit: over_ = true; break;
      case SteeringKey::faster: change_speed(kSpeedStep); break;
      case SteeringKey::slower: change_speed(-kSpeedStep); break;
      case SteeringKey::take: return steering_.ask_again(true);
      case SteeringKey::rearm: return steering_.rearm();
      // Whoever steers: a stop is everyone's. Our own lease stays: the setpoint is 0 from here on.
      case SteeringKey::stop: return steering_.holds() ? hal::Result<void>{} : steering_.stop();
      case SteeringKey::forward:
      case SteeringKey::back:
      case SteeringKey::left:
      case SteeringKey::right:
      case SteeringKey::other: break;
    }
    return {};
  }

  void change_speed(double by_mm_s) {
    constexpr double kMost = oi::kMaxWheelSpeed;
    speed_mm_s_ = std::clamp(speed_mm_s_ + by_mm_s, kLeastSpeed, kMost);
  }

  void draw(rt::TimePoint now) {
    if (!screen_ || (!screen_->attend() && now < next_draw_)) return;
    next_draw_ = now + kTeleopRefresh;
    const TeleopPicture picture{.holds = steering_.holds(),
                                .name = steering_.name(),
                                .speed_mm_s = speed_mm_s_,
                                .asked = asked_,
                                .complaint = steering_.complaint(now),
                                .gamepad = gamepad_ ? gamepad_->name() : std::string{},
                                .gamepad_is_silent = gamepad_ && gamepad_->is_silent()};
    screen_->draw(teleop_view(picture, news_, HeldMessages::so_far(), screen_->size()));
  }

  static constexpr rt::Duration kWake = std::chrono::milliseconds{20};
  static constexpr int kMostReads = 64;  // more than a terminal keeps

  double speed_mm_s_;
  hal::FeedReader& reader_;
  FeedNews news_{};
  Steering steering_;
  std::optional<GamepadHelper> gamepad_{};
  KeyDecoder decoder_{};
  HeldKeys keys_{};
  StickAfterStop stick_{};
  Wish before_{};
  rt::WheelSpeeds asked_{};
  std::unique_ptr<Screen> screen_{};
  rt::TimePoint next_draw_{};
  rt::TimePoint last_turn_ = rt::Clock::now();
  bool over_ = false;
};

int teleop(const TeleopOptions& options) {
  StopSignals signals{SIGTSTP};  // suspended by Ctrl-Z, it would only look as if it steered
  const auto fail = [](const hal::Failure& failure) {
    print_error(failure.message);
    return kFailure;
  };
  if (!keys_can_come() || !stdout_is_terminal() || !terminal_moves_cursor()) {
    return fail(
        {"teleop needs a terminal that can show a picture, and from which keys come; to "
         "steer from a program, see docs/feed.md"});
  }
  auto attached = attach(options.drive, "cargobay teleop");
  if (!attached) return fail(attached.failure());
  hal::Result<void> driven;
  {
    Teleop person{options, attached->reader};
    driven = person.begin(options);
    if (driven) driven = person.run(signals);
  }
  if (attached->own) {
    if (const auto ended = attached->own->end(); !ended) return fail(ended.failure());
  }
  return driven ? kSuccess : fail(driven.failure());
}

}  // namespace

void add_teleop(CLI::App& app, Action& chosen) {
  auto options = std::make_shared<TeleopOptions>();
  CLI::App* command = app.add_subcommand(
      "teleop",
      "Steer a robot by the arrow keys or WASD, or by a gamepad.\n"
      "The robot moves while a key is held: a terminal does not say when one is let go, so that\n"
      "each counts for 400 ms, and on while it repeats. Space stops, + and - change the speed, r\n"
      "goes back to the mode that a hazard ended, q ends it. The robot of a `cargobay serve` is\n"
      "steered through its feed; without --port, that of the only feed there is. If nothing "
      "drives\n"
      "the robot, this does. Without --port, that is a virtual Create of its own.");
  add_port_options(*command, options->drive.connection);
  command->add_flag("--take", options->take, "Take over from whoever steers it now");
  command
      ->add_option("--speed", options->speed_mm_s, "Wheel speed in mm/s to begin with, 20 to 500")
      ->check(CLI::Range(kLeastSpeed, static_cast<double>(oi::kMaxWheelSpeed)))
      ->capture_default_str();
  command
      ->add_option("--gamepad", options->gamepad,
                   "Steer by a gamepad too, the first there is or this /dev/input/event*: left "
                   "stick, while a shoulder button is held")
      ->expected(0, 1)
      ->default_str("")
      ->option_text("[DEVICE]");
  command->footer(
      "Examples:\n"
      "  cargobay teleop\n"
      "  cargobay teleop --port /dev/ttyUSB0 --speed 150");
  command->callback([options, &chosen] { chosen = [options] { return teleop(*options); }; });
}

}  // namespace cargobay::cli
