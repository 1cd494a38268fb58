// gpio/line.hpp over libgpiod 1.6.
#include <poll.h>

#include <algorithm>
#include <cerrno>
#include <ctime>

#include <gpiod.h>

#include "gpio/chip_files.hpp"
#include "gpio/find_line.hpp"
#include "gpio/line.hpp"

namespace cargobay::gpio {
namespace {

struct CloseChip {
  void operator()(gpiod_chip* chip) const { gpiod_chip_close(chip); }
};
using Chip = std::unique_ptr<gpiod_chip, CloseChip>;

std::string text(const char* text_or_null) { return text_or_null == nullptr ? "" : text_or_null; }

ChipInfo describe(const std::string& path) {
  ChipInfo info{.path = path, .name = path.substr(path.rfind('/') + 1)};
  info.group = owning_group(path);
  const Chip chip{gpiod_chip_open(path.c_str())};
  if (!chip) {
    info.error = errno;
    return info;
  }
  info.label = text(gpiod_chip_label(chip.get()));
  info.lines.resize(gpiod_chip_num_lines(chip.get()));
  for (unsigned offset = 0; offset < info.lines.size(); ++offset) {
    gpiod_line* line = gpiod_chip_get_line(chip.get(), offset);
    if (line == nullptr) continue;  // gone meanwhile: a line without a name
    info.lines[offset] = {.name = text(gpiod_line_name(line)),
                          .used = gpiod_line_is_used(line),
                          .consumer = text(gpiod_line_consumer(line))};
  }
  return info;
}

int flags(Polarity polarity, Bias bias) {
  int flags = 0;
  if (polarity == Polarity::inverted) flags |= GPIOD_LINE_REQUEST_FLAG_ACTIVE_LOW;
  switch (bias) {
    case Bias::as_is: break;
    case Bias::disabled: flags |= GPIOD_LINE_REQUEST_FLAG_BIAS_DISABLE; break;
    case Bias::pull_up: flags |= GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_UP; break;
    case Bias::pull_down: flags |= GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_DOWN; break;
  }
  return flags;
}

int value(Level level) { return level == Level::high ? 1 : 0; }

// A requested line and its chip; closing the chip gives the line back.
struct Requested {
  Chip chip{};
  gpiod_line* line = nullptr;  // owned by the chip
};

std::optional<Requested> request(const LineAddress& address, int type, int flags, int initial,
                                 LineError& error) {
  const std::vector<ChipInfo> present = chips();
  const std::optional<FoundLine> found = find_line(present, address, error);
  if (!found) return std::nullopt;
  Requested requested;
  requested.chip.reset(gpiod_chip_open(found->chip_path.c_str()));
  if (requested.chip) requested.line = gpiod_chip_get_line(requested.chip.get(), found->offset);
  const gpiod_line_request_config config{
      .consumer = kConsumer, .request_type = type, .flags = flags};
  if (requested.line == nullptr || gpiod_line_request(requested.line, &config, initial) != 0) {
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
    if (gpiod_line_set_value(requested_.line, value(level)) == 0) return {};
    return {errno, std::generic_category()};
  }

 private:
  Requested requested_;
  Level released_;
};

class RequestedInput final : public InputLine {
 public:
  explicit RequestedInput(Requested requested) : requested_{std::move(requested)} {}

  std::optional<Level> level() override {
    const int value = gpiod_line_get_value(requested_.line);
    if (value < 0) return std::nullopt;
    return value != 0 ? Level::high : Level::low;
  }

  std::optional<EdgeEvent> wait_for_edge(std::chrono::steady_clock::time_point deadline) override {
    const int descriptor = gpiod_line_event_get_fd(requested_.line);
    if (descriptor < 0) return std::nullopt;
    for (;;) {
      const auto left = std::max<std::chrono::nanoseconds>(
          deadline - std::chrono::steady_clock::now(), std::chrono::nanoseconds::zero());
      const timespec timeout{.tv_sec = static_cast<time_t>(left.count() / 1'000'000'000),
                             .tv_nsec = static_cast<long>(left.count() % 1'000'000'000)};
      pollfd line{.fd = descriptor, .events = POLLIN | POLLPRI, .revents = 0};
      const int ready = ppoll(&line, 1, &timeout, nullptr);
      if (ready < 0 && errno == EINTR) continue;
      gpiod_line_event event{};
      if (ready <= 0 || gpiod_line_event_read(requested_.line, &event) != 0) return std::nullopt;
      const auto time =
          std::chrono::seconds{event.ts.tv_sec} + std::chrono::nanoseconds{event.ts.tv_nsec};
      return EdgeEvent{
          .level = event.event_type == GPIOD_LINE_EVENT_RISING_EDGE ? Level::high : Level::low,
          .time = std::chrono::steady_clock::time_point{time}};
    }
  }

 private:
  Requested requested_;
};

}  // namespace

std::vector<ChipInfo> chips() {
  std::vector<ChipInfo> found;
  for (const std::string& path : chip_files()) found.push_back(describe(path));
  return found;
}

std::unique_ptr<Output> open_output(const LineAddress& address, const OutputOptions& options,
                                    LineError& error) {
  int wanted = flags(options.polarity, options.bias);
  if (options.drive == Drive::open_drain) wanted |= GPIOD_LINE_REQUEST_FLAG_OPEN_DRAIN;
  auto requested =
      request(address, GPIOD_LINE_REQUEST_DIRECTION_OUTPUT, wanted, value(options.released), error);
  if (!requested) return nullptr;
  return std::make_unique<RequestedOutput>(std::move(*requested), options.released);
}

std::unique_ptr<InputLine> open_input(const LineAddress& address, const InputOptions& options,
                                      LineError& error) {
  const int type = options.edges == InputOptions::Edges::both ? GPIOD_LINE_REQUEST_EVENT_BOTH_EDGES
                                                              : GPIOD_LINE_REQUEST_DIRECTION_INPUT;
  auto requested = request(address, type, flags(options.polarity, options.bias), 0, error);
  if (!requested) return nullptr;
  return std::make_unique<RequestedInput>(std::move(*requested));
}

}  // namespace cargobay::gpio
