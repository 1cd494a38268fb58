// The control socket when its process, its clients or their number reach a limit.
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <algorithm>
#include <ctime>
#include <filesystem>
#include <memory>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "hal/sim/remote/control_socket.hpp"
#include "tests/pty/control_client.hpp"
#include "tests/pty/serial_client.hpp"
#include "tests/pty/temporary_path.hpp"

namespace cargobay::hal::sim {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace): this folder's own helpers

struct Desk {
  Desk() : path{temporary_path("desk")} {
    auto opened = Server::open({}, {});
    if (!opened) return;
    server = std::move(*opened);
    auto listening = ControlSocket::open(path, *server);
    if (!listening) return;
    socket = std::move(*listening);
    started = !socket->start();
  }
  std::string path;
  std::unique_ptr<Server> server{};  // not started: it takes no time
  std::unique_ptr<ControlSocket> socket{};
  bool started = false;
};

// Nothing can be opened while this lives.
class NoMoreDescriptors {
 public:
  NoMoreDescriptors() {
    getrlimit(RLIMIT_NOFILE, &before_);
    const int next = open("/dev/null", O_RDONLY | O_CLOEXEC);
    close(next);
    const rlimit now{.rlim_cur = static_cast<rlim_t>(next), .rlim_max = before_.rlim_max};
    setrlimit(RLIMIT_NOFILE, &now);
  }
  ~NoMoreDescriptors() { setrlimit(RLIMIT_NOFILE, &before_); }
  NoMoreDescriptors(const NoMoreDescriptors&) = delete;
  NoMoreDescriptors& operator=(const NoMoreDescriptors&) = delete;

 private:
  rlimit before_{};
};

