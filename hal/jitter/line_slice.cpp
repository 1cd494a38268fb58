#include "hal/jitter/line_slice.hpp"

namespace cargobay::hal::jitter {

Result<void> run_line_slice(const Line& line, const Settings& settings, const HeldFrame& held,
                            Stamps& stamps, Measured& measured, rt::RealtimeGrant& grant,
                            const std::function<void()>& answer, const std::function<void()>& end,
                            const std::atomic<bool>& stop) {
  Recorder recorder{measured, settings};
  rt::RealtimeThread answering;
  grant = answering.start({.priority = settings.priority, .cpu = settings.cpu}, answer);
  if (!answering.running())
    return Failure{"cannot start the measured thread: " + rt::explain(grant.refusals.back())};
  rt::RealtimeThread sending;
  const rt::RealtimeGrant sent =
      sending.start({.priority = settings.priority - 1, .cpu = settings.source_cpu},
                    [&] { send_frames(line, settings, held, stamps, recorder, stop); });
  const bool running = sending.running();
  sending.join();
  end();
  answering.join();
  if (!running) return Failure{"cannot start the source: " + rt::explain(sent.refusals.back())};
  return {};
}

}  // namespace cargobay::hal::jitter
