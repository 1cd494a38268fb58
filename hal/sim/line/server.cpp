#include "hal/sim/line/server.hpp"

#include <poll.h>
#include <pthread.h>
#include <sched.h>
#include <sys/eventfd.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <ctime>
#include <span>

#include "hal/file/left_behind.hpp"
#include "hal/machine/masked_thread.hpp"

namespace cargobay::hal::sim {

namespace {

// If the thread is further behind than this, as after SIGSTOP, the robot has stood still too.
constexpr rt::Duration kLongestLag = std::chrono::seconds{1};
// The longest piece to catch up in at once: it must not fill the room for bytes at the fastest
// rate.
constexpr rt::Duration kCatchUpPiece = std::chrono::milliseconds{50};
// Time between two looks for writes, if their spacing matters: half of it.
constexpr rt::Duration kLookForWrites = oi::kByteSpacingAt115200 / 2;

}  // namespace

Result<std::unique_ptr<Server>> Server::open(const Parameters& parameters,
                                             const ServerOptions& options) {
  Result<std::unique_ptr<PtyPort>> port = PtyPort::open(options.link, parameters.boot_baud);
  if (!port) return port.failure();
  const int wake_descriptor = eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
  if (wake_descriptor < 0) {
    const std::error_code code{errno, std::generic_category()};
    return Failure{.message = "no eventfd for the virtual Create: " + code.message() + "; " +
                              remedy_for(code.value(), "free some memory"),
                   .code = code};
  }
  return std::unique_ptr<Server>{
      new Server{parameters, options, std::move(*port), wake_descriptor}};
}

Server::Server(const Parameters& parameters, const ServerOptions& options,
               std::unique_ptr<PtyPort> port, int wake_descriptor)
    : options_{options},
      wake_descriptor_{wake_descriptor},
      port_{std::move(port)},
      device_{parameters},
      cable_{device_},
      truth_{std::max<std::size_t>(options.truth_samples, 1)} {
  cable_.on_plug = [this](bool plugged) { plug_ = plugged; };
  device_.on_tick = [this](const Device& device) {
    if (truth_.full()) truth_.pop_front();
    (void)truth_.push_back({.time = monotonic(device.now()),  // has room: reserved above
                            .speeds = device.truth().speeds,
                            .commanded = device.commanded(),
                            .mode = device.mode()});
    newest_truth_.put(
        {.time = device.now(), .pose = device.truth().pose, .speeds = device.truth().speeds});
    if (options_.on_tick) options_.on_tick(device);
  };
}

Server::~Server() {
  stop();
  if (!lost_.load(std::memory_order_relaxed)) close(wake_descriptor_);
}

std::error_code Server::start() {
  power_on_ = rt::Clock::now();
  const std::error_code error = start_masked(thread_, [this] { run(); });
  if (!error && options_.priority > 0) {
    const sched_param parameters{.sched_priority = options_.priority};
    priority_error_ = pthread_setschedparam(thread_.native_handle(), SCHED_FIFO, &parameters);
  }
  return error;
}

void Server::stop() {
  if (thread_.joinable()) {
    stopping_.store(true, std::memory_order_relaxed);  // the wake-up below orders it
    wake();
    thread_.join();
  }
  unplug();
}

std::string Server::path() const {
  const std::lock_guard lock{mutex_};
  return port_ ? port_->path() : std::string{};
}

void Server::lose_descriptors() {
  port_->disown();
  port_.reset();
  change_.end();
  if (spacing_) spacing_->writes.disown();
  spacing_.reset();
  lost_.store(true,
              std::memory_order_relaxed);  // readers tolerate it late, or join first
  stopping_.store(true, std::memory_order_relaxed);
}

void Server::wake() {
  if (lost_.load(std::memory_order_relaxed)) return;
  const std::uint64_t one = 1;
  (void)!::write(wake_descriptor_, &one, sizeof one);  // even if the counter is full, this wakes
}

void Server::run() {
  prctl(PR_SET_TIMERSLACK, 1UL);
  while (!stopping_.load(std::memory_order_relaxed)) {
    const rt::TimePoint next = step();
    if (!lost_.load(std::memory_order_relaxed)) sleep_until(next);
  }
}

rt::TimePoint Server::step() {
  const std::lock_guard lock{mutex_};
  ++counters_.wakeups;
  if (port_ && !port_->intact()) lose_descriptors();
  if (port_) port_->update_clients(rt::Clock::now());
  catch_up(rt::Clock::now());
  if (port_) take_from_host();
  if (plug_) {
    if (*plug_) {
      (void)plug_in();  // nobody would hear why not
    } else {
      pull_out();
    }
  }
  watch_spacing();
  rt::TimePoint next = monotonic(cable_.next_batch(options_.batch_bytes));
  if (port_) next = std::min(next, port_->clients().next_update());
  if (spacing_) next = std::min<rt::TimePoint>(next, rt::Clock::now() + kLookForWrites);
  if (change_.under_way()) next = std::min(next, change_.decided_at());
  return next;
}

void Server::watch_spacing() {
  const std::uint32_t baud = change_.under_way() ? change_.former() : cable_.host_baud();
  const bool matters = port_ && port_->clients().present() && oi::needs_spacing(device_.baud()) &&
                       oi::needs_spacing(baud);
  if (matters && !spacing_) spacing_.emplace(port_->device_path());
  if (!matters) spacing_.reset();
  if (spacing_) look_for_writes(false);
}

void Server::look_for_writes(bool bytes_came) {
  const rt::TimePoint before = rt::Clock::now();
  const bool written = spacing_->writes.any();
  spacing_->times.look(before, rt::Clock::now(),
                       written || (bytes_came && spacing_->times.empty()));
}

void Server::send(std::span<const std::uint8_t> bytes, std::uint32_t baud) {
  if (spacing_) look_for_writes(!bytes.empty());
  for (const std::uint8_t byte : bytes) {
    last_sent_ = byte;
    const bool spaced = spacing_ && spacing_->times.take();
    cable_.send(byte, baud, spaced ? oi::kByteSpacingAt115200 : rt::Duration::zero());
  }
}

void Server::catch_up(rt::TimePoint now) {
  rt::Duration target = now - power_on_;
  if (target - cable_.now() > kLongestLag) {
    ++counters_.stalls;
    power_on_ += target - cable_.now();
    target = cable_.now();
  }
  do {
    cable_.advance_to(std::min(target, cable_.now() + kCatchUpPiece));
    hand_to_host();
  } while (cable_.now() < target);
}

void Server::take_from_host() {
  follow_rate(port_->host_baud());
  std::array<std::uint8_t, HostRateChange::kMostBytes> bytes{};
  for (;;) {
    std::size_t room = cable_.send_room();
    if (change_.under_way()) room = change_.room(room);
    const std::size_t count =
        port_->read(std::span{bytes}.first(std::min(bytes.size(), room)), rt::Clock::now());
    if (count == 0) break;
    // They may have come since the robot last advanced, and must not be delivered too early.
    catch_up(rt::Clock::now());
    const std::span<const std::uint8_t> read{bytes.data(), count};
    if (change_.under_way()) {
      change_.keep(read, rt::Clock::now());
      settle_rate();
    } else {
      send(read, cable_.host_baud());
    }
  }
  settle_rate();
}

void Server::follow_rate(std::uint32_t baud) {
  const std::uint32_t former = cable_.host_baud();
  if (baud == former) return;
  end_rate_change();
  cable_.set_host_baud(baud);
  if (former == device_.baud()) change_.begin(former, baud, last_sent_, rt::Clock::now());
}

void Server::settle_rate() {
  if (change_.under_way() && rt::Clock::now() >= change_.decided_at()) end_rate_change();
}

void Server::end_rate_change() {
  if (!change_.under_way()) return;
  const std::size_t before = change_.before();
  send(change_.kept().first(before), change_.former());  // there is room for all
  send(change_.kept().subspan(before), change_.baud());
  change_.end();
}

void Server::hand_to_host() {
  std::array<std::uint8_t, 512> bytes{};
  while (const std::size_t count = cable_.take(bytes)) {
    const bool heard = port_ && port_->clients().present();
    const std::size_t taken = heard ? port_->write(std::span{bytes}.first(count)) : 0;
    counters_.bytes_undelivered += count - taken;
  }
}

void Server::sleep_until(rt::TimePoint time) {
  std::array<pollfd, 3> sources{{{.fd = -1, .events = POLLIN, .revents = 0},
                                 {.fd = -1, .events = POLLIN, .revents = 0},
                                 {.fd = wake_descriptor_, .events = POLLIN, .revents = 0}}};
  {
    const std::lock_guard lock{mutex_};
    if (port_) {
      // If there is no room for what the host sends, it stays there, as with a full transmitter.
      if (cable_.send_room() > 0) sources[0].fd = port_->descriptor();
      sources[1].fd = port_->watch_descriptor();
    }
  }
  const rt::Duration left = std::max(time - rt::Clock::now(), rt::Duration::zero());
  const timespec timeout = rt::as_timespec(left);
  const int ready = ppoll(sources.data(), sources.size(), &timeout, nullptr);
  // If ppoll was refused, as above a lowered limit of open files, it has not waited.
  if (ready < 0 && errno != EINTR) nanosleep(&timeout, nullptr);
  if (ready > 0 && sources[2].revents != 0) {
    std::uint64_t count = 0;
    (void)!::read(wake_descriptor_, &count, sizeof count);  // just clears it
  }
}

Snapshot Server::snapshot() const {
  const std::lock_guard lock{mutex_};
  return {.time = device_.now(),
          .mode = device_.mode(),
          .baud = device_.baud(),
          .truth = device_.truth(),
          .commanded = device_.commanded(),
          .device = device_.counters(),
          .cable = cable_.counters(),
          .server = counters_};
}

void Server::take_truth(std::vector<TruthSample>& samples) {
  const std::lock_guard lock{mutex_};
  samples.reserve(samples.size() + truth_.size());
  for (; !truth_.empty(); truth_.pop_front()) samples.push_back(truth_.front());
}

void Server::with_device(const std::function<void(Device&)>& change) {
  with_cable([&change](Cable& cable) { change(cable.device()); });
}

void Server::with_cable(const std::function<void(Cable&)>& change) {
  {
    const std::lock_guard lock{mutex_};
    if (thread_.joinable()) catch_up(rt::Clock::now());
    change(cable_);
  }
  wake();
}

void Server::unplug() {
  {
    const std::lock_guard lock{mutex_};
    pull_out();
  }
  wake();
}

void Server::pull_out() {
  plug_.reset();
  port_.reset();
  change_.end();
  spacing_.reset();  // it belonged to that port
}

Result<void> Server::replug() {
  {
    const std::lock_guard lock{mutex_};
    if (auto done = plug_in(); !done) return done;
  }
  wake();
  return {};
}

Result<void> Server::plug_in() {
  plug_.reset();
  if (port_) return {};
  Result<std::unique_ptr<PtyPort>> port = PtyPort::open(options_.link, cable_.host_baud());
  if (!port) return port.failure();
  port_ = std::move(*port);
  return {};
}

}  // namespace cargobay::hal::sim
