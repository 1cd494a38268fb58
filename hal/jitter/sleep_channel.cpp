#include "hal/jitter/sleep_channel.hpp"

#include <ctime>

namespace cargobay::hal::jitter {
namespace {

class SleepChannel final : public Channel {
 public:
  explicit SleepChannel(const Settings& settings) : Channel{"sleep"}, settings_{settings} {
    measured_.period = settings.period;
    measured_.headline = Stage::woken;
  }

  Result<void> run_slice(const std::atomic<bool>& stop) override {
    Recorder recorder{measured_, settings_};
    rt::RealtimeThread thread;
    grant_ = thread.start({.priority = settings_.priority, .cpu = settings_.cpu},
                          [&] { sleep_and_look(recorder, stop); });
    if (!thread.running())
      return Failure{"cannot start the measured thread: " + rt::explain(grant_.refusals.back())};
    thread.join();
    return {};
  }

 private:
  void sleep_and_look(Recorder& recorder, const std::atomic<bool>& stop) const {
    const std::size_t wakes = settings_.warm_up + settings_.slice_frames;
    std::int64_t due = rt::nanoseconds(rt::Clock::now()) + settings_.period.count();
    for (std::size_t i = 0; i < wakes && !stop.load(std::memory_order_relaxed); ++i) {
      const timespec until = rt::as_timespec(rt::Duration{due});
      while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) != 0) {
      }
      const std::int64_t woken = rt::nanoseconds(rt::Clock::now());
      Instants wake{.complete_ns = due};
      wake.set(Stage::woken, woken);
      recorder.take(wake);
      // Skips the periods that passed meanwhile, as cyclictest does; the correction counts them.
      do {
        due += settings_.period.count();
      } while (due < woken);
    }
  }

  Settings settings_;
};

}  // namespace

std::unique_ptr<Channel> make_sleep_channel(const Settings& settings) {
  return std::make_unique<SleepChannel>(settings);
}

}  // namespace cargobay::hal::jitter
