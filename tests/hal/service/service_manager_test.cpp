#include "hal/service/service_manager.hpp"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cargobay::hal {
namespace {

using std::chrono::milliseconds;
using testing::ElementsAre;
using testing::IsEmpty;

// Listens as systemd does, at an abstract address or, in `folder`, at a path.
class ServiceManagerTest : public testing::Test {
 protected:
  void TearDown() override {
    for (const char* name : {"NOTIFY_SOCKET", "WATCHDOG_USEC", "WATCHDOG_PID"})
      unsetenv(name);  // NOLINT(concurrency-mt-unsafe): one thread
    if (!path_.empty()) unlink(path_.c_str());
  }
  static void set(const char* name, const std::string& value) {
    setenv(name, value.c_str(), 1);  // NOLINT(concurrency-mt-unsafe): one thread
  }

  void listen(const std::string& address) {
    sockaddr_un at{};
    at.sun_family = AF_UNIX;
    std::memcpy(at.sun_path, address.data(), address.size());
    if (address[0] == '@') at.sun_path[0] = '\0';
    socket_ = Descriptor{socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)};
    ASSERT_EQ(bind(socket_.number(), reinterpret_cast<const sockaddr*>(&at),
                   static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + address.size())),
              0);
    set("NOTIFY_SOCKET", address);
  }
  void listen() { listen("@cargobay-test-" + std::to_string(getpid())); }

  std::vector<std::string> heard() const {
    std::vector<std::string> lines;
    std::array<char, 1000> bytes{};
    for (;;) {
      const ssize_t count = recv(socket_.number(), bytes.data(), bytes.size(), MSG_DONTWAIT);
      if (count <= 0) return lines;
      lines.emplace_back(bytes.data(), static_cast<std::size_t>(count));
    }
  }

  std::string path_;
  Descriptor socket_{};
};

TEST_F(ServiceManagerTest, IsToldHowTheServiceIs) {
  listen();
  ServiceManager manager;
  manager.ready();
  manager.status("serving\nthe robot");
  manager.stopping();
  EXPECT_THAT(heard(), ElementsAre("READY=1", "STATUS=serving the robot", "STOPPING=1"));
}

TEST_F(ServiceManagerTest, MayListenAtAPath) {
  path_ = "/tmp/cargobay-test-" + std::to_string(getpid());
  listen(path_);
  ServiceManager{}.ready();
  EXPECT_THAT(heard(), ElementsAre("READY=1"));
}

TEST_F(ServiceManagerTest, HearsASignOfLifeTwiceInEachInterval) {
  listen();
  set("WATCHDOG_USEC", "2000000");
  set("WATCHDOG_PID", std::to_string(getpid()));
  ServiceManager manager;
  const rt::TimePoint begin{};
  for (int ms = 0; ms < 3000; ms += 50) manager.alive(begin + milliseconds{ms});
  EXPECT_THAT(heard(), ElementsAre("WATCHDOG=1", "WATCHDOG=1", "WATCHDOG=1"));
}

TEST_F(ServiceManagerTest, HearsNoSignOfLifeThatIsMeantForAnotherProcess) {
  listen();
  set("WATCHDOG_USEC", "2000000");
  set("WATCHDOG_PID", "1");
  ServiceManager{}.alive(rt::TimePoint{});
  EXPECT_THAT(heard(), IsEmpty());
}

TEST_F(ServiceManagerTest, HearsNoSignOfLifeIfItAskedForNone) {
  listen();
  for (const char* interval : {"", "0", "-1", "soon", "1s"}) {
    set("WATCHDOG_USEC", interval);
    ServiceManager{}.alive(rt::TimePoint{});
    EXPECT_THAT(heard(), IsEmpty()) << interval;
  }
}

TEST_F(ServiceManagerTest, IsNotMissed) {
  const std::string too_long = "/" + std::string(sizeof(sockaddr_un::sun_path), 'x');
  for (const std::string& address : {std::string{}, std::string{"@"}, std::string{"relative"},
                                     std::string{"/nobody/listens"}, too_long}) {
    set("NOTIFY_SOCKET", address);
    ServiceManager manager;
    manager.ready();
    manager.status("nobody listens");
  }
}

TEST_F(ServiceManagerTest, DoesNotHoldTheServiceUp) {
  listen();
  ServiceManager manager;
  for (int i = 0; i < 5000; ++i) manager.status("more than the socket takes");
  EXPECT_LT(heard().size(), 5000U);
}

}  // namespace
}  // namespace cargobay::hal
