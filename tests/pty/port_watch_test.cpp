// Who is named when frames go missing. The port is a file here, and its users are shells.
#include "hal/robot/port_watch.hpp"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <thread>

#include <gtest/gtest.h>

namespace cargobay::hal {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

class PortWatchTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (std::filesystem::temp_directory_path() / "cargobay-XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
    port_ = folder_ / "ttyUSB0";
    std::ofstream{port_} << "";
    ASSERT_FALSE(watch_.start(
        port_.string(), [this] { return PortWatch::Progress{.missed = missed_, .tick = 7}; }));
  }
  void TearDown() override {
    watch_.stop();
    std::filesystem::remove_all(folder_);
  }
  // Has the port open for a second.
  pid_t open_for_a_second() const {
    std::string shell = "sh";
    std::string option = "-c";
    std::string script = "exec 3<" + port_.string() + "; sleep 1; :";
    char* const words[] = {shell.data(), option.data(), script.data(), nullptr};
    pid_t process = -1;
    EXPECT_EQ(posix_spawn(&process, "/bin/sh", nullptr, nullptr, words, environ), 0);
    return process;
  }
  static void wait_for_its_end(pid_t process) { waitpid(process, nullptr, 0); }
  // Within a minute, but at once if it is there.
  std::optional<Event> next() {
    const rt::TimePoint limit = rt::Clock::now() + seconds{60};
    Event event;
    while (rt::Clock::now() < limit) {
      if (watch_.next(event)) return event;
      std::this_thread::sleep_for(milliseconds{10});
    }
    return std::nullopt;
  }

  std::filesystem::path folder_;
  std::filesystem::path port_;
  std::atomic<std::uint64_t> missed_ = 0;
  PortWatch watch_;
};

TEST_F(PortWatchTest, NamesAProcessThatHasEndedByTheTimeFramesAreMissed) {
  const pid_t process = open_for_a_second();
  wait_for_its_end(process);
  Event event;
  EXPECT_FALSE(watch_.next(event)) << "no frame was missed";
  missed_ = 1;
  const auto named = next();
  ASSERT_TRUE(named);
  EXPECT_EQ(named->what, EventKind::port_shared);
  EXPECT_EQ(named->process, process);
  EXPECT_STREQ(named->process_name.data(), "sh");
  EXPECT_EQ(named->tick, 7);
  EXPECT_NE(describe(*named).find("opened the port for a moment"), std::string::npos);
}

}  // namespace
}  // namespace cargobay::hal
