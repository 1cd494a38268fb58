// gpio/line.hpp over libgpiod 2.x.
#include <algorithm>
#include <cerrno>

#include <gpiod.h>

#include "gpio/chip_files.hpp"
#include "gpio/find_line.hpp"
#include "gpio/line.hpp"

namespace cargobay::gpio {
namespace {

template <auto kFree>
struct Free {
  template <typename T>
  void operator()(T* handle) const {
    kFree(handle);
  }
};
using Chip = std::unique_ptr<gpiod_chip, Free<gpiod_chip_close>>;
using ChipDescription = std::unique_ptr<gpiod_chip_info, Free<gpiod_chip_info_free>>;
using LineDescription = std::unique_ptr<gpiod_line_info, Free<gpiod_line_info_free>>;
using Settings = std::unique_ptr<gpiod_line_settings, Free<gpiod_line_settings_free>>;
using LineConfig = std::unique_ptr<gpiod_line_config, Free<gpiod_line_config_free>>;
using RequestConfig = std::unique_ptr<gpiod_request_config, Free<gpiod_request_config_free>>;
using Request = std::unique_ptr<gpiod_line_request, Free<gpiod_line_request_release>>;
using EdgeBuffer = std::unique_ptr<gpiod_edge_event_buffer, Free<gpiod_edge_event_buffer_free>>;

std::string text(const char* text_or_null) { return text_or_null == nullptr ? "" : text_or_null; }

ChipInfo describe(const std::string& path) {
  ChipInfo info{.path = path, .name = path.substr(path.rfind('/') + 1)};
  info.group = owning_group(path);
  const Chip chip{gpiod_chip_open(path.c_str())};
  const ChipDescription description{chip ? gpiod_chip_get_info(chip.get()) : nullptr};
  if (!description) {
    info.error = errno;
    return info;
  }
  info.label = text(gpiod_chip_info_get_label(description.get()));
  info.lines.resize(gpiod_chip_info_get_num_lines(description.get()));
  for (unsigned offset = 0; offset < info.lines.size(); ++offset) {
    const LineDescription line{gpiod_chip_get_line_info(chip.get(), offset)};
    if (!line) continue;  // gone meanwhile: a line without a name
    info.lines[offset] = {.name = text(gpiod_line_info_get_name(line.get())),
                          .used = gpiod_line_info_is_used(line.get()),
                          .consumer = text(gpiod_line_info_get_consumer(line.get()))};
  }
  return info;
}

gpiod_line_bias bias(Bias bias) {
  switch (bias) {
    case Bias::as_is: return GPIOD_LINE_BIAS_AS_IS;
    case Bias::disabled: return GPIOD_LINE_BIAS_DISABLED;
    case Bias::pull_up: return GPIOD_LINE_BIAS_PULL_UP;
    case Bias::pull_down: return GPIOD_LINE_BIAS_PULL_DOWN;
  }
  return GPIOD_LINE_BIAS_AS_IS;
}

gpiod_line_value value(Level level) {
  return level == Level::high ? GPIOD_LINE_VALUE_ACTIVE : GPIOD_LINE_VALUE_INACTIVE;
}

Settings settings(Polarity polarity, Bias wanted_bias) {
  Settings settings{gpiod_line_settings_new()};
  if (!settings) return settings;
  gpiod_line_settings_set_active_low(settings.get(), polarity == Polarity::inverted);
  // The setters fail only for values that their enumeration does not have.
  (void)gpiod_line_settings_set_bias(settings.get(), bias(wanted_bias));
  return settings;
}

struct Requested {
  Request request{};  // stays valid after its chip is closed
  unsigned offset = 0;
};

std::optional<Requested> request(const LineAddress& address, const Settings& settings,
                                 LineError& error) {
  const std::vector<ChipInfo> present = chips();
  const std::optional<FoundLine> found = find_line(present, address, error);
  if (!found) return std::nullopt;
  const LineConfig lines{gpiod_line_config_new()};
  const RequestConfig config{gpiod_request_config_new()};
  const Chip chip{gpiod_chip_open(found->chip_path.c_str())};
  Requested requested{.offset = found->offset};
  if (settings && lines && config && chip &&
      gpiod_line_config_add_line_settings(lines.get(), &found->offset, 1, settings.get()) == 0) {
    gpiod_request_config_set_consumer(config.get(), kConsumer);
    requested.request.reset(gpiod_chip_request_lines(chip.get(), config.get(), lines.get()));
  }
  if (!requested.request) {
    error = refused(present, address, *found, errno);
    return std::nullopt;
  }
  return requested;
}

class RequestedOutput final : public Output {
 public:
  RequestedOutput(Requested requested, Level released)
      : requested_{std::move(requested)}, released_{released} {}
  ~RequestedOutput() override { (void)set(released_); }  // nothing is left to report to
  RequestedOutput(const RequestedOutput&) = delete;
  RequestedOutput& operator=(const RequestedOutput&) = delete;

