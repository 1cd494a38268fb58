#include "hal/feed/feed.hpp"

#include <poll.h>
#include <pthread.h>
#include <sched.h>
#include <sys/eventfd.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <ctime>
#include <functional>
#include <utility>

#include "hal/feed/feed_place.hpp"
#include "hal/file/left_behind.hpp"
#include "hal/machine/masked_thread.hpp"
#include "hal/robot/robot.hpp"
#include "oi/limits.hpp"

namespace cargobay::hal {

namespace {

constexpr rt::Duration kTimeToChoose = std::chrono::milliseconds{200};
constexpr rt::Duration kRefusalPause = std::chrono::milliseconds{100};
// If the program closes our descriptors, nothing else wakes the thread.
constexpr rt::Duration kLongestSleep = std::chrono::seconds{10};
constexpr timespec kPauseIfRefused{.tv_sec = 0, .tv_nsec = 15'000'000};
// Who may connect: the owner; in the folder of a service also its group.
constexpr mode_t kSocketRights = S_IRUSR | S_IWUSR | S_IRGRP | S_IWGRP;

Result<UnixListener> listen_at(const std::string& path) {
  auto listener = UnixListener::open(path, kSocketRights);
  const bool gone = !listener && listener.failure().code == std::errc::no_such_file_or_directory;
  // The last feed in the folder may just have ended, and removed it.
  if (gone && feed_folder()) return UnixListener::open(path, kSocketRights);
  return listener;
}

Result<UnixListener> listen_in(const std::string& folder, const FeedOptions& options) {
  const std::string name = options.name.empty() ? feed_name(options.of.port) : options.name;
  auto listener = listen_at(folder + "/" + name);
  const bool too_long = !listener && listener.failure().code == std::errc::filename_too_long;
  if (!too_long || !options.name.empty()) return listener;
  // Readers find it by the port that it tells.
  return listen_at(folder + "/port-" + std::to_string(std::hash<std::string>{}(name)));
}

}  // namespace

Result<std::unique_ptr<Feed>> Feed::open(FeedOptions options) {
  const auto folder = feed_folder();
  if (!folder) return folder.failure();
  const int made = eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
  if (made < 0) {
    const std::error_code code{errno, std::generic_category()};
    return Failure{.message = "no eventfd for the feed: " + code.message() + "; " +
                              remedy_for(code.value(), "free some memory"),
                   .code = code};
  }
  options.of.port = lasting_name(options.of.port);
  PortDescriptor wake = PortDescriptor::adopt(made);
  auto listener = listen_in(*folder, options);
  if (!listener) return listener.failure();
  options.of.lease = FeedDesk::kLease;
  options.of.steerable = static_cast<bool>(options.steering.drive);
  std::unique_ptr<Feed> feed{new Feed{std::move(options), std::move(*listener), std::move(wake)}};
  if (const auto error = start_masked(feed->thread_, [feed = feed.get()] { feed->run(); })) {
    return Failure{.message = "no thread for the feed: " + error.message() +
                              "; raise the limit of processes (ulimit -u)",
                   .code = error};
  }
  return feed;
}

Feed::Feed(FeedOptions options, UnixListener listener, PortDescriptor wake)
    : options_{std::move(options)},
      tap_{std::make_shared<FeedTap>()},
      listener_{std::move(listener)},
      wake_{std::move(wake)},
      desk_{options_.steering, options_.of.wheel_base_mm},
      reports_{{.tap = tap_.get(),
                .create = options_.create,
                .world = options_.world,
                .wheel_base_mm = options_.of.wheel_base_mm}} {}

Feed::~Feed() {
  stopping_.store(true, std::memory_order_relaxed);  // the wake-up below orders it
  wake();
  if (thread_.joinable()) thread_.join();
  const std::string path = listener_.path();
  listener_.close();
  leave_folder(path.substr(0, path.rfind('/')));
}

void Feed::wake() const {
  if (!wake_.still_open()) return;  // the program has closed it: this is a file of its own
  const std::uint64_t one = 1;
  (void)!::write(wake_.number(), &one, sizeof one);  // even if the counter is full, this wakes
}

void Feed::attach_to(RobotOptions& options) const {
  options.observers.push_back(tap_->observer());
  options.memory.push_back(tap_->memory());
  options.kept.push_back(tap_);
}

void Feed::follow(Robot& robot) {
  const std::lock_guard lock{mutex_};
  robot_ = &robot;
}

void Feed::leave() {
  {
    const std::lock_guard lock{mutex_};
    robot_ = nullptr;
  }
  robot_left_.store(true, std::memory_order_relaxed);  // the wake-up below orders it
  wake();
}

void Feed::report(const std::string& stage, const std::string& text) {
  {
    const std::lock_guard lock{mutex_};
    stage_ = stage;
    text_ = text;
  }
  wake();
}

void Feed::run() {
  // Who opened it may be a real-time thread, which this one would take after.
  const sched_param ordinary{};
  (void)pthread_setschedparam(pthread_self(), SCHED_OTHER, &ordinary);
  std::vector<pollfd> sources;
  while (!stopping_.load(std::memory_order_relaxed)) {
    wait(sources);
    const rt::TimePoint now = rt::Clock::now();
    if ((sources[0].revents & POLLNVAL) != 0) break;  // the program has closed it
    std::uint64_t count = 0;
    if (sources[0].revents != 0 && ::read(wake_.number(), &count, sizeof count) > 0) tell_status();
    // Whoever steered asks again: what drives next is not the loop that they steered.
    if (robot_left_.exchange(false, std::memory_order_relaxed)) desk_.revoke();
    serve(sources, now);
    desk_.expire(now);
    tell_holder();
    tell_watched(now);
    if (now >= next_tick_ && !clients_.empty()) {
      next_tick_ = std::max(next_tick_ + oi::kTick, now);
      collect(now);
    }
    if (sources[1].revents != 0) accept_client(now);
  }
  say_farewell();
}

// Until there is something to do: `sources` are, in order, wake-up, listener, clients.
void Feed::wait(std::vector<pollfd>& sources) const {
  const rt::TimePoint now = rt::Clock::now();
  rt::TimePoint until = clients_.empty() ? now + kLongestSleep : next_tick_;
  if (desk_.lease().until()) until = std::min(until, *desk_.lease().until());
  const bool paused = now < accept_again_;
  if (paused) until = std::min(until, accept_again_);
  sources = {{.fd = wake_.number(), .events = POLLIN, .revents = 0},
             {.fd = paused ? -1 : listener_.descriptor(), .events = POLLIN, .revents = 0}};
  for (const auto& client : clients_)
    sources.push_back({.fd = client->descriptor(), .events = client->events(), .revents = 0});
  const timespec timeout = rt::as_timespec(std::max(until - now, rt::Duration::zero()));
  if (ppoll(sources.data(), sources.size(), &timeout, nullptr) >= 0) return;
  const bool refused = errno != EINTR;
  if (refused) nanosleep(&kPauseIfRefused, nullptr);
  // So many descriptors are too many, as above a lowered limit of open files: every client is
  // served now and then instead.
  for (pollfd& source : sources) source.revents = refused ? source.events : short{0};
}

void Feed::say_farewell() {
  {
    const std::lock_guard lock{mutex_};
    if (stage_ != "lost" && stage_ != "ended") text_.clear();  // it was about what went on
    stage_ = "ended";
  }
  for (const auto& client : clients_) desk_.leave(client->number());
  tell_status();
  clients_.clear();
}

// Takes what the clients have sent, and drops those that are gone.
void Feed::serve(const std::vector<pollfd>& sources, rt::TimePoint now) {
  std::vector<std::uint64_t> gone;
  for (std::size_t i = 0; i < clients_.size() && i + 2 < sources.size(); ++i) {
    FeedConnection& client = *clients_[i];
    const short events = sources[i + 2].revents;
    bool there = true;
    if ((events & (POLLIN | POLLHUP | POLLERR)) != 0) {
      there = client.receive([&](std::string_view line) {
        if (const auto answer = desk_.hear(client, line, now)) tell_one(client, *answer);
        tell_holder();  // the next line may change it again
      });
    }
    if (!there || !client.flush()) gone.push_back(client.number());
  }
  for (const std::uint64_t number : gone) remove(number);
}

void Feed::remove(std::uint64_t number) {
  desk_.leave(number);
  std::erase_if(clients_, [&](const auto& client) {
    if (client->number() != number) return false;
    missed_before_ += client->missed();
    return true;
  });
  accept_again_ = {};  // its descriptor is free now
}

void Feed::accept_client(rt::TimePoint now) {
  Descriptor socket = listener_.accept();
  if (socket.number() < 0) {
    const bool retry = errno == EAGAIN || errno == EINTR || errno == ECONNABORTED;
    if (!retry) accept_again_ = now + kRefusalPause;
    return;
  }
  auto client = std::make_unique<FeedConnection>(std::move(socket), ++connected_, now);
  if (clients_.size() >= kMostClients) {
    tell_one(*client, R"({"type":"answer","id":null,"ok":false,"error":")" +
                          std::to_string(kMostClients) +
                          R"( programs are connected, which is the most; end one"})");
    (void)client->flush();
    return;
  }
  if (clients_.empty()) reports_.skip();
  JsonObject hello = message(FeedType::hello, sequence_);
  put_hello(hello, options_.of);
  tell_one(*client, hello.take());
  const FeedOutlet to_one{
      .begin = [this](FeedType type) { return message(type, sequence_); },
      .tell = [&](FeedType, JsonObject message) { tell_one(*client, message.take()); },
      .lost = nullptr};  // what was before it came is not missed
  {
    const std::lock_guard lock{mutex_};
    JsonObject status = message(FeedType::status, sequence_);
    put_status(status, stage_, text_);
    tell_one(*client, status.take());
    reports_.greet(robot_, readers(), to_one);
  }
  JsonObject holder = message(FeedType::holder, sequence_);
  put_holder(holder, desk_.lease().name(), desk_.lease().number());
  tell_one(*client, holder.take());
  (void)client->flush();  // one that is gone is noticed when it is polled
  clients_.push_back(std::move(client));
}

