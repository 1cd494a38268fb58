#include "hal/cli/live/live_plot.hpp"

#include <algorithm>
#include <chrono>
#include <deque>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "hal/cli/attached/feed_news.hpp"
#include "hal/cli/drawing/picture.hpp"
#include "hal/cli/drive/drive_log.hpp"
#include "hal/cli/drive/velocity_plot.hpp"
#include "hal/cli/live/typed.hpp"
#include "hal/cli/terminal/outputs.hpp"
#include "hal/cli/terminal/print.hpp"
#include "hal/cli/terminal/signals.hpp"
#include "hal/feed/feed_reader.hpp"
#include "hal/feed/message/messages.hpp"
#include "oi/limits.hpp"
#include "rt/clock.hpp"

namespace cargobay::cli {
namespace {

constexpr rt::Duration kDrawEvery = std::chrono::seconds{2};
constexpr rt::Duration kWakeEvery = std::chrono::milliseconds{200};  // for signals

// The last seconds of the drive.
class LastSamples {
 public:
  explicit LastSamples(double last_s) : last_s_{last_s} {}

  // Call it for each state.
  void take(const FeedNews& news) {
    const hal::CycleState& state = *news.state;
    if (state.tick == tick_) return;               // the first one is told twice
    if (state.tick < tick_) before_ += tick_ + 1;  // the robot came back, and counts from 0 again
    tick_ = state.tick;
    DriveSample sample{.time_s = static_cast<double>(before_ + tick_) * rt::seconds(oi::kTick),
                       .interval_ms = 1e3 * rt::seconds(oi::kTick),
                       .set = state.set,
                       .estimate = state.estimate,
                       .command = state.command};
    if (former_unix_ns_)
      sample.interval_ms = static_cast<double>(news.state_unix_ns - *former_unix_ns_) / 1e6;
    former_unix_ns_ = news.state_unix_ns;
    if (news.truth) sample.truth = news.truth->wheels;
    samples_.push_back(sample);
    while (samples_.front().time_s < sample.time_s - last_s_) samples_.pop_front();
    ++taken_;
  }
  std::vector<DriveSample> all() const { return {samples_.begin(), samples_.end()}; }
  std::uint64_t taken() const { return taken_; }

 private:
  double last_s_;
  std::deque<DriveSample> samples_{};
  std::int64_t tick_ = -1;
  std::int64_t before_ = 0;  // ticks of links before this one
  std::optional<std::int64_t> former_unix_ns_{};
  std::uint64_t taken_ = 0;
};

hal::Result<void> draw(const LastSamples& samples, const FeedNews& news,
                       const LivePlotOptions& options) {
  const std::string title = fmt::format("{}, driven by {}: the last {:g} s", news.hello.port,
                                        news.hello.program, options.last_s);
  const auto drawing =
      picture(velocity_plot(samples.all(), title, Intervals::drawn), options.output);
  if (!drawing) return drawing.failure();
  Outputs outputs;
  if (const auto opened = outputs.open("--output", options.output); !opened) return opened;
  return outputs.write("--output", *drawing);
}

}  // namespace

hal::Result<void> plot_live(const LivePlotOptions& options) {
  StopSignals signals;
  {
    Outputs outputs;  // whether the file can be written, before anything else
    if (const auto opened = outputs.open("--output", options.output); !opened) return opened;
  }
  auto reader = hal::FeedReader::attach(options.port);
  if (!reader) return reader.failure();
  if (const auto asked = reader->ask(R"({"do":"subscribe","types":["state","truth"]})"); !asked)
    return asked;
  FeedNews news;
  LastSamples samples{options.last_s};
  std::uint64_t drawn = 0;
  rt::TimePoint next = rt::Clock::now() + kDrawEvery;
  hal::Result<void> heard;
  while (heard && !signals.wait(rt::Duration::zero()).has_value()) {
    heard = take_news(*reader, news, [&](hal::FeedType type) {
      if (type == hal::FeedType::state && news.state) samples.take(news);
    });
    const rt::TimePoint now = rt::Clock::now();
    if (options.output != "-" && now >= next && samples.taken() > drawn) {
      if (const auto done = draw(samples, news, options); !done) return done;
      next = now + kDrawEvery;
      if (drawn == 0) print_remark("drawing in " + options.output + "; Ctrl-C ends it");
      drawn = samples.taken();
    }
    wait_for_input(*reader, -1, now + kWakeEvery);
  }
  if (samples.taken() == 0)
    return hal::Failure{"no frame came: there is nothing to draw; the feed says: " + news.text};
  if (const auto done = draw(samples, news, options); !done) return done;
  if (options.output != "-")
    fmt::print("Drew {} of {} frames in {}\n", samples.all().size(), samples.taken(),
               options.output);
  return {};
}

}  // namespace cargobay::cli
