#include "hal/config/config.hpp"

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <limits>
#include <span>
#include <sstream>

#include "hal/config/settings.hpp"
#include "hal/file/read_input.hpp"
#include "oi/baud.hpp"
#include "oi/text/nearest_name.hpp"

// Set up to return errors, not to throw them: hal/CMakeLists.txt.
#include <toml++/toml.h>

namespace cargobay::hal {
namespace {

// What is wrong with a value; nothing if it was accepted.
using Complaint = std::optional<std::string>;
struct Key {
  std::string_view name;
  std::function<Complaint(const toml::node&)> take;
};

class Reader {
 public:
  Reader(const std::string& file, Config& config) : file_{file}, config_{config} {}

  std::optional<Failure> read(const toml::table& root) { return take(root, root_keys()); }

 private:
  std::optional<Failure> take(const toml::table& table, std::span<const Key> keys);
  Failure at(const toml::source_region& where, const std::string& what) const {
    return {file_ + ":" + std::to_string(where.begin.line) + ": " + what};
  }
  Key table(std::string_view name, const std::function<std::vector<Key>()>& keys);

  std::vector<Key> root_keys();
  std::vector<Key> pins_keys();
  static std::vector<Key> output_keys(PinSetting& pin);
  static std::vector<Key> input_keys(PinSetting& pin);
  std::vector<Key> robot_keys();
  std::vector<Key> realtime_keys();

