// Publishes what a driving process knows, for others on this machine (docs/feed.md): a Unix socket
// by the port's name, served by an ordinary thread. The loop leaves what it has in rings and knows
// nothing of it; while nobody reads, the thread sleeps.
#pragma once

#include <poll.h>

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "hal/feed/feed_connection.hpp"
#include "hal/feed/feed_desk.hpp"
#include "hal/feed/feed_reports.hpp"
#include "hal/feed/message/messages.hpp"
#include "hal/file/port_descriptor.hpp"
#include "hal/file/unix_listener.hpp"
#include "hal/result.hpp"
#include "rt/clock.hpp"

namespace cargobay::hal {

struct RobotOptions;

struct FeedOptions {
  FeedIdentity of{};
  std::string name{};  // of its socket; empty: by the port
  FeedSteering steering{};
  sim::Server* create = nullptr;      // that is driven, or null; outlives the feed
  const sim::World* world = nullptr;  // likewise
};

class Feed {
 public:
  static constexpr std::size_t kMostClients = 64;

  // Listens, and starts the thread. Blocks for the file system; allocates. After a failure nothing
  // is left; its message says what to do.
  static Result<std::unique_ptr<Feed>> open(FeedOptions options);
  // Tells the readers that it has ended, and removes the socket. Whoever steers no longer does.
  ~Feed();
  Feed(const Feed&) = delete;
  Feed& operator=(const Feed&) = delete;

  // A robot opened with these options leaves what it knows for this feed, and may outlive it.
  void attach_to(RobotOptions& options) const;
  const std::string& socket() const { return listener_.path(); }

  // The functions below are for any thread. They lock, and wait for a message being made.

  // Tells of this robot until leave(), which comes before the robot's end.
  // Then nobody has the lease any longer.
  void follow(Robot& robot);
  void leave();
  // For people: `stage` is one of docs/feed.md.
  void report(const std::string& stage, const std::string& text);

 private:
  Feed(FeedOptions options, UnixListener listener, PortDescriptor wake);

  void run();
  void wait(std::vector<pollfd>& sources) const;
  void say_farewell();
  void serve(const std::vector<pollfd>& sources, rt::TimePoint now);
  void accept_client(rt::TimePoint now);
  void remove(std::uint64_t number);
  static void tell_one(FeedConnection& client, const std::string& message);
  void tell_all(FeedType type, JsonObject message);
  void lose(FeedType type, std::uint64_t count);
  void collect(rt::TimePoint now);
  void tell_status();
  void tell_holder();
  void tell_watched(rt::TimePoint now);
  FeedReports::Readers readers() const;
  void wake() const;

  FeedOptions options_;
  std::shared_ptr<FeedTap> tap_;
  UnixListener listener_;
  PortDescriptor wake_;  // an eventfd: ends the thread's sleep
  // Belong to the thread.
  FeedDesk desk_;
  FeedReports reports_;
  std::vector<std::unique_ptr<FeedConnection>> clients_{};
  std::uint64_t told_lease_ = 0;
  bool told_watched_ = false;
  std::uint64_t sequence_ = 0;       // of the newest message
  rt::TimePoint next_tick_{};        // when to collect what is new, if somebody listens
  std::uint64_t connected_ = 0;      // clients, ever
  std::uint64_t missed_before_ = 0;  // by clients that are gone
  rt::TimePoint accept_again_{};     // descriptors ran out: accept none before this time
  // Shared with those who call.
  std::mutex mutex_;
  Robot* robot_ = nullptr;
  std::string stage_ = "bring_up";
  std::string text_{};
  std::atomic<bool> robot_left_{false};  // since the thread last looked
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

}  // namespace cargobay::hal
