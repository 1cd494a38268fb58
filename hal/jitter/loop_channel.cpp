#include "hal/jitter/loop_channel.hpp"

#include "hal/cycle/control_cycle.hpp"
#include "hal/cycle/cycle_parameters.hpp"
#include "hal/cycle/cycle_state.hpp"
#include "hal/jitter/line_slice.hpp"
#include "hal/jitter/stamped_stream.hpp"
#include "hal/port/pty_transport.hpp"
#include "hal/recording/flight_recorder.hpp"
#include "hal/recording/recording_stream.hpp"
#include "hal/sim/line/pty_port.hpp"
#include "oi/dialect.hpp"
#include "oi/limits.hpp"
#include "rt/histogram.hpp"
#include "rt/unchecked.hpp"

namespace cargobay::hal::jitter {
namespace {

// The rate of a robot; the wire takes the same share of a shorter tick.
constexpr std::int64_t kRobotBaud = oi::kCreate.default_baud;

// Drives no wheels: the speed changes, so that every branch runs.
ControlAnswer decide(void* context, const CycleState& state, double /*seconds*/)
    CARGOBAY_NONBLOCKING {
  auto& stamps = *static_cast<Stamps*>(context);
  const std::int64_t now =
      rt::unchecked([]() noexcept { return rt::nanoseconds(rt::Clock::now()); });
  stamps.decided_ns.store(now, std::memory_order_relaxed);
  return state.tick % 200 < 100 ? rt::WheelSpeeds{200.0, 150.0} : rt::WheelSpeeds{-50.0, 50.0};
}

class LoopChannel final : public Channel {
 public:
  LoopChannel(const Settings& settings, const HeldFrame& held, std::unique_ptr<sim::PtyPort> port,
              std::unique_ptr<ByteStream> stream)
      : Channel{"loop"},
        settings_{settings},
        held_{held},
        port_{std::move(port)},
        stream_{std::move(stream)} {
    measured_.period = settings.period;
  }

  Result<void> run_slice(const std::atomic<bool>& stop) override {
    ControlCycle::Parameters parameters;
    parameters.loop.estimator.tick_s = rt::seconds(settings_.period);
    parameters.late_margin = settings_.period / 3;
    parameters.on_implausible = OnImplausible::report;  // the frames are not a robot's
    stream_->discard_input();
    Stamps stamps;
    RecordingStream recorded{*stream_, recorder_};
    StampedStream stamped{recorded, stamps,
                          static_cast<std::uint32_t>(kRobotBaud * oi::kTick / settings_.period)};
    const auto cycle = std::make_unique<ControlCycle>(stamped, parameters);
    cycle->set_control({.function = &decide, .context = &stamps});
    cycle->set_observer(recorder_.observer());
    return run_line_slice(
        {.to_measured = port_->descriptor(), .from_measured = port_->descriptor()}, settings_,
        held_, stamps, measured_, grant_, [&] { (void)cycle->run(); },
        [&] { cycle->request_stop(); }, stop);
  }

 private:
  Settings settings_;
  HeldFrame held_;
  std::unique_ptr<sim::PtyPort> port_;
  std::unique_ptr<ByteStream> stream_;
  FlightRecorder recorder_{FlightRecorder::kDefaultBytes};
};

}  // namespace

Result<std::unique_ptr<Channel>> make_loop_channel(const Settings& settings,
                                                   const HeldFrame& held) {
  auto port = sim::PtyPort::open("", kPtyBaud);
  if (!port) return port.failure();
  auto stream = open_pty((*port)->path(), kPtyBaud);
  if (!stream) return stream.failure();
  if (const std::error_code error = (*stream)->set_wake_threshold(oi::kCreate.frame_bytes); error)
    return Failure{"cannot set the pseudo-terminal: " + error.message(), error};
  return std::unique_ptr<Channel>{
      std::make_unique<LoopChannel>(settings, held, std::move(*port), std::move(*stream))};
}

}  // namespace cargobay::hal::jitter
