#include "hal/sim/remote/control_socket.hpp"

#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "tests/pty/control_client.hpp"
#include "tests/pty/serial_client.hpp"
#include "tests/pty/temporary_path.hpp"

namespace cargobay::hal::sim {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace): this folder's own helpers

struct Bench {
  Bench() : path{temporary_path("socket")}, link{temporary_path("port")} {
    auto opened = Server::open({}, {.link = link});
    if (!opened) return;
    server = std::move(*opened);
    if (server->start()) return;
    auto listening = ControlSocket::open(path, *server);
    if (!listening) return;
    socket = std::move(*listening);
    started = !socket->start();
  }
  std::string path;
  std::string link;
  std::unique_ptr<Server> server{};
  std::unique_ptr<ControlSocket> socket{};
  bool started = false;
};

TEST(ControlSocket, AnswersLineByLine) {
  Bench bench;
  ASSERT_TRUE(bench.started);
  const Caller caller{bench.path};
  ASSERT_TRUE(caller.connected());
  EXPECT_EQ(caller.ask("bump left"), "ok");
  EXPECT_EQ(caller.ask("nonsense").substr(0, 6), "error:");
  caller.send("wall on\nwall off\nsta");
  EXPECT_EQ(caller.receive(), "ok");
  EXPECT_EQ(caller.receive(), "ok");
  caller.send("te\n");
  EXPECT_EQ(caller.receive().substr(0, 8), "{\"mode\":");
}

TEST(ControlSocket, ReachesTheRobotThatAClientDrives) {
  Bench bench;
  ASSERT_TRUE(bench.started);
  const SerialClient client{bench.link};
  const Caller caller{bench.path};
  EXPECT_EQ(client.ask({128, 131, 142, 35}, 1), (Bytes{2}));
  EXPECT_EQ(caller.ask("wheeldrop caster on"), "ok");
  ASSERT_TRUE(eventually([&] { return bench.server->snapshot().mode == oi::Mode::passive; }));
  EXPECT_EQ(client.ask({142, 7}, 1), (Bytes{16}));
}

TEST(ControlSocket, TakesThePortAwayAndBringsItBack) {
  Bench bench;
  ASSERT_TRUE(bench.started);
  const Caller caller{bench.path};
  {
    const SerialClient client{bench.link};
    EXPECT_EQ(client.ask({128, 131, 142, 35}, 1), (Bytes{2}));
    EXPECT_EQ(caller.ask("fault unplugged"), "ok");
    std::uint8_t byte = 0;
    EXPECT_TRUE(eventually([&] {
      const ssize_t count = read(client.descriptor(), &byte, 1);
      return count == 0 || (count < 0 && errno == EIO);
    })) << "hung up";
  }
  EXPECT_FALSE(std::filesystem::exists(std::filesystem::symlink_status(bench.link)));
  EXPECT_EQ(caller.ask("state").substr(0, 15), "{\"mode\":\"safe\",");
  EXPECT_EQ(caller.ask("fault replugged"), "ok");
  const SerialClient again{bench.link};
  EXPECT_EQ(again.ask({142, 35}, 1), (Bytes{2})) << "the robot did not notice";
}

TEST(ControlSocket, TakesThePortAwayAndBringsItBackAtATime) {
  Bench bench;
  ASSERT_TRUE(bench.started);
  const Caller caller{bench.path};
  const SerialClient client{bench.link};
  EXPECT_EQ(client.ask({128, 131, 142, 35}, 1), (Bytes{2}));
  EXPECT_EQ(caller.ask("at 0 fault unplugged"), "ok");  // which is past
  std::uint8_t byte = 0;
  EXPECT_TRUE(eventually([&] {
    const ssize_t count = read(client.descriptor(), &byte, 1);
    return count == 0 || (count < 0 && errno == EIO);
  })) << "hung up";
  EXPECT_EQ(caller.ask("at 0 fault replugged"), "ok");
  ASSERT_TRUE(eventually([&] { return std::filesystem::exists(bench.link); }));
  const SerialClient again{bench.link};
  EXPECT_EQ(again.ask({142, 35}, 1), (Bytes{2})) << "the robot did not notice";
}

TEST(ControlSocket, BringsThePortBackWithTheEndOfAllFaults) {
  Bench bench;
  ASSERT_TRUE(bench.started);
  const Caller caller{bench.path};
  bench.server->with_cable([](Cable& cable) { cable.faults_to_host().unplugged = true; });
  for (const char* mended : {"fault replugged", "fault none"}) {
    EXPECT_EQ(caller.ask(mended), "ok");
    const SerialClient client{bench.link};
    EXPECT_EQ(client.ask({128, 142, 35}, 1), (Bytes{1})) << mended;
    EXPECT_EQ(caller.ask("fault unplugged"), "ok");
  }
}

TEST(ControlSocket, SurvivesWhatItCannotRead) {
  Bench bench;
  ASSERT_TRUE(bench.started);
  const Caller caller{bench.path};
  EXPECT_EQ(caller.ask(std::string(100'000, 'x')), "error: the line is too long");
  EXPECT_EQ(caller.ask(std::string{"\0\xff\x01", 3}).substr(0, 6), "error:");
  EXPECT_EQ(caller.ask("bump none"), "ok");
}

TEST(ControlSocket, ServesManyAtATimeAndOneAfterTheOther) {
  Bench bench;
  ASSERT_TRUE(bench.started);
  const Caller first{bench.path};
  for (int i = 0; i < 40; ++i) {
    const Caller next{bench.path};
    EXPECT_EQ(next.ask("bump none"), "ok");
  }
  EXPECT_EQ(first.ask("bump none"), "ok");
}

TEST(ControlSocket, IsForItsUserAlone) {
  Bench bench;
  ASSERT_TRUE(bench.started);
  struct stat status{};
  ASSERT_EQ(stat(bench.path.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777U, 0600U);
}

TEST(ControlSocket, IsRemovedWhenItStops) {
  Bench bench;
  ASSERT_TRUE(bench.started);
  bench.socket->stop();
  EXPECT_FALSE(std::filesystem::exists(bench.path));
}

TEST(ControlSocket, ReplacesOneThatNobodyListensTo) {
  Bench bench;
  ASSERT_TRUE(bench.started);
  const std::string stale = temporary_path("stale");
  const int left_behind = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::memcpy(address.sun_path, stale.data(), stale.size());
  ASSERT_GE(left_behind, 0);
  ASSERT_EQ(bind(left_behind, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  close(left_behind);
  EXPECT_TRUE(ControlSocket::open(stale, *bench.server));
}

TEST(ControlSocket, RefusesAPathThatIsTaken) {
  Bench bench;
  ASSERT_TRUE(bench.started);
  const auto in_use = ControlSocket::open(bench.path, *bench.server);
  ASSERT_FALSE(in_use);
  EXPECT_NE(in_use.failure().message.find(bench.path), std::string::npos);
  const std::string file = temporary_path("file");
  std::ofstream{file} << "somebody's";
  EXPECT_FALSE(ControlSocket::open(file, *bench.server));
  EXPECT_TRUE(std::filesystem::is_regular_file(file));
  std::filesystem::remove(file);
  EXPECT_FALSE(ControlSocket::open(std::string(200, 'x'), *bench.server));
  EXPECT_FALSE(ControlSocket::open("/nowhere/at/all", *bench.server));
}

}  // namespace
}  // namespace cargobay::hal::sim
