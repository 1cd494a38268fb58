#include "oi/script_builder.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "oi/dialect.hpp"
#include "oi/text/script_text.hpp"

namespace cargobay::oi {
namespace {

using Bytes = std::vector<std::uint8_t>;
using What = ScriptBuilder::Error::What;

Bytes sent(const ScriptBuilder& builder) {
  const std::optional<Script> script = builder.script();
  if (!script) return {};
  const auto bytes = encode(*script);
  return {bytes->begin(), bytes->end()};
}

std::string complaint(const ScriptBuilder& builder) {
  if (!builder.error()) return "none";
  EXPECT_FALSE(builder.script());
  std::array<char, 400> text{};
  return {text.data(), format_error(*builder.error(), text)};
}

// OI p. 15.
TEST(ScriptBuilder, DrivesFortyCentimetresAndStops) {
  ScriptBuilder script;
  script.drive({.velocity = MmPerSec{300}, .radius = kStraight})
      .wait_distance(Mm{400})
      .drive({.velocity = MmPerSec{0}, .radius = Mm{0}});
  EXPECT_EQ(sent(script), (Bytes{152, 13, 137, 1, 44, 128, 0, 156, 1, 144, 137, 0, 0, 0, 0}));
}

TEST(ScriptBuilder, TogglesALedOnBump) {
  ScriptBuilder script;
  script.wait_event(ScriptEvent::bump)
      .wait_event(inverse(ScriptEvent::bump))
      .leds({.leds = BitSet<Led>{}.with(Led::play)})
      .wait_event(ScriptEvent::bump)
      .wait_event(inverse(ScriptEvent::bump))
      .leds({})
      .loop();
  EXPECT_EQ(sent(script),
            (Bytes{152, 17, 158, 5, 158, 251, 139, 2, 0, 0, 158, 5, 158, 251, 139, 0, 0, 0, 153}));
}

TEST(ScriptBuilder, DrivesInASquare) {
  constexpr std::optional<Script> kSquare =
      ScriptBuilder{}
          .drive({.velocity = MmPerSec{300}, .radius = kStraight})
          .wait_distance(Mm{400})
          .drive({.velocity = MmPerSec{300}, .radius = kTurnCounterClockwise})
          .wait_angle(Deg{90})
          .loop()
          .script();
  static_assert(kSquare && kSquare->body.size() == 17);
  const auto bytes = encode(*kSquare);
  EXPECT_EQ(Bytes(bytes->begin(), bytes->end()),
            (Bytes{152, 17, 137, 1, 44, 128, 0, 156, 1, 144, 137, 1, 44, 0, 1, 157, 0, 90, 153}));
}

TEST(ScriptBuilder, HasEveryCommandOfAProgram) {
  ScriptBuilder script;
  script.safe()
      .drive_direct({.left = MmPerSec{100}, .right = MmPerSec{-100}})
      .wait_time(Tenths{5})
      .stop()
      .low_side_drivers(BitSet<LowSideDriver>{}.with(LowSideDriver::driver_1))
      .pwm_low_side_drivers({.driver_0 = 1, .driver_1 = 2, .driver_2 = 3})
      .digital_outputs(BitSet<DigitalOutput>{}.with(DigitalOutput::output_2))
      .send_ir(130)
      .song({.slot = 1, .notes = list_of<Note, kMaxSongNotes>(Note{60, SixtyFourths{32}})})
      .play(1)
      .full()
      .demo(DemoNumber::abort)
      .add(Sensors{PacketId::group_6});
  EXPECT_EQ(sent(script), (Bytes{152, 35, 131, 145, 255, 156, 0,   100, 155, 5,   145, 0,   0,
                                 0,   0,  138, 2,   144, 3,   2,   1,   147, 4,   151, 130, 140,
                                 1,   1,  60,  32,  141, 1,   132, 136, 255, 142, 6}));
}

TEST(ScriptBuilder, OfNothingIsTheEmptyScript) {
  EXPECT_EQ(sent(ScriptBuilder{}), (Bytes{152, 0}));
}

TEST(ScriptBuilder, AddsACommandKnownAtRunTime) {
  ScriptBuilder script;
  script.add(Command{WaitAngle{Deg{-90}}}).add(Command{PlayScript{}});
  EXPECT_EQ(sent(script), (Bytes{152, 4, 157, 255, 166, 153}));
}

TEST(ScriptBuilder, SaysWhichNumberOfWhichCommandIsOutOfRange) {
  ScriptBuilder script;
  script.loop().drive({.velocity = MmPerSec{-501}});
  ASSERT_TRUE(script.error());
  EXPECT_EQ(script.error()->what, What::out_of_range);
  EXPECT_EQ(script.error()->index, 1U);
  EXPECT_EQ(script.error()->command, kCreate.find_command("drive"));
  EXPECT_EQ(script.error()->argument, &kCreate.find_command("drive")->argument_slots[0]);
  EXPECT_EQ(script.error()->value, -501);
  EXPECT_EQ(complaint(script),
            "command 2, drive: velocity -501 is out of range; it is -500 to 500 mm/s");
}

// The fields of a struct are found by name, not by their place on the wire.
TEST(ScriptBuilder, NamesTheWheelThatIsTooFast) {
  ScriptBuilder left;
  left.drive_direct({.left = MmPerSec{501}, .right = MmPerSec{0}});
  ASSERT_TRUE(left.error());
  EXPECT_EQ(left.error()->argument->name, "left");
  ScriptBuilder right;
  right.drive_direct({.left = MmPerSec{0}, .right = MmPerSec{32768}});
  ASSERT_TRUE(right.error());
  EXPECT_EQ(right.error()->argument->name, "right");
  EXPECT_EQ(right.error()->value, 32768);
}

TEST(ScriptBuilder, FindsWhatIsWrongInAList) {
  ScriptBuilder empty;
  empty.song({.slot = 0, .notes = {}});
  ASSERT_TRUE(empty.error());
  EXPECT_EQ(empty.error()->argument->name, "length");
  EXPECT_EQ(empty.error()->value, 0);
  ScriptBuilder endless;
  endless.song({.slot = 0,
                .notes = list_of<Note, kMaxSongNotes>(Note{60, SixtyFourths{1}},
                                                      Note{60, SixtyFourths{256}})});
  ASSERT_TRUE(endless.error());
  ASSERT_NE(endless.error()->argument, nullptr);
  EXPECT_EQ(endless.error()->argument->name, "duration");
  EXPECT_EQ(endless.error()->value, 256);
  ScriptBuilder unknown;
  unknown.add(
      Stream{list_of<PacketId, kMaxStreamPackets>(PacketId::wall, static_cast<PacketId>(99))});
  ASSERT_TRUE(unknown.error());
  EXPECT_EQ(unknown.error()->argument->name, "packet");
  EXPECT_EQ(unknown.error()->value, 99);
}

TEST(ScriptBuilder, RefusesEventZero) {
  ScriptBuilder script;
  script.wait_event(static_cast<ScriptEvent>(0));
  ASSERT_TRUE(script.error());
  EXPECT_EQ(script.error()->value, 0);
}

// Twenty stops fill the hundred bytes.
TEST(ScriptBuilder, HoldsAHundredBytes) {
  ScriptBuilder script;
  for (int i = 0; i < 20; ++i) script.stop();
  ASSERT_TRUE(script.script());
  EXPECT_EQ(script.script()->body.size(), 100U);
  script.loop();
  ASSERT_TRUE(script.error());
  EXPECT_EQ(script.error()->what, What::too_long);
  EXPECT_EQ(script.error()->index, 20U);
  EXPECT_EQ(script.error()->excess, 1U);
  EXPECT_EQ(complaint(script),
            "command 21, play_script: from here on it is longer than 100 bytes, "
            "in all by 1");
}

TEST(ScriptBuilder, CountsWhatDoesNotFitToTheEnd) {
  ScriptBuilder script;
  for (int i = 0; i < 19; ++i) script.stop();
  script.wait_distance(Mm{1}).stop().loop().stop();
  ASSERT_TRUE(script.error());
  EXPECT_EQ(script.error()->index, 20U);
  EXPECT_EQ(script.error()->excess, 9U);  // 95 + 3 + 5 + 1 + 5
}

TEST(ScriptBuilder, KeepsTheFirstError) {
  ScriptBuilder script;
  script.wait_time(Tenths{256}).drive({.velocity = MmPerSec{501}});
  for (int i = 0; i < 30; ++i) script.stop();
  script.add(Command{Script{}});
  ASSERT_TRUE(script.error());
  EXPECT_EQ(script.error()->what, What::out_of_range);
  EXPECT_EQ(script.error()->index, 0U);
  EXPECT_EQ(script.error()->value, 256);
}

template <typename C>
concept CanBeAdded = requires(ScriptBuilder builder, C command) { builder.add(command); };

TEST(ScriptBuilder, RefusesAScriptInAScript) {
  static_assert(CanBeAdded<Drive> && CanBeAdded<ShowScript> && CanBeAdded<Command>);
  static_assert(!CanBeAdded<Script>);
  ScriptBuilder script;
  script.stop().add(Command{Script{}}).stop();
  ASSERT_TRUE(script.error());
  EXPECT_EQ(script.error()->what, What::nested_script);
  EXPECT_EQ(script.error()->index, 1U);
  EXPECT_EQ(complaint(script), "command 2, script: a script cannot hold a script");
}

}  // namespace
}  // namespace cargobay::oi
