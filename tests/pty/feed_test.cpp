// A robot that is watched and steered through its feed, as other programs do it.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "feed_fixture.hpp"
#include "hal/sim/remote/fault_command.hpp"

namespace cargobay::test {
namespace {

using testing::HasSubstr;

TEST_F(FeedTest, ADriveIsWatchedAndNotSteered) {
  Command command{drive({"--duration", "60"})};
  ASSERT_TRUE(starts_to_move());
  Watcher watcher{port_};
  const json hello = watcher.next("hello");
  EXPECT_EQ(hello["program"], "cargobay drive");
  EXPECT_EQ(hello["pid"], command.process());
  EXPECT_EQ(hello["steerable"], false);
  const json first = watcher.next("state");
  const json second = watcher.next("state");
  EXPECT_EQ(second["tick"], first["tick"].get<std::int64_t>() + 1);
  EXPECT_EQ(second["mode"], "safe");
  EXPECT_EQ(watcher.next("sensors")["oi_mode_name"], "safe");
  EXPECT_GT(watcher.next("statistics")["frame_to_command_ns"]["count"], 0);
  for (const char* request : {"stop", "release", "rearm"}) {
    const json answer = watcher.ask({{"do", request}});
    EXPECT_EQ(answer["ok"], false);
    EXPECT_THAT(answer["error"].get<std::string>(), HasSubstr("cargobay serve"));
  }
  EXPECT_TRUE(drives_on());
  command.send(SIGINT);
  EXPECT_EQ(command.exit_code(), 128 + SIGINT);
  EXPECT_EQ(watcher.next(
                [](const json& message) { return message.value("stage", "") == "ended"; })["type"],
            "status");
  EXPECT_FALSE(hal::FeedReader::attach(port_)) << "its socket is gone";
}

TEST_F(FeedTest, ADriveNeedNotBeWatched) {
  const Command command{drive({"--duration", "60", "--no-feed"})};
  ASSERT_TRUE(starts_to_move());
  const auto attached = hal::FeedReader::attach(port_);
  ASSERT_FALSE(attached);
  EXPECT_EQ(attached.failure().code, std::errc::no_such_device);
}

TEST_F(FeedTest, APortHasOneFeedUnderAllItsNames) {
  const TemporaryFolder folder;
  const std::string link = folder.path("robot");
  const std::string other = folder.path(std::string(100, 'r'));  // too long for a socket's name
  for (const std::string& name : {link, other}) std::filesystem::create_symlink(port_, name);
  for (const std::string& name : {port_, link, other}) {
    port_ = name;
    Command command{drive({"--duration", "60"})};
    ASSERT_TRUE(starts_to_move()) << command.err();
    for (const std::string& asked : {server_->path(), link, other}) {
      Watcher watcher{asked};
      EXPECT_EQ(watcher.next("hello")["port"], name) << "asked for " << asked;
    }
    command.send(SIGINT);
    EXPECT_EQ(command.exit_code(), 128 + SIGINT);
    EXPECT_EQ(command.err(), "");
  }
}

TEST_F(FeedTest, OneSteersAtATime) {
  Command command{serve_command()};
  wait_until_served(command);
  Watcher ann{port_};
  Watcher bob{port_};
  EXPECT_THAT(bob.ask({{"do", "drive"}, {"left_mm_s", 100}, {"right_mm_s", 100}})["error"],
              HasSubstr("hold"));
  EXPECT_EQ(ann.ask({{"do", "hold"}, {"name", "ann"}})["ok"], true);
  EXPECT_EQ(bob.next([](const json& message) {
    return message["type"] == "holder" && message["name"] == "ann";
  })["type"],
            "holder");
  EXPECT_THAT(bob.ask({{"do", "hold"}, {"name", "bob"}})["error"], HasSubstr("ann steers"));
  EXPECT_THAT(bob.ask({{"do", "drive"}, {"left_mm_s", 100}, {"right_mm_s", 100}})["error"],
              HasSubstr("ann steers"));
  int states = 0;
  ann.drive_while(200.0, [&] { return left_mm_s() < 100.0 && ++states < 400; });
  EXPECT_GE(left_mm_s(), 100.0);
  EXPECT_EQ(bob.ask({{"do", "stop"}})["ok"], true) << "a stop is everybody's";
  EXPECT_TRUE(comes_to_stand());
  EXPECT_EQ(ann.ask({{"do", "drive"}, {"left_mm_s", 100}, {"right_mm_s", 100}})["ok"], false)
      << "the lease is free";
  EXPECT_EQ(bob.ask({{"do", "hold"}, {"name", "bob"}})["ok"], true);
  EXPECT_EQ(ann.ask({{"do", "hold"}, {"name", "ann"}, {"take", true}})["ok"], true);
  EXPECT_EQ(bob.ask({{"do", "drive"}, {"left_mm_s", 100}, {"right_mm_s", 100}})["ok"], false);
}

TEST_F(FeedTest, WhoHoldsForAMomentIsNamed) {
  Command command{serve_command()};
  wait_until_served(command);
  Watcher bob{port_};
  Watcher ann{port_};
  (void)bob.next("holder");  // nobody, at the beginning
  // Both are read at once.
  EXPECT_TRUE(ann.reader().ask("{\"do\":\"hold\",\"name\":\"ann\"}\n{\"do\":\"stop\"}"));
  EXPECT_EQ(bob.next("holder")["name"], "ann");
  EXPECT_TRUE(bob.next("holder")["name"].is_null());
  // Two of one name: who had it hears that it is lost.
  const json of_ann = ann.ask({{"do", "hold"}, {"name", "page"}});
  EXPECT_EQ(of_ann["ok"], true);
  EXPECT_EQ(ann.next("holder")["lease"], of_ann["result"]["lease"]);
  EXPECT_EQ(bob.next("holder")["name"], "page");
  const json of_bob = bob.ask({{"do", "hold"}, {"name", "page"}, {"take", true}});
  const json taken = ann.next("holder");
  EXPECT_EQ(taken["name"], "page");
  EXPECT_EQ(taken["lease"], of_bob["result"]["lease"]);
  EXPECT_NE(taken["lease"], of_ann["result"]["lease"]);
}

TEST_F(FeedTest, TheSignalsAreReadForWhoIsShownThem) {
  Command command{serve_command()};
  wait_until_served(command);
  const auto streams_signals = [this] {
    bool found = false;
    server_->with_device([&](hal::sim::Device& device) {
      const auto packets = device.stream().packets();
      constexpr auto kSignal = static_cast<std::uint8_t>(oi::PacketId::cliff_left_signal);
      found = std::ranges::find(packets, kSignal) != packets.end();
    });
    return found;
  };
  Watcher of_states{port_};
  of_states.tell({{"do", "subscribe"}, {"types", {"state"}}});
  for (int i = 0; i < 100; ++i) {
    (void)of_states.next("state");
    EXPECT_FALSE(streams_signals()) << i;
  }
  {
    const Watcher of_sensors{port_};
    EXPECT_TRUE(eventually(streams_signals));
  }
  int without = 0;
  EXPECT_TRUE(eventually([&] { return (without = streams_signals() ? 0 : without + 1) == 50; }));
}

TEST_F(FeedTest, WhoseConnectionEndsStopsTheRobot) {
  Command command{serve_command()};
  wait_until_served(command);
  Watcher other{port_};
  for (int i = 0; i < 3; ++i) {
    Watcher watcher{port_};
    drive_until_it_moves(watcher);
    watcher.go();
    EXPECT_TRUE(comes_to_stand());
    EXPECT_EQ(other.ask({{"do", "hold"}, {"name", "other"}})["ok"], true) << "the lease is free";
    EXPECT_EQ(other.ask({{"do", "release"}})["ok"], true);
  }
}

TEST_F(FeedTest, WhoFallsSilentStopsTheRobotAndLosesTheLease) {
  Command command{serve_command()};
  wait_until_served(command);
  Watcher watcher{port_};
  Watcher other{port_};
  drive_until_it_moves(watcher);
  EXPECT_TRUE(comes_to_stand()) << "its setpoint lapses";
  EXPECT_TRUE(eventually(
      [&] { return other.ask({{"do", "hold"}, {"name", "other"}})["ok"] == json(true); }));
}

TEST_F(FeedTest, SaysWhatTheRobotWillNotDo) {
  Command command{serve_command()};
  wait_until_served(command);
  Watcher watcher{port_};
  ASSERT_EQ(watcher.ask({{"do", "hold"}, {"name", "test"}})["ok"], true);
  const auto refused = [&](const json& request, const char* why) {
    const json answer = watcher.ask(request);
    EXPECT_EQ(answer["ok"], false) << request;
    EXPECT_THAT(answer["error"].get<std::string>(), HasSubstr(why));
  };
  refused({{"do", "drive"}, {"left_mm_s", 501}, {"right_mm_s", 0}}, "-500 to 500");
  refused({{"do", "send"}, {"command", "full"}}, "for the loop to send");
  refused({{"do", "send"}, {"command", "drive 100 straight"}}, "for the loop to send");
  refused(
      {{"do", "send"}, {"command", "script { drive 100 straight; wait_event bump }; play_script"}},
      "without hearing a stop");
  refused({{"do", "send"}, {"command", "hop"}}, "hop");
  refused({{"do", "reset_odometry"}, {"x_mm", 1e300}, {"y_mm", 0}, {"heading_rad", 0}},
          "-1e9 to 1e9");
  refused({{"do", "control"}, {"line", "bump left"}}, "only a virtual Create");
  EXPECT_EQ(watcher.ask({{"do", "send"}, {"command", "leds play 0 255"}})["ok"], true);
  EXPECT_TRUE(eventually([&] {
    bool lit = false;
    server_->with_device(
        [&](hal::sim::Device& device) { lit = device.actuators().lit(oi::Led::play); });
    return lit;
  }));
  EXPECT_EQ(watcher.ask({{"do", "drive"}, {"velocity_mm_s", 9000}, {"turn_rate_rad_s", 0}})["ok"],
            true)
      << "a twist is scaled down";
}

TEST_F(FeedTest, GoesOnWithoutTheModeAndIsRearmed) {
  Command command{serve_command()};
  wait_until_served(command);
  Watcher watcher{port_};
  drive_until_it_moves(watcher);
  server_->with_device([](hal::sim::Device& device) { device.inputs().wheel_drop_left = true; });
  const json event = watcher.next("event");
  EXPECT_EQ(event["what"], "mode_lost");
  EXPECT_EQ(event["hazards"], json::array({"wheel_drop_left"}));
  EXPECT_TRUE(comes_to_stand());
  EXPECT_THAT(watcher.ask({{"do", "drive"}, {"left_mm_s", 100}, {"right_mm_s", 100}})["error"],
              HasSubstr("passive"));
  server_->with_device([](hal::sim::Device& device) { device.inputs().wheel_drop_left = false; });
  ASSERT_EQ(watcher.ask({{"do", "hold"}, {"name", "test"}})["ok"], true);
  EXPECT_EQ(watcher.ask({{"do", "rearm"}})["ok"], true);
  EXPECT_EQ(watcher.next(
                [](const json& message) { return message.value("what", "") == "rearmed"; })["type"],
            "event");
}

// Packets are read in turns, so that a frame may lack that of a hazard: a state says what is there,
// whichever states a reader gets.
TEST_F(FeedTest, AHazardStaysInEachStateWhileItIsThere) {
  Command command{serve_command()};
  wait_until_served(command);
  Watcher watcher{port_};
  const json there = json::array({"cliff_left"});
  for (const int every : {1, 3, 4}) {
    const auto cliff = [this](bool is_there) {
      server_->with_device(
          [&](hal::sim::Device& device) { device.inputs().cliff_left.cliff = is_there; });
    };
    const auto next_of = [&](const json& hazards) {
      return watcher.next([&](const json& message) {
        return message["type"] == "state" && message["hazards"] == hazards;
      });
    };
    cliff(true);
    ASSERT_EQ(watcher.ask({{"do", "subscribe"}, {"types", {"state"}}, {"every", every}})["ok"],
              true);
    const json first = next_of(there);
    ASSERT_FALSE(first.is_null()) << "every " << every;
    std::int64_t tick = first["tick"];
    for (int i = 0; i < 40; ++i) {
      const json state = watcher.next("state");
      ASSERT_EQ(state["hazards"], there) << "every " << every << ", after " << i;
      EXPECT_GE(state["tick"], tick + every);
      tick = state["tick"];
    }
    cliff(false);
    EXPECT_FALSE(next_of(json::array()).is_null()) << "it is over";
  }
}

// What each client got, and what it was told to have missed, adds up, and none holds up the loop.
// What a watcher missed, by the numbers of the messages and as it was told.
struct Missed {
  void see(const json& message) {
    if (message["type"] == "missed") told += message["messages"].get<std::uint64_t>();
    if (!message.contains("seq")) return;
    const std::uint64_t now = message["seq"];
    if (newest != 0 && now > newest) gaps += now - newest - 1;
    newest = now;
  }
  std::uint64_t told = 0;
  std::uint64_t gaps = 0;
  std::uint64_t newest = 0;
};

TEST_F(FeedTest, AClientThatDoesNotReadMissesOnlyItsOwn) {
  Command command{serve_command()};
  wait_until_served(command);
  Watcher asleep{port_};
  Watcher awake{port_};
  constexpr int kStates = 1000;  // 15 s: about 3 MB, more than its socket and queue hold
  int states = 0;
  Missed by_awake;
  const json last = awake.next(
      [&](const json& message) {
        by_awake.see(message);
        return message["type"] == "state" && ++states == kStates;
      },
      std::chrono::seconds{60});
  ASSERT_FALSE(last.is_null());
  EXPECT_EQ(by_awake.told, 0U) << "who reads misses nothing";
  EXPECT_EQ(by_awake.gaps, 0U);
  Missed by_asleep;
  (void)asleep.next([&](const json& message) {
    by_asleep.see(message);
    return message["type"] == "state" && message["tick"] >= last["tick"];
  });
  EXPECT_GT(by_asleep.told, 0U);
  EXPECT_EQ(by_asleep.gaps, by_asleep.told);
}

TEST_F(FeedTest, WhoSteeredTheFormerLoopDoesNotSteerTheNext) {
  Command command{serve_command()};
  wait_until_served(command);
  Watcher watcher{port_};
  drive_until_it_moves(watcher);
  server_->with_cable([](hal::sim::Cable& cable) {
    ASSERT_EQ(hal::sim::apply_fault("stalled-stream 1500", cable), "");
  });
  const auto stage = [](const char* name) {
    return [name](const json& message) { return message.value("stage", "") == name; };
  };
  EXPECT_EQ(watcher.next(stage("lost"))["type"], "status");
  EXPECT_EQ(watcher.next(stage("driving"))["type"], "status") << "it is brought up again";
  EXPECT_THAT(watcher.ask({{"do", "drive"}, {"left_mm_s", 100}, {"right_mm_s", 100}})["error"],
              HasSubstr("hold"));
  EXPECT_TRUE(comes_to_stand());
}

TEST_F(FeedTest, RefusesMoreThanItsMost) {
  Command command{serve_command()};
  wait_until_served(command);
  std::vector<std::unique_ptr<Watcher>> watchers;
  watchers.reserve(64);
  for (std::size_t i = 0; i < 64; ++i) watchers.push_back(std::make_unique<Watcher>(port_));
  EXPECT_EQ(watchers.back()->next("hello")["feed"], 1);
  Watcher last{port_};
  EXPECT_THAT(last.next("answer")["error"], HasSubstr("64 programs"));
  watchers.front()->go();
  EXPECT_TRUE(eventually([&] {
    Watcher again{port_};
    return again.next([](const json&) { return true; })["type"] == "hello";
  }));
}

TEST_F(FeedTest, OtherUsersDoNotSeeTheToken) {
  for (const std::vector<std::string>& token :
       {std::vector<std::string>{"--token", "unguessable"}, {"--token=unguessable"}}) {
    std::vector<std::string> words = serve_command();
    words.insert(words.end(), token.begin(), token.end());
    Command command{words};
    wait_until_served(command);
    std::ifstream file{"/proc/" + std::to_string(command.process()) + "/cmdline"};
    const std::string seen{std::istreambuf_iterator<char>{file}, {}};
    EXPECT_THAT(seen, HasSubstr("serve"));
    EXPECT_EQ(seen.find("unguessable"), std::string::npos);
    command.send(SIGTERM);
    EXPECT_EQ(command.exit_code(), 128 + SIGTERM);
  }
}

TEST_F(FeedTest, ItsEndLeavesTheRobotStanding) {
  Command command{serve_command()};
  wait_until_served(command);
  Watcher watcher{port_};
  drive_until_it_moves(watcher);
  command.send(SIGTERM);
  EXPECT_EQ(command.exit_code(), 128 + SIGTERM);
  EXPECT_TRUE(comes_to_stand());
}

TEST_F(FeedTest, ItsDeathLeavesTheRobotStanding) {
  Command command{serve_command()};
  wait_until_served(command);
  Watcher watcher{port_};
  drive_until_it_moves(watcher);
  command.send(SIGKILL);
  EXPECT_TRUE(comes_to_stand());
}

}  // namespace
}  // namespace cargobay::test
