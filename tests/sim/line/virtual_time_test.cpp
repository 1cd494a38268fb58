#include "hal/sim/line/virtual_time.hpp"

#include <string>

#include <gtest/gtest.h>

#include "hal/sim/line/virtual_link.hpp"
#include "tests/sim/robot.hpp"

namespace cargobay::hal::sim {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace): this file's own helpers
using Wait = ByteStream::Wait;

// A loop that waits for a while each time, or for a byte, and writes down who it is.
struct Loop {
  Loop(char who, Device& device, VirtualTime& time, rt::Duration period, std::string& log)
      : name{who}, link{device, time}, every{period}, said{log} {}

  void pass() {
    if (!left) until = link.now() + every;
    const Wait how = link.wait(until);
    left = how == Wait::left;
    if (left) return;
    said += name;
    if (how == Wait::ready) (void)link.read(bytes);
    ++passes;
  }
  void run_beside() {
    link.set_pass([this] { pass(); });
  }

  char name;
  VirtualLink link;
  rt::Duration every;
  std::string& said;
  rt::TimePoint until{};
  bool left = false;
  Bytes bytes = Bytes(64);
  int passes = 0;
};

TEST(VirtualTime, IsTheSameForAllLinks) {
  VirtualTime time;
  Device first{Parameters{}};
  Device second{Parameters{}};
  VirtualLink link{first, time};
  link.advance(1234567ns);
  VirtualLink other{second, time};
  EXPECT_EQ(other.now(), link.now()) << "one that joins is brought up to the present";
  EXPECT_EQ(link.wait(link.now() + 100ms), Wait::timed_out);
  EXPECT_EQ(second.now(), 101234567ns);
  other.sleep(1s);
  EXPECT_EQ(first.now(), 1101234567ns);
  time.advance_to(2s);
  EXPECT_EQ(first.now(), 2s);
  EXPECT_EQ(second.now(), 2s);
}

// The order in which things happen, waiting for one or the other or for none.
TEST(VirtualTime, MakesPassesInTheOrderOfTime) {
  const auto drive = [](int waited) {
    std::string log;
    VirtualTime time;
    Device devices[]{Device{Parameters{}}, Device{Parameters{}}, Device{Parameters{}}};
    Loop a{'a', devices[0], time, 7ms, log};
    Loop b{'b', devices[1], time, 4ms, log};
    Loop c{'c', devices[2], time, 14ms, log};
    Loop* const loops[]{&a, &b, &c};
    for (Loop* const loop : loops) loop->run_beside();
    while (time.now() < 28ms) {
      if (waited < 3) {
        loops[waited]->pass();
      } else {
        time.advance_to(time.now() + 1ms);
      }
    }
    time.advance_to(28ms);
    return log;
  };
  // 4 7 8 12 14 16 20 21 24 28 ms; at the same instant in the order of joining.
  const std::string wanted = "babbacbbababc";
  EXPECT_EQ(drive(3), wanted);
  for (const int waited : {0, 1, 2}) EXPECT_EQ(drive(waited), wanted) << waited;
}

TEST(VirtualTime, WakesALoopForItsBytes) {
  std::string log;
  VirtualTime time;
  Device first{Parameters{}};
  Device second{Parameters{}};
  Loop waited{'w', first, time, 1s, log};
  Loop loop{'l', second, time, 900ms, log};
  loop.run_beside();
  (void)loop.link.write(Bytes{128, 142, 35});
  waited.pass();
  EXPECT_EQ(loop.passes, 2) << "its byte, and its second";
  EXPECT_EQ(waited.passes, 1);
  loop.link.set_pass({});
  waited.pass();
  EXPECT_EQ(loop.passes, 2);
}

TEST(VirtualTime, EndsWithALoopThatEnds) {
  VirtualTime time;
  Device first{Parameters{}};
  Device second{Parameters{}};
  VirtualLink link{first, time};
  VirtualLink other{second, time};
  int calls = 0;
  other.set_pass([&calls] { ++calls; });  // has ended: it does not wait
  link.advance(1s);
  EXPECT_GT(calls, 0);
  EXPECT_EQ(second.now(), 1s);
}

}  // namespace
}  // namespace cargobay::hal::sim