void Feed::tell_one(FeedConnection& client, const std::string& message) {
  client.put(
      {.type = FeedType::answer, .line = std::make_shared<const std::string>(message + "\n")});
}

void Feed::tell_all(FeedType type, JsonObject message) {
  const FeedMessage all{.type = type,
                        .line = std::make_shared<const std::string>(message.take() + "\n")};
  for (const auto& client : clients_) client->put(all);
}

void Feed::lose(FeedType type, std::uint64_t count) {
  sequence_ += count;
  for (const auto& client : clients_) client->lose(type, count);
}

void Feed::collect(rt::TimePoint now) {
  const FeedOutlet to_all{
      .begin = [this](FeedType type) { return message(type, ++sequence_); },
      .tell = [this](FeedType type, JsonObject message) { tell_all(type, std::move(message)); },
      .lost = [this](FeedType type, std::uint64_t count) { lose(type, count); }};
  {
    const std::lock_guard lock{mutex_};
    reports_.collect(robot_, readers(), now, to_all);
  }
  std::vector<std::uint64_t> gone;
  for (const auto& client : clients_) {
    if (!client->flush()) gone.push_back(client->number());
  }
  for (const std::uint64_t number : gone) remove(number);
}

void Feed::tell_status() {
  JsonObject status = message(FeedType::status, ++sequence_);
  {
    const std::lock_guard lock{mutex_};
    put_status(status, stage_, text_);
  }
  tell_all(FeedType::status, std::move(status));
  for (const auto& client : clients_) (void)client->flush();
}

void Feed::tell_holder() {
  if (desk_.lease().number() == told_lease_) return;
  told_lease_ = desk_.lease().number();
  JsonObject holder = message(FeedType::holder, ++sequence_);
  put_holder(holder, desk_.lease().name(), desk_.lease().number());
  tell_all(FeedType::holder, std::move(holder));
}

// One that has just come gets everything until it has said what it wants.
void Feed::tell_watched(rt::TimePoint now) {
  const bool watched = std::ranges::any_of(clients_, [now](const auto& client) {
    return client->wants(FeedType::sensors) && now - client->since() >= kTimeToChoose;
  });
  if (watched == told_watched_ || !options_.steering.watch) return;
  if (options_.steering.watch(watched)) told_watched_ = watched;
}

FeedReports::Readers Feed::readers() const {
  std::uint64_t missed = missed_before_;
  for (const auto& client : clients_) missed += client->missed();
  return {.clients = clients_.size(), .missed = missed};
}

}  // namespace cargobay::hal
