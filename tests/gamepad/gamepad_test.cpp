// The gamepad on devices that libevdev makes without hardware: what a real one reports, event by
// event.
#include "hal/gamepad/gamepad.hpp"

#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <libevdev/libevdev.h>

namespace cargobay::gamepad {
namespace {

constexpr Gamepad::Time kBegin{};

using Device = std::unique_ptr<libevdev, void (*)(libevdev*)>;

struct Axis {
  unsigned code = 0;
  int least = 0;
  int most = 0;
};

Device device(const std::vector<Axis>& axes, const std::vector<unsigned>& buttons) {
  Device made{libevdev_new(), libevdev_free};
  for (const Axis& axis : axes) {
    const input_absinfo info{.value = (axis.least + axis.most) / 2,
                             .minimum = axis.least,
                             .maximum = axis.most,
                             .fuzz = 0,
                             .flat = 0,
                             .resolution = 0};
    libevdev_enable_event_code(made.get(), EV_ABS, axis.code, &info);
  }
  for (const unsigned button : buttons)
    libevdev_enable_event_code(made.get(), EV_KEY, button, nullptr);
  return made;
}

// As the kernel describes an Xbox pad, and one with sticks of eight bits.
Device xbox() {
  return device({{ABS_X, -32768, 32767}, {ABS_Y, -32768, 32767}},
                {BTN_SOUTH, BTN_EAST, BTN_TL, BTN_TR});
}
Device eight_bits() { return device({{ABS_X, 0, 255}, {ABS_Y, 0, 255}}, {BTN_SOUTH, BTN_TL}); }

void set(const Device& to, unsigned type, unsigned code, int value) {
  ASSERT_EQ(libevdev_set_event_value(to.get(), type, code, value), 0);
}

TEST(Gamepad, IsADeviceWithAStickAndShoulders) {
  EXPECT_TRUE(Gamepad::is_one(xbox().get()));
  EXPECT_TRUE(Gamepad::is_one(eight_bits().get()));
  EXPECT_FALSE(Gamepad::is_one(device({}, {KEY_A, KEY_B}).get())) << "a keyboard";
  EXPECT_FALSE(Gamepad::is_one(device({{ABS_X, 0, 100}, {ABS_Y, 0, 100}}, {BTN_TOUCH}).get()))
      << "a touch screen";
}

TEST(Gamepad, StandsUnlessAShoulderIsHeld) {
  const Device pad = xbox();
  const Gamepad gamepad{pad.get(), kBegin};
  EXPECT_EQ(gamepad.line(kBegin), "stand");
  set(pad, EV_ABS, ABS_Y, -32768);
  EXPECT_EQ(gamepad.line(kBegin), "stand");
  set(pad, EV_KEY, BTN_SOUTH, 1);
  EXPECT_EQ(gamepad.line(kBegin), "stand");
  set(pad, EV_KEY, BTN_TR, 1);
  EXPECT_EQ(gamepad.line(kBegin), "drive 1.000 0.000");
  set(pad, EV_KEY, BTN_TR, 0);
  EXPECT_EQ(gamepad.line(kBegin), "stand");
}

TEST(Gamepad, DrivesAsTheStickPoints) {
  const Device pad = eight_bits();
  const Gamepad gamepad{pad.get(), kBegin};
  set(pad, EV_KEY, BTN_TL, 1);
  struct Case {
    int x, y;
    const char* line;
  };
  for (const Case& each : {Case{128, 0, "drive 1.000 0.000"}, Case{127, 255, "drive -1.000 0.000"},
                           Case{0, 128, "drive 0.000 1.000"}, Case{255, 128, "drive 0.000 -1.000"},
                           Case{128, 128, "drive 0.000 0.000"}, Case{0, 0, "drive 1.000 1.000"},
                           Case{138, 118, "drive 0.000 0.000"}}) {
    set(pad, EV_ABS, ABS_X, each.x);
    set(pad, EV_ABS, ABS_Y, each.y);
    EXPECT_EQ(gamepad.line(kBegin), each.line) << each.x << ' ' << each.y;
  }
  double before = 1.0;
  for (int y = 0; y <= 255; ++y) {
    set(pad, EV_ABS, ABS_Y, y);
    const double forward = gamepad.stick().forward;
    EXPECT_LE(forward, before) << y;
    EXPECT_GE(forward, before - 0.02) << y << ": it jumps";
    before = forward;
  }
}

TEST(Gamepad, ThatHasBeenSilentDrivesNoLonger) {
  const Device pad = xbox();
  Gamepad gamepad{pad.get(), kBegin};
  set(pad, EV_KEY, BTN_TL, 1);
  set(pad, EV_ABS, ABS_Y, -32768);
  const auto silent = kBegin + Gamepad::kSilence;
  EXPECT_EQ(gamepad.line(silent - std::chrono::milliseconds{1}), "drive 1.000 0.000");
  EXPECT_EQ(gamepad.line(silent), "silent");
  // Its link is back, or the stick has been moved.
  gamepad.hear(silent);
  EXPECT_EQ(gamepad.line(silent), "drive 1.000 0.000");
  EXPECT_EQ(gamepad.line(silent + Gamepad::kSilence), "silent");
  set(pad, EV_KEY, BTN_TL, 0);
  EXPECT_EQ(gamepad.line(silent + Gamepad::kSilence), "stand") << "nothing is held";
}

TEST(Gamepad, OfAnAxisWithoutARangeStands) {
  const Device pad = device({{ABS_X, 0, 0}, {ABS_Y, 5, 5}}, {BTN_TL});
  set(pad, EV_KEY, BTN_TL, 1);
  EXPECT_EQ((Gamepad{pad.get(), kBegin}.line(kBegin)), "drive 0.000 0.000");
}

}  // namespace
}  // namespace cargobay::gamepad
