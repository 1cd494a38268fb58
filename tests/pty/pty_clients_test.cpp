// Which clients have a virtual Create's port open, however they come and go.
#include <fcntl.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <thread>
#include <vector>

#include "drive_fixture.hpp"
#include "hal/bring_up/bring_up.hpp"
#include "hal/port/open_port.hpp"
#include "hal/sim/line/pty_port.hpp"

namespace cargobay::hal::sim {
namespace {

using test::Bytes;
using test::eventually;
using test::SerialClient;

int open_quietly(const std::string& path) {
  return open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
}

struct Served {
  Served() {
    auto opened = Server::open({}, {});
    if (!opened) return;
    server = std::move(*opened);
    started = !server->start();
  }
  // Its thread has completed one more round, and seen what happened before.
  bool looks_again() const {
    const std::uint64_t before = server->snapshot().server.wakeups;
    return eventually([&] { return server->snapshot().server.wakeups > before + 1; });
  }
  std::uint64_t undelivered() const { return server->snapshot().server.bytes_undelivered; }
  std::unique_ptr<Server> server{};
  bool started = false;
};

// The kernel merges two unread events of the same kind into one.
TEST(PtyClients, AreNotMiscountedByThoseWhoOpenAtOnceAndCloseApart) {
  const Served served;
  ASSERT_TRUE(served.started);
  const std::string path = served.server->path();
  const SerialClient client{path};
  ASSERT_EQ(client.ask({128, 148, 1, 35}, 5).size(), 5U);
  for (int i = 0; i < 3; ++i) {
    int first = -1;
    int second = -1;
    served.server->with_device([&](Device&) {  // delays the server's thread
      first = open_quietly(path);
      second = open_quietly(path);
      close(first);
    });
    ASSERT_TRUE(served.looks_again());
    close(second);
    ASSERT_TRUE(served.looks_again());
  }
  EXPECT_EQ(client.receive(500).size(), 500U);
  EXPECT_EQ(served.undelivered(), 0U);
}

// Programs that open the port and close it again lose no byte, in either direction.
TEST(PtyClients, AreNotDisturbedByThoseWhoOpenAndClose) {
  const Served served;
  ASSERT_TRUE(served.started);
  const std::string path = served.server->path();
  const SerialClient client{path};
  ASSERT_EQ(client.ask({128, 148, 1, 35}, 5).size(), 5U);
  std::atomic<bool> enough{false};
  std::atomic<int> opened{0};
  std::vector<std::thread> others;
  others.reserve(4);
  for (int i = 0; i < 4; ++i) {
    others.emplace_back([&, i] {
      while (!enough.load()) {
        const int descriptor = open_quietly(path);
        if (i % 2 == 0) poll(nullptr, 0, i);
        if (descriptor >= 0) close(descriptor);
        ++opened;
        poll(nullptr, 0, 1);
      }
    });
  }
  bool whole = true;
  for (int frame = 0; frame < 100 && whole; ++frame)
    whole = client.receive(5) == Bytes{19, 2, 35, 1, 199};
  enough = true;
  for (std::thread& other : others) other.join();
  EXPECT_TRUE(whole);
  EXPECT_GT(opened.load(), 100);
  EXPECT_EQ(served.undelivered(), 0U);
}

// The lock decides, and the losers leave the port as it was.
TEST(PtyClients, OfManyThatOpenThePortAtOnceOneIsBroughtUp) {
  const Served served;
  ASSERT_TRUE(served.started);
  const std::string path = served.server->path();
  for (int round = 0; round < 20; ++round) {
    std::array<std::unique_ptr<ByteStream>, 4> streams{};
    std::atomic<int> waiting{0};
    std::vector<std::thread> threads;
    threads.reserve(streams.size());
    for (auto& stream : streams) {
      threads.emplace_back([&] {
        ++waiting;
        while (waiting.load() < 4) {
        }
        if (auto opened = open_port(path, 57600)) stream = std::move(opened->stream);
      });
    }
    for (std::thread& thread : threads) thread.join();
    ASSERT_EQ(std::count(streams.begin(), streams.end(), nullptr), 3) << "round " << round;
    auto* const winner = std::find_if(streams.begin(), streams.end(),
                                      [](const auto& stream) { return stream != nullptr; });
    BringUpRequest request;
    request.mode = oi::Mode::passive;
    ASSERT_TRUE(request.packets.push_back(oi::PacketId::oi_mode));
    const auto report = bring_up(**winner, request);
    ASSERT_TRUE(report) << "round " << round << ": " << report.failure().message;
    EXPECT_EQ(report->found_baud, 57600U);
    const Bytes pause{150, 0};
    EXPECT_EQ((*winner)->write(pause).count, pause.size());
    winner->reset();
    ASSERT_EQ(served.server->snapshot().device.boots, 0U);
  }
}

// A client that dies does not leave the port exclusive; the modes set by the owner stay.
TEST(PtyClients, EndTheirExclusiveUseWithTheLastOfThem) {
  const auto opened = PtyPort::open("", 57600);
  ASSERT_TRUE(opened);
  PtyPort& port = **opened;
  ASSERT_EQ(chmod(port.device_path().c_str(), 0640), 0);
  rt::TimePoint now{};
  const auto pass = [&] {
    port.update_clients(now += std::chrono::seconds{1});  // notes that a client came
    port.update_clients(now += std::chrono::seconds{1});  // looks
  };
  const auto exclusive = [&] {
    const int own = open_quietly(port.device_path());
    int answer = -1;
    ioctl(own, TIOCGEXCL, &answer);
    close(own);
    return answer;
  };
  const auto mode = [&] {
    struct stat file{};
    stat(port.device_path().c_str(), &file);
    return file.st_mode & 07777U;
  };
  pass();
  EXPECT_FALSE(port.clients().present());
  {
    const SerialClient first{port.device_path()};
    const SerialClient second{port.device_path()};
    ASSERT_EQ(ioctl(first.descriptor(), TIOCEXCL), 0);
    for (int i = 0; i < 10; ++i) pass();
    EXPECT_TRUE(port.clients().present());
    EXPECT_EQ(exclusive(), 1) << "looking does not end it";
    EXPECT_EQ(mode(), 0640U);
  }
  pass();
  EXPECT_FALSE(port.clients().present());
  EXPECT_EQ(exclusive(), 0);
  EXPECT_EQ(mode(), 0640U);
}

// Even without a single hint, as when the user's watches are used up.
TEST(PtyClients, AreSeenByWhatIsOpen) {
  const auto opened = PtyPort::open("", 57600);
  ASSERT_TRUE(opened);
  PtyPort& port = **opened;
  rt::TimePoint now{};
  const auto present = [&] {
    port.update_clients(now);                             // notes the hints
    port.update_clients(now += std::chrono::seconds{1});  // looks
    port.update_clients(now += std::chrono::seconds{1});  // looks, without a hint
    return port.clients().present();
  };
  EXPECT_FALSE(present());
  const int first = open_quietly(port.device_path());
  EXPECT_TRUE(present());
  const int second = open_quietly(port.device_path());
  close(first);
  EXPECT_TRUE(present());
  close(second);
  EXPECT_FALSE(present());
  close(open_quietly(port.device_path()));
  EXPECT_FALSE(present());
}

// A program that closes descriptors it does not know, as in becoming a daemon, and then opens files
// of its own.
TEST(PtyClients, AreNotLookedForInOtherFiles) {
  auto opened = PtyPort::open("", 57600);
  ASSERT_TRUE(opened);
  EXPECT_TRUE((*opened)->intact());
  const int master = (*opened)->descriptor();
  const int others = open("/dev/null", O_RDWR | O_CLOEXEC);
  ASSERT_EQ(dup3(others, master, O_CLOEXEC), master);
  EXPECT_FALSE((*opened)->intact());
  (*opened)->disown();
  opened->reset();
  EXPECT_NE(fcntl(master, F_GETFD), -1) << "another's file is not closed";
  close(master);
  close(others);
}

}  // namespace
}  // namespace cargobay::hal::sim
