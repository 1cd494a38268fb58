#include "hal/jitter/robot_channel.hpp"

#include "hal/bring_up/bring_up.hpp"
#include "hal/cycle/control_cycle.hpp"
#include "hal/cycle/cycle_parameters.hpp"
#include "hal/cycle/cycle_state.hpp"
#include "hal/guard/duty.hpp"
#include "hal/jitter/stamped_stream.hpp"
#include "hal/recording/flight_recorder.hpp"
#include "hal/recording/recording_stream.hpp"
#include "oi/limits.hpp"
#include "oi/stream_budget.hpp"
#include "rt/histogram.hpp"
#include "rt/unchecked.hpp"

namespace cargobay::hal::jitter {
namespace {

// What the virtual Create reports, from its own thread.
struct Wire {
  std::atomic<std::int64_t> complete_ns{0};  // of the newest frame
  std::atomic<std::int64_t> arrived_ns{0};   // of the newest command
};

// Records each frame when the next one arrives: by then its command has arrived, or never will.
class Books {
 public:
  Books(Recorder& recorder, Stamps& stamps, const Wire* wire, std::size_t frames)
      : recorder_{recorder}, stamps_{stamps}, wire_{wire}, frames_left_{frames} {}

  ControlCycle* cycle = nullptr;
  const std::atomic<bool>* stop = nullptr;

  static ControlAnswer decide(void* context, const CycleState& /*state*/, double /*seconds*/)
      CARGOBAY_NONBLOCKING {
    static_cast<Books*>(context)->next();
    return rt::WheelSpeeds{};
  }

 private:
  void next() CARGOBAY_NONBLOCKING {
    const std::int64_t now =
        rt::unchecked([]() noexcept { return rt::nanoseconds(rt::Clock::now()); });
    if (frame_.complete_ns != 0) book();
    const std::int64_t woken = stamps_.woken_ns.load(std::memory_order_relaxed);
    frame_ = {.complete_ns = woken};
    if (wire_ != nullptr) {
      frame_.complete_ns = wire_->complete_ns.load(std::memory_order_relaxed);
      // The virtual Create has begun the next tick, whose frame cannot be here yet.
      if (frame_.complete_ns > woken) frame_.complete_ns -= oi::kTick.count();
      frame_.set(Stage::woken, woken);
    }
    frame_.set(Stage::decided, now);
    if (frames_left_ == 0 || stop->load(std::memory_order_relaxed)) return cycle->request_stop();
    --frames_left_;
  }
  void book() CARGOBAY_NONBLOCKING {
    frame_.set(Stage::written, stamps_.written_ns.load(std::memory_order_relaxed));
    if (wire_ != nullptr) {
      const std::int64_t arrived = wire_->arrived_ns.load(std::memory_order_relaxed);
      if (arrived > frame_.complete_ns) frame_.set(Stage::arrived, arrived);
    }
    recorder_.take(frame_);
  }

  Recorder& recorder_;
  Stamps& stamps_;
  const Wire* wire_;
  std::size_t frames_left_;
  Instants frame_{};
};

class RobotChannel final : public Channel {
 public:
  RobotChannel(std::unique_ptr<ByteStream> stream, sim::Server* server, const Settings& settings)
      : Channel{"robot"}, settings_{settings}, stream_{std::move(stream)}, server_{server} {
    measured_.period = oi::kTick;
    if (server_ == nullptr) return;
    const rt::Duration frame = oi::wire_time(oi::kCreate.frame_bytes, stream_->baud());
    server_->with_device([this, frame](sim::Device& device) {
      // The server listens too: it keeps the truth of each tick.
      former_on_tick_ = std::move(device.on_tick);
      former_on_drive_ = std::move(device.on_drive);
      device.on_tick = [this, frame](const sim::Device& robot) {
        wire_.complete_ns.store(rt::nanoseconds(server_->monotonic(robot.now()) + frame),
                                std::memory_order_relaxed);
        if (former_on_tick_) former_on_tick_(robot);
      };
      device.on_drive = [this](const sim::DriveRecord& command) {
        wire_.arrived_ns.store(rt::nanoseconds(server_->monotonic(command.time)),
                               std::memory_order_relaxed);
        if (former_on_drive_) former_on_drive_(command);
      };
    });
  }
  ~RobotChannel() override {
    duty_.reset();  // the robot was told to stand still all the time
    if (server_ == nullptr) return;
    server_->with_device([this](sim::Device& device) {
      device.on_tick = std::move(former_on_tick_);
      device.on_drive = std::move(former_on_drive_);
    });
  }
  RobotChannel(const RobotChannel&) = delete;
  RobotChannel& operator=(const RobotChannel&) = delete;