  const std::string& file_;
  Config& config_;
  std::optional<Failure> inner_{};  // of a table inside this one
};

Key text_key(std::string_view name, std::string& target) {
  return {name, [&target](const toml::node& node) -> Complaint {
            const auto* text = node.as_string();
            if (text == nullptr) return "is a text in quotes";
            target = text->get();
            return std::nullopt;
          }};
}

Key flag_key(std::string_view name, const std::function<void(bool)>& set) {
  return {name, [set](const toml::node& node) -> Complaint {
            const auto* flag = node.as_boolean();
            if (flag == nullptr) return "is true or false";
            set(flag->get());
            return std::nullopt;
          }};
}

// `unit` also says what the value is not in.
Key number_key(std::string_view name, Range range, std::string_view unit,
               std::optional<double>& target) {
  return {name, [range, unit, &target](const toml::node& node) -> Complaint {
            const std::optional<double> number = node.value<double>();
            if (!number || !range.contains(*number))
              return "is a number from " + range.words() + ", " + std::string{unit};
            target = number;
            return std::nullopt;
          }};
}

Key whole_key(std::string_view name, Range range, std::optional<int>& target) {
  return {name, [range, &target](const toml::node& node) -> Complaint {
            const auto* number = node.as_integer();
            if (number == nullptr || !range.contains(static_cast<double>(number->get())))
              return "is a whole number from " + range.words();
            target = static_cast<int>(number->get());
            return std::nullopt;
          }};
}

Key line_key(std::string& target) {
  return {"line", [&target](const toml::node& node) -> Complaint {
            if (const auto* offset = node.as_integer(); offset != nullptr && offset->get() >= 0) {
              target = std::to_string(offset->get());
              return std::nullopt;
            }
            const auto* name = node.as_string();
            if (name == nullptr || name->get().empty())
              return "is the line's offset, or its name in quotes";
            target = name->get();
            return std::nullopt;
          }};
}

Key bias_key(gpio::Bias& target) {
  return {"bias", [&target](const toml::node& node) -> Complaint {
            const std::string text = node.value<std::string>().value_or("");
            if (text == "as_is") {
              target = gpio::Bias::as_is;
            } else if (text == "disabled") {
              target = gpio::Bias::disabled;
            } else if (text == "pull_up") {
              target = gpio::Bias::pull_up;
            } else if (text == "pull_down") {
              target = gpio::Bias::pull_down;
            } else {
              return "is \"as_is\", \"disabled\", \"pull_up\" or \"pull_down\"";
            }
            return std::nullopt;
          }};
}

Key active_low_key(PinSetting& pin) {
  return flag_key("active_low", [&pin](bool low) {
    pin.polarity = low ? gpio::Polarity::inverted : gpio::Polarity::direct;
  });
}

std::optional<Failure> Reader::take(const toml::table& table, std::span<const Key> keys) {
  for (auto&& [name, node] : table) {
    const Key* found = nullptr;
    oi::NearestName nearest{name.str()};
    for (const Key& key : keys) {
      nearest.consider(key.name);
      if (key.name == name.str()) found = &key;
    }
    if (found == nullptr) {
      std::string list;
      for (const Key& key : keys) list += (list.empty() ? "" : ", ") + std::string{key.name};
      return at(name.source(), "no key is called " + std::string{name.str()} +
                                   (nearest.name().empty()
                                        ? "; there are: " + list
                                        : "; did you mean " + std::string{nearest.name()} + "?"));
    }
    const Complaint wrong = found->take(node);
    if (inner_) return inner_;
    if (wrong) return at(node.source(), std::string{name.str()} + " " + *wrong);
  }
  return std::nullopt;
}

Key Reader::table(std::string_view name, const std::function<std::vector<Key>()>& keys) {
  return {name, [this, keys](const toml::node& node) -> Complaint {
            const toml::table* inside = node.as_table();
            if (inside == nullptr) return "is a table, with keys of its own";
            inner_ = take(*inside, keys());
            return std::nullopt;
          }};
}

std::vector<Key> Reader::root_keys() {
  return {text_key("port", config_.port),
          {"baud",
           [this](const toml::node& node) -> Complaint {
             const auto* number = node.as_integer();
             const auto baud = number == nullptr || number->get() < 0 ||
                                       number->get() > std::numeric_limits<std::int32_t>::max()
                                   ? 0U
                                   : static_cast<std::uint32_t>(number->get());
             if (!oi::baud_code(baud)) return "is a rate of the robot's, such as 57600 or 19200";
             config_.baud = baud;
             return std::nullopt;
           }},
          table("pins", [this] { return pins_keys(); }),
          table("robot", [this] { return robot_keys(); }),
          table("realtime", [this] { return realtime_keys(); })};
}

std::vector<Key> Reader::pins_keys() {
  PinSettings& pins = config_.pins;
  return {table("brc", [&pins] { return output_keys(pins.brc); }),
          table("power", [&pins] { return output_keys(pins.power_toggle); }),
          table("power_sense", [&pins] { return input_keys(pins.power_sense); }),
          table("charging", [&pins] { return input_keys(pins.charging); })};
}

std::vector<Key> Reader::input_keys(PinSetting& pin) {
  return {text_key("chip", pin.address.chip), line_key(pin.address.line), active_low_key(pin),
          bias_key(pin.bias)};
}

std::vector<Key> Reader::output_keys(PinSetting& pin) {
  std::vector<Key> keys = input_keys(pin);
  keys.push_back(flag_key("open_drain", [&pin](bool open) {
    pin.drive = open ? gpio::Drive::open_drain : gpio::Drive::push_pull;
  }));
  return keys;
}

std::vector<Key> Reader::robot_keys() {
  constexpr std::string_view kOfReported = "1 where what the robot reports is true";
  return {number_key("wheel_base_mm", kWheelBaseMm, "in mm, not metres", config_.wheel_base_mm),
          number_key("distance_scale", kScale, kOfReported, config_.distance_scale),
          number_key("turn_scale", kScale, kOfReported, config_.turn_scale),
          number_key("lag_s", kLagS, "in seconds, not ms", config_.lag_s),
          number_key("acceleration_mm_s2", kAccelerationMmS2, "in mm/s^2, not m/s^2",
                     config_.acceleration_mm_s2),
          number_key("jerk_mm_s3", kJerkMmS3, "in mm/s^3, not m/s^3", config_.jerk_mm_s3),
          {"remainder", [this](const toml::node& node) -> Complaint {
             const std::string text = node.value<std::string>().value_or("");
             if (text != "carried" && text != "lost") return "is \"carried\" or \"lost\"";
             config_.remainder = text == "lost" ? rt::Remainder::lost : rt::Remainder::carried;
             return std::nullopt;
           }}};
}

std::vector<Key> Reader::realtime_keys() {
  return {whole_key("priority", kPriority, config_.priority), whole_key("cpu", kCpu, config_.cpu),
          flag_key("require", [this](bool require) { config_.require_realtime = require; })};
}

std::string personal_file() {
  const char* xdg = std::getenv("XDG_CONFIG_HOME");  // NOLINT(concurrency-mt-unsafe): set-up
  if (xdg != nullptr && *xdg != '\0') return std::string{xdg} + "/cargobay.toml";
  const char* home = std::getenv("HOME");  // NOLINT(concurrency-mt-unsafe): set-up
  return home == nullptr ? "" : std::string{home} + "/.config/cargobay.toml";
}

std::optional<Failure> read_file(const std::string& file, Config& config) {
  const auto text = read_input(file, {.most_bytes = kMostConfigBytes});
  if (text) return read_config(*text, file, config);
  return Failure{"cannot read the configuration " + file + ": " + text.failure().message,
                 text.failure().code};
}

}  // namespace

std::optional<Failure> read_config(std::string_view text, const std::string& file, Config& config) {
  const toml::parse_result parsed = toml::parse(text);
  if (!parsed) {
    const toml::parse_error& error = parsed.error();
    return Failure{file + ":" + std::to_string(error.source().begin.line) +
                   ": no TOML: " + std::string{error.description()}};
  }
  return Reader{file, config}.read(parsed.table());
}

std::vector<std::string> config_files(const std::string& file) {
  if (!file.empty()) return {file};
  std::vector<std::string> files;
  for (std::string usual : {std::string{"/etc/cargobay.toml"}, personal_file()}) {
    std::error_code error;
    if (!usual.empty() && std::filesystem::exists(usual, error)) files.push_back(std::move(usual));
  }
  return files;
}

Result<Config> load_config(const std::string& file) {
  Config config;
  for (const std::string& each : config_files(file)) {
    if (auto failure = read_file(each, config)) return *failure;
  }
  return config;
}

void apply(const Config& config, CycleParameters& parameters) {
  rt::WheelLoop::Parameters& loop = parameters.loop;
  if (config.wheel_base_mm) {
    loop.estimator.wheel_base_mm = *config.wheel_base_mm;
    parameters.odometry.wheel_base_mm = *config.wheel_base_mm;
  }
  if (config.distance_scale) parameters.odometry.distance_scale = *config.distance_scale;
  if (config.turn_scale) parameters.odometry.turn_scale = *config.turn_scale;
  if (config.lag_s) {
    loop.estimator.lag_s = *config.lag_s;
    loop.controller.lag_s = *config.lag_s;
  }
  if (config.acceleration_mm_s2) loop.limits.acceleration_mm_s2 = *config.acceleration_mm_s2;
  if (config.jerk_mm_s3) loop.limits.jerk_mm_s3 = *config.jerk_mm_s3;
  if (config.remainder) loop.estimator.remainder = config.remainder;
}

}  // namespace cargobay::hal