// The CPU time of this process during half a second, as a fraction.
double busy_part() {
  const auto seconds = [](clockid_t clock) {
    timespec time{};
    clock_gettime(clock, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  };
  const double computed = seconds(CLOCK_PROCESS_CPUTIME_ID);
  const double passed = seconds(CLOCK_MONOTONIC);
  poll(nullptr, 0, 500);
  return (seconds(CLOCK_PROCESS_CPUTIME_ID) - computed) / (seconds(CLOCK_MONOTONIC) - passed);
}

constexpr double kIdle = 0.2;

using Callers = std::vector<std::unique_ptr<Caller>>;

Callers connect(const std::string& path, std::size_t count) {
  Callers callers;
  for (std::size_t i = 0; i < count; ++i) callers.push_back(std::make_unique<Caller>(path));
  return callers;
}

TEST(ControlSocketLimits, WaitsWhenDescriptorsHaveRunOutAndGoesOnWhenTheyAreThere) {
  const Desk desk;
  ASSERT_TRUE(desk.started);
  const Caller served{desk.path};
  EXPECT_EQ(served.ask("bump none"), "ok");
  std::vector<std::unique_ptr<Caller>> late;
  {
    // Their own descriptors exist; the one that accepting would take does not.
    const int spare = open("/dev/null", O_RDONLY | O_CLOEXEC);
    const NoMoreDescriptors limit;
    close(spare);
    late = connect(desk.path, 1);
    ASSERT_TRUE(late[0]->connected());
    EXPECT_LT(busy_part(), kIdle);
    EXPECT_EQ(served.ask("bump none"), "ok") << "who is connected is served";
    late[0]->send("bump left\n");
  }
  EXPECT_EQ(late[0]->receive(), "ok");
}

TEST(ControlSocketLimits, AcceptsTheNextAsSoonAsOneHasLeft) {
  const Desk desk;
  ASSERT_TRUE(desk.started);
  auto first = std::make_unique<Caller>(desk.path);
  EXPECT_EQ(first->ask("bump none"), "ok");
  const int spare = open("/dev/null", O_RDONLY | O_CLOEXEC);
  const NoMoreDescriptors limit;
  close(spare);
  const Caller next{desk.path};
  first.reset();
  EXPECT_EQ(next.ask("bump none"), "ok");
}

TEST(ControlSocketLimits, WaitsUnderALimitBelowWhatIsOpen) {
  const Desk desk;
  ASSERT_TRUE(desk.started);
  const Caller caller{desk.path};
  EXPECT_EQ(caller.ask("bump none"), "ok");
  rlimit before{};
  getrlimit(RLIMIT_NOFILE, &before);
  const rlimit none{.rlim_cur = 0, .rlim_max = before.rlim_max};
  setrlimit(RLIMIT_NOFILE, &none);
  caller.send("bump left\n");  // which wakes it; poll() is refused from now on
  const std::string answer = caller.receive();
  const double busy = busy_part();
  setrlimit(RLIMIT_NOFILE, &before);
  EXPECT_EQ(answer, "ok");
  EXPECT_LT(busy, kIdle);
}

TEST(ControlSocketLimits, SaysThatNoMoreClientsFit) {
  const Desk desk;
  ASSERT_TRUE(desk.started);
  Callers callers = connect(desk.path, 16);
  for (const auto& caller : callers) EXPECT_EQ(caller->ask("bump none"), "ok");
  const Caller one_more{desk.path};
  EXPECT_EQ(one_more.receive(),
            "error: 16 clients are connected, which is the most; disconnect one");
  EXPECT_EQ(one_more.receive(), "") << "hung up";
  callers.pop_back();
  EXPECT_TRUE(eventually([&] { return Caller{desk.path}.ask("bump none") == "ok"; }));
  EXPECT_EQ(callers[0]->ask("bump none"), "ok");
}

// More answers than a socket holds. Others do not wait for a client that takes none of them.
TEST(ControlSocketLimits, ServesOthersWhileOneDoesNotTakeItsAnswers) {
  const Desk desk;
  ASSERT_TRUE(desk.started);
  const Caller deaf{desk.path};
  std::string lines;
  for (int i = 0; i < 10'000; ++i) lines += "state\n";
  std::thread shouting{[&] { deaf.send(lines); }};  // waits for room itself
  const Caller other{desk.path};
  int served = 0;
  for (int i = 0; i < 20; ++i) served += other.ask("bump none") == "ok" ? 1 : 0;
  EXPECT_EQ(served, 20);
  shouting.join();  // it is disconnected: what it sends goes nowhere
  EXPECT_EQ(other.ask("bump none"), "ok");
}

TEST(ControlSocketLimits, AnswersAllOfAClientThatReadsLate) {
  const Desk desk;
  ASSERT_TRUE(desk.started);
  const Caller caller{desk.path};
  constexpr int kLines = 300;
  std::string lines;
  for (int i = 0; i < kLines; ++i) lines += i % 2 == 0 ? "state\n" : "bump none\n";
  caller.send(lines);
  int right = 0;
  for (int i = 0; i < kLines; ++i) {
    const std::string answer = caller.receive();
    right += (i % 2 == 0 ? answer.starts_with("{\"mode\":") : answer == "ok") ? 1 : 0;
  }
  EXPECT_EQ(right, kLines);
}

TEST(ControlSocketLimits, AnswersAClientThatHasSaidAllItWill) {
  const Desk desk;
  ASSERT_TRUE(desk.started);
  {
    const Caller caller{desk.path};
    caller.send("bump left\nstate\nbump no");
    caller.shut_down(SHUT_WR);
    EXPECT_EQ(caller.receive(), "ok");
    EXPECT_TRUE(caller.receive().starts_with("{\"mode\":"));
    EXPECT_EQ(caller.receive(), "error: the last line does not end; send a line feed after each");
    EXPECT_EQ(caller.receive(), "") << "hung up";
  }
  const Caller deaf{desk.path};
  deaf.shut_down(SHUT_RD);
  deaf.send("state\nstate\n");
  EXPECT_LT(busy_part(), kIdle);
  EXPECT_EQ(Caller{desk.path}.ask("bump none"), "ok");
}

TEST(ControlSocketLimits, TakesHalfALineWithoutEnd) {
  const Desk desk;
  ASSERT_TRUE(desk.started);
  const Caller endless{desk.path};
  for (int i = 0; i < 1000; ++i) endless.send(std::string(4096, 'x'));
  EXPECT_EQ(Caller{desk.path}.ask("bump none"), "ok");
  EXPECT_EQ(endless.ask(""), "error: the line is too long");
  EXPECT_EQ(endless.ask("bump none"), "ok");
}

TEST(ControlSocketLimits, IsOfOneAloneOfManyThatWantItAtOnce) {
  const Desk desk;
  ASSERT_TRUE(desk.started);
  const std::string path = temporary_path("wanted");
  for (int round = 0; round < 50; ++round) {
    {
      const auto stale = ControlSocket::open(path, *desk.server);
      ASSERT_TRUE(stale) << stale.failure().message;
      ASSERT_EQ(rename(path.c_str(), (path + ".kept").c_str()), 0);
    }
    ASSERT_EQ(rename((path + ".kept").c_str(), path.c_str()), 0) << "left by who is gone";
    std::vector<std::unique_ptr<ControlSocket>> sockets(4);
    std::vector<std::thread> threads;
    threads.reserve(sockets.size());
    for (auto& socket : sockets) {
      threads.emplace_back([&] {
        if (auto opened = ControlSocket::open(path, *desk.server)) socket = std::move(*opened);
      });
    }
    for (std::thread& thread : threads) thread.join();
    std::erase(sockets, nullptr);
    ASSERT_EQ(sockets.size(), 1U) << "round " << round;
    sockets.clear();
    ASSERT_FALSE(std::filesystem::exists(path));
  }
}

// Another process that put a socket in our place keeps it.
TEST(ControlSocketLimits, RemovesNothingButItsOwn) {
  const Desk desk;
  ASSERT_TRUE(desk.started);
  std::filesystem::remove(desk.path);
  const auto other = ControlSocket::open(desk.path, *desk.server);
  ASSERT_TRUE(other);
  desk.socket->stop();
  EXPECT_TRUE(std::filesystem::exists(desk.path));
}

// A program that this process starts inherits nothing that the virtual Create has open.
TEST(ControlSocketLimits, KeepsItsDescriptorsToItsOwnProcess) {
  const auto inherited = [] {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator{"/proc/self/fd"}) {
      const int descriptor = std::stoi(entry.path().filename().string());
      const int flags = fcntl(descriptor, F_GETFD);
      if (flags >= 0 && (flags & FD_CLOEXEC) == 0)
        names.push_back(entry.path().filename().string());
    }
    std::sort(names.begin(), names.end());
    return names;
  };
  const auto before = inherited();
  const Desk desk;
  ASSERT_TRUE(desk.started);
  ASSERT_FALSE(desk.server->start());
  const SerialClient client{desk.server->path()};
  EXPECT_EQ(client.ask({128, 142, 35}, 1), (Bytes{1}));
  const Caller caller{desk.path};
  EXPECT_EQ(caller.ask("fault unplugged"), "ok");
  EXPECT_EQ(caller.ask("fault replugged"), "ok");
  EXPECT_EQ(inherited(), before);
}

}  // namespace
}  // namespace cargobay::hal::sim