  Result<void> bring_up_robot(BringUpRequest request) {
    auto duty = Duty::begin(*stream_, {}, settings_.priority);
    if (!duty) return duty.failure();
    duty_ = std::move(*duty);
    Parting left = Parting::unconfirmed;
    request.packets = oi::kCreate.list(oi::FrameList::reading);
    request.left = &left;
    const auto report = bring_up(*stream_, request);
    if (!report)
      return Failure{report.failure().message + fate(duty_->discharge_after(left)),
                     report.failure().code};
    if (const std::error_code error = stream_->set_wake_threshold(oi::kCreate.frame_bytes); error)
      return Failure{"cannot set the port to wake once a frame: " + error.message(), error};
    return {};
  }

  Result<void> run_slice(const std::atomic<bool>& stop) override {
    // Discards what it sent while other channels were measured.
    stream_->discard_input();
    Recorder recorder{measured_, settings_};
    Stamps stamps;
    RecordingStream recorded{*stream_, recorder_};
    StampedStream stamped{recorded, stamps, stream_->baud()};
    const auto cycle = std::make_unique<ControlCycle>(stamped, ControlCycle::Parameters{});
    Books books{recorder, stamps, server_ != nullptr ? &wire_ : nullptr,
                settings_.warm_up + settings_.slice_frames};
    books.cycle = cycle.get();
    books.stop = &stop;
    cycle->set_control({.function = &Books::decide, .context = &books});
    cycle->set_observer(recorder_.observer());
    CycleEnd end = CycleEnd::asked;
    rt::RealtimeThread thread;
    grant_ = thread.start({.priority = settings_.priority, .cpu = settings_.cpu},
                          [&] { end = cycle->run(); });
    if (!thread.running())
      return Failure{"cannot start the control thread: " + rt::explain(grant_.refusals.back())};
    thread.join();
    measured_.missed += cycle->frames().bad + cycle->frames().lost;
    if (end != CycleEnd::asked)
      return Failure{"the robot left the loop during the measurement; see: cargobay drive"};
    return {};
  }

 private:
  Settings settings_;
  std::unique_ptr<ByteStream> stream_;
  std::unique_ptr<Duty> duty_{};  // of the stream
  sim::Server* server_;
  Wire wire_{};
  std::function<void(const sim::Device&)> former_on_tick_{};
  std::function<void(const sim::DriveRecord&)> former_on_drive_{};
  FlightRecorder recorder_{FlightRecorder::kDefaultBytes};
};

}  // namespace

Result<std::unique_ptr<Channel>> make_robot_channel(std::unique_ptr<ByteStream> stream,
                                                    sim::Server* server, BringUpRequest bring_up,
                                                    const Settings& settings,
                                                    const HeldFrame& held) {
  auto channel = std::make_unique<RobotChannel>(std::move(stream), server, settings);
  if (const auto done = channel->bring_up_robot(std::move(bring_up)); !done) return done.failure();
  if (server != nullptr) {
    server->with_cable([&held](sim::Cable& cable) {
      cable.faults_to_host().held_every = static_cast<std::uint32_t>(held.every);
      cable.faults_to_host().held_by = held.by;
    });
  }
  return std::unique_ptr<Channel>{std::move(channel)};
}

}  // namespace cargobay::hal::jitter
