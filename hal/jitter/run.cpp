#include "hal/jitter/run.hpp"

#include <algorithm>

#include "hal/jitter/echo_channel.hpp"
#include "hal/jitter/loop_channel.hpp"
#include "hal/jitter/robot_channel.hpp"
#include "hal/jitter/sleep_channel.hpp"
#include "oi/limits.hpp"

namespace cargobay::hal::jitter {
namespace {

// Makes a slice of the robot's channel take as long as one of the others.
Settings of_robot(Settings settings) {
  const auto as_long = [&settings](std::size_t frames) {
    const auto scaled =
        static_cast<std::size_t>(static_cast<std::int64_t>(frames) * settings.period / oi::kTick);
    return std::max<std::size_t>(scaled, 4);
  };
  settings.warm_up = as_long(settings.warm_up);
  settings.slice_frames = as_long(settings.slice_frames);
  return settings;
}

Result<std::unique_ptr<Channel>> make_channel(const std::string& name, RunRequest& request) {
  const Settings& settings = request.settings;
  if (name == "robot")
    return make_robot_channel(std::move(request.robot), request.server, request.bring_up,
                              of_robot(settings), request.held);
  if (name == "loop") return make_loop_channel(settings, request.held);
  if (name == "sleep") return make_sleep_channel(settings);
  const HeldFrame held = name == "echo" ? request.held : HeldFrame{};
  return make_echo_channel(name, name == "pipe" ? EchoLine::pipe : EchoLine::pty, settings, held);
}

}  // namespace

Result<std::unique_ptr<Run>> Run::prepare(RunRequest request) {
  std::unique_ptr<Run> run{new Run{request.rounds}};
  for (const std::string_view name : kChannelNames) {
    if (std::ranges::find(request.channels, name) == request.channels.end()) continue;
    auto channel = make_channel(std::string{name}, request);
    if (!channel) return channel.failure();
    run->channels_.push_back(std::move(*channel));
  }
  return run;
}

Result<void> Run::measure(const std::atomic<bool>& stop,
                          const std::function<void(double done)>& progress) {
  std::size_t slices = 0;
  for (std::size_t round = 0; round < rounds_; ++round) {
    for (const std::unique_ptr<Channel>& channel : channels_) {
      if (stop.load(std::memory_order_relaxed)) return {};
      if (auto done = channel->run_slice(stop); !done) return done;
      progress(static_cast<double>(++slices) / static_cast<double>(rounds_ * channels_.size()));
    }
  }
  return {};
}

}  // namespace cargobay::hal::jitter