  std::error_code set(Level level) override {
    if (gpiod_line_request_set_value(requested_.request.get(), requested_.offset, value(level)) ==
        0)
      return {};
    return {errno, std::generic_category()};
  }

 private:
  Requested requested_;
  Level released_;
};

class RequestedInput final : public InputLine {
 public:
  explicit RequestedInput(Requested requested)
      : requested_{std::move(requested)}, events_{gpiod_edge_event_buffer_new(1)} {}

  std::optional<Level> level() override {
    switch (gpiod_line_request_get_value(requested_.request.get(), requested_.offset)) {
      case GPIOD_LINE_VALUE_ACTIVE: return Level::high;
      case GPIOD_LINE_VALUE_INACTIVE: return Level::low;
      case GPIOD_LINE_VALUE_ERROR: break;
    }
    return std::nullopt;
  }

  std::optional<EdgeEvent> wait_for_edge(std::chrono::steady_clock::time_point deadline) override {
    if (!events_) return std::nullopt;
    for (;;) {
      const auto left = std::max<std::chrono::nanoseconds>(
          deadline - std::chrono::steady_clock::now(), std::chrono::nanoseconds::zero());
      const int ready = gpiod_line_request_wait_edge_events(requested_.request.get(), left.count());
      if (ready < 0 && errno == EINTR) continue;
      if (ready <= 0 ||
          gpiod_line_request_read_edge_events(requested_.request.get(), events_.get(), 1) != 1)
        return std::nullopt;
      gpiod_edge_event* event = gpiod_edge_event_buffer_get_event(events_.get(), 0);
      const bool rising = gpiod_edge_event_get_event_type(event) == GPIOD_EDGE_EVENT_RISING_EDGE;
      const std::chrono::nanoseconds time{gpiod_edge_event_get_timestamp_ns(event)};
      return EdgeEvent{.level = rising ? Level::high : Level::low,
                       .time = std::chrono::steady_clock::time_point{time}};
    }
  }

 private:
  Requested requested_;
  EdgeBuffer events_;
};

}  // namespace

std::vector<ChipInfo> chips() {
  std::vector<ChipInfo> found;
  for (const std::string& path : chip_files()) found.push_back(describe(path));
  return found;
}

std::unique_ptr<Output> open_output(const LineAddress& address, const OutputOptions& options,
                                    LineError& error) {
  const Settings wanted = settings(options.polarity, options.bias);
  if (wanted) {
    (void)gpiod_line_settings_set_direction(wanted.get(), GPIOD_LINE_DIRECTION_OUTPUT);
    (void)gpiod_line_settings_set_output_value(wanted.get(), value(options.released));
    if (options.drive == Drive::open_drain)
      (void)gpiod_line_settings_set_drive(wanted.get(), GPIOD_LINE_DRIVE_OPEN_DRAIN);
  }
  auto requested = request(address, wanted, error);
  if (!requested) return nullptr;
  return std::make_unique<RequestedOutput>(std::move(*requested), options.released);
}

std::unique_ptr<InputLine> open_input(const LineAddress& address, const InputOptions& options,
                                      LineError& error) {
  const Settings wanted = settings(options.polarity, options.bias);
  if (wanted) {
    (void)gpiod_line_settings_set_direction(wanted.get(), GPIOD_LINE_DIRECTION_INPUT);
    if (options.edges == InputOptions::Edges::both)
      (void)gpiod_line_settings_set_edge_detection(wanted.get(), GPIOD_LINE_EDGE_BOTH);
  }
  auto requested = request(address, wanted, error);
  if (!requested) return nullptr;
  return std::make_unique<RequestedInput>(std::move(*requested));
}

}  // namespace cargobay::gpio
