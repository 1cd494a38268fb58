#include "hal/jitter/channel.hpp"

#include <sched.h>

#include "rt/unchecked.hpp"

namespace cargobay::hal::jitter {

std::string_view name(Stage stage) {
  switch (stage) {
    case Stage::woken: return "woken";
    case Stage::decided: return "decided";
    case Stage::written: return "written";
    case Stage::arrived: return "arrived";
  }
  return "";
}

bool may_run_on(int cpu) {
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  return cpu >= 0 && cpu < CPU_SETSIZE && sched_getaffinity(0, sizeof allowed, &allowed) == 0 &&
         CPU_ISSET(static_cast<unsigned>(cpu), &allowed);
}

void choose_processors(Settings& settings) {
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  if (sched_getaffinity(0, sizeof allowed, &allowed) != 0 || CPU_COUNT(&allowed) < 2) return;
  const auto is_allowed = [&allowed](int cpu) {
    return CPU_ISSET(static_cast<unsigned>(cpu), &allowed);
  };
  for (int cpu = CPU_SETSIZE - 1; cpu >= 0 && !settings.cpu; --cpu) {
    if (is_allowed(cpu)) settings.cpu = cpu;
  }
  for (int cpu = 0; cpu < CPU_SETSIZE && !settings.source_cpu; ++cpu) {
    if (is_allowed(cpu) && cpu != settings.cpu) settings.source_cpu = cpu;
  }
}

void Recorder::take(const Instants& frame) CARGOBAY_NONBLOCKING {
  const bool warm = frames_ >= warm_up_;
  ++frames_;
  if (warm) {
    const auto period_ns = static_cast<std::uint64_t>(measured_.period.count());
    for (const Stage stage : kStages) {
      const std::int64_t at_ns = frame.at(stage);
      if (at_ns == 0) continue;
      const auto index = static_cast<std::size_t>(stage);
      // A stamp before its reference is the same instant, read on two processors.
      const auto value =
          static_cast<std::uint64_t>(std::max<std::int64_t>(0, at_ns - frame.complete_ns));
      std::uint64_t& least = measured_.least_ns[index];
      least = measured_.seen[index] ? std::min(least, value) : value;
      measured_.seen[index] = true;
      measured_.stages[index].record_corrected(value, period_ns);
      if (stage == measured_.headline) headline(value);
    }
    if (last_ns_ != 0) {
      const std::int64_t interval = frame.at(measured_.headline) - last_ns_;
      measured_.interval_ns.record(static_cast<std::uint64_t>(std::max<std::int64_t>(0, interval)));
    }
    ++measured_.frames;
    measured_.missed += frame.missed;
  }
  last_ns_ = frame.at(measured_.headline);
}

void Recorder::headline(std::uint64_t value) CARGOBAY_NONBLOCKING {
  measured_.raw.record(value);
  std::vector<float>& slice = measured_.slices.back().headline_ns;
  // Its memory was reserved before the slice began.
  if (slice.size() < slice.capacity())
    rt::unchecked([&] { slice.push_back(static_cast<float>(value)); });
}

Recorder::Recorder(Measured& measured, const Settings& settings)
    : measured_{measured}, warm_up_{settings.warm_up} {
  measured_.slices.emplace_back().headline_ns.reserve(settings.slice_frames);
}

}  // namespace cargobay::hal::jitter
