#include "hal/config/config.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <limits>
#include <span>
#include <sstream>
#include <variant>

#include "hal/config/line_hint.hpp"
#include "hal/config/setting_table.hpp"
#include "hal/config/settings.hpp"
#include "hal/file/read_input.hpp"
#include "oi/dialect.hpp"
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

  Result<void> read(const toml::table& root) { return take(root, "", root_keys()); }

 private:
  // `name` is that of the table.
  Result<void> take(const toml::table& table, std::string_view name, std::span<const Key> keys);
  Failure at(const toml::source_region& where, const std::string& what) const {
    return {file_ + ":" + std::to_string(where.begin.line) + ": " + what};
  }
  Key table(std::string_view name, const std::function<std::vector<Key>()>& keys);

  std::vector<Key> root_keys();
  std::vector<Key> keys_of(std::string_view table);
  std::vector<Key> pins_keys();
  static std::vector<Key> output_keys(PinSetting& pin);
  static std::vector<Key> input_keys(PinSetting& pin);

  const std::string& file_;
  Config& config_;
  Result<void> inside_{};  // what came of the table inside this one
};

Key text_key(std::string_view name, std::string& target) {
  return {name, [&target](const toml::node& node) -> Complaint {
            const auto* text = node.as_string();
            if (text == nullptr) return "must be text in quotes";
            target = text->get();
            return std::nullopt;
          }};
}

Key flag_key(std::string_view name, const std::function<void(bool)>& set) {
  return {name, [set](const toml::node& node) -> Complaint {
            const auto* flag = node.as_boolean();
            if (flag == nullptr) return "must be true or false";
            set(flag->get());
            return std::nullopt;
          }};
}

// A number in quotes is text.
std::string_view unless_quoted(const toml::node& node) {
  return node.is_string() ? ", without quotes" : "";
}

// Rates are said in thousands, and round: 57 or 115.2.
std::string likely_rate(double value) {
  constexpr double kThousand = 1e3;
  constexpr double kNear = 0.02;
  for (const std::uint32_t rate : oi::kCreate.baud_rates) {
    if (std::abs(value * kThousand - rate) <= kNear * rate)
      return "; thousands? did you mean " + std::to_string(rate);
  }
  return "";
}

// Takes the value of a setting, by the type of its member.
struct TakeSetting {
  const Setting& setting;
  const toml::node& node;
  Config& config;

  Complaint operator()(std::string Config::* member) const {
    const auto* text = node.as_string();
    if (text == nullptr) return "must be text in quotes";
    config.*member = text->get();
    return std::nullopt;
  }
  Complaint operator()(std::optional<std::uint32_t> Config::* member) const {
    const auto* number = node.as_integer();
    const bool fits = number != nullptr && number->get() >= 0 &&
                      number->get() <= std::numeric_limits<std::int32_t>::max();
    const auto baud = fits ? static_cast<std::uint32_t>(number->get()) : 0U;
    if (!oi::kCreate.baud_code(baud)) {
      return "must be one of the robot's rates, such as 57600 or 19200" +
             std::string{unless_quoted(node)} + likely_rate(node.value<double>().value_or(0.0));
    }
    config.*member = baud;
    return std::nullopt;
  }
  Complaint operator()(std::optional<double> Config::* member) const {
    const std::optional<double> number = node.value<double>();
    const Range range = setting.range.value_or(Range{});
    if (!number || !range.contains(*number)) {
      const std::string unit = setting.unit.empty() ? "" : "in " + std::string{setting.unit} + ", ";
      return "must be a number from " + range.words() + ", " + unit +
             std::string{setting.not_unit} + std::string{unless_quoted(node)} +
             likely_meaning(range, setting.mistakes, number.value_or(0.0));
    }
    config.*member = number;
    return std::nullopt;
  }
  Complaint operator()(std::optional<int> Config::* member) const {
    const auto* number = node.as_integer();
    const Range range = setting.range.value_or(Range{});
    if (number == nullptr || !range.contains(static_cast<double>(number->get())))
      return "must be a whole number from " + range.words() + std::string{unless_quoted(node)};
    config.*member = static_cast<int>(number->get());
    return std::nullopt;
  }
  Complaint operator()(std::optional<rt::Remainder> Config::* member) const {
    const std::string text = node.value<std::string>().value_or("");
    if (text != "carried" && text != "lost") return "must be \"carried\" or \"lost\"";
    config.*member = text == "lost" ? rt::Remainder::lost : rt::Remainder::carried;
    return std::nullopt;
  }
  Complaint operator()(bool Config::* member) const {
    const auto* flag = node.as_boolean();
    if (flag == nullptr) return "must be true or false";
    config.*member = flag->get();
    return std::nullopt;
  }
};

Key line_key(std::string& target) {
  return {"line", [&target](const toml::node& node) -> Complaint {
            if (const auto* offset = node.as_integer(); offset != nullptr && offset->get() >= 0) {
              target = std::to_string(offset->get());
              return std::nullopt;
            }
            const auto* name = node.as_string();
            if (name == nullptr || name->get().empty())
              return "must be the line's offset, or its name in quotes";
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
              return "must be \"as_is\", \"disabled\", \"pull_up\" or \"pull_down\"";
            }
            return std::nullopt;
          }};
}

Key active_low_key(PinSetting& pin) {
  return flag_key("active_low", [&pin](bool low) {
    pin.polarity = low ? gpio::Polarity::inverted : gpio::Polarity::direct;
  });
}

// Where a key belongs that the table does not have: "; it belongs at the top of the file, before
// any [table]". Empty if no table has it.
std::string its_place(std::string_view key, std::string_view table) {
  constexpr std::array<std::string_view, 4> kPins{"brc", "power", "power_sense", "charging"};
  constexpr std::array<std::string_view, 5> kOfPins{"chip", "line", "active_low", "bias",
                                                    "open_drain"};
  const auto is_key = [key](std::string_view name) { return oi::is_spelt_alike(name, key); };
  for (const Setting& setting : settings()) {
    if (setting.table == table || !is_key(setting.key)) continue;
    if (setting.table.empty()) return "; it belongs at the top of the file, before any [table]";
    return "; it belongs under [" + std::string{setting.table} + "]";
  }
  if (table != "pins" && std::ranges::any_of(kPins, is_key))
    return "; it is a table: [pins." + std::string{key} + "]";
  if (std::ranges::any_of(kOfPins, is_key)) return "; it belongs under a pin, such as [pins.brc]";
  return "";
}

// What to say of a key that the table does not have.
std::string hint_for(std::string_view key, std::string_view table, std::span<const Key> keys) {
  oi::NearestName nearest{key};
  for (const Key& each : keys) nearest.consider(each.name);
  std::string place = its_place(key, table);
  if (!nearest.name().empty() && (place.empty() || oi::is_spelt_alike(nearest.name(), key)))
    return "; did you mean " + std::string{nearest.name()} + "?";
  if (!place.empty()) return place;
  std::string list;
  for (const Key& each : keys)
    list += (list.empty() ? "; the keys are: " : ", ") + std::string{each.name};
  return list;
}

Result<void> Reader::take(const toml::table& table, std::string_view name,
                          std::span<const Key> keys) {
  for (auto&& [word, node] : table) {
    const auto found = std::ranges::find(keys, word.str(), &Key::name);
    if (found == keys.end()) {
      return at(word.source(),
                "unknown key " + std::string{word.str()} + hint_for(word.str(), name, keys));
    }
    const Complaint wrong = found->take(node);
    if (!inside_) return inside_;
    if (wrong) return at(node.source(), std::string{word.str()} + " " + *wrong);
  }
  return {};
}

Key Reader::table(std::string_view name, const std::function<std::vector<Key>()>& keys) {
  return {name, [this, name, keys](const toml::node& node) -> Complaint {
            const toml::table* inside = node.as_table();
            if (inside == nullptr) return "must be a table, with keys of its own";
            inside_ = take(*inside, name, keys());
            return std::nullopt;
          }};
}

std::vector<Key> Reader::root_keys() {
  std::vector<Key> keys = keys_of("");
  for (const Setting& setting : settings()) {
    const bool known =
        std::ranges::any_of(keys, [&setting](const Key& key) { return key.name == setting.table; });
    if (setting.table.empty() || known) continue;
    keys.push_back(table(setting.table, [this, name = setting.table] { return keys_of(name); }));
  }
  keys.push_back(table("pins", [this] { return pins_keys(); }));
  return keys;
}

std::vector<Key> Reader::keys_of(std::string_view table) {
  std::vector<Key> keys;
  for (const Setting& setting : settings()) {
    if (setting.table != table) continue;
    keys.push_back({setting.key, [this, &setting](const toml::node& node) {
                      return std::visit(TakeSetting{setting, node, config_}, setting.member);
                    }});
  }
  return keys;
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

std::string personal_file() {
  const char* xdg = std::getenv("XDG_CONFIG_HOME");  // NOLINT(concurrency-mt-unsafe): set-up
  if (xdg != nullptr && *xdg != '\0') return std::string{xdg} + "/cargobay.toml";
  const char* home = std::getenv("HOME");  // NOLINT(concurrency-mt-unsafe): set-up
  return home == nullptr ? "" : std::string{home} + "/.config/cargobay.toml";
}

Result<void> read_file(const std::string& file, Config& config) {
  const auto text = read_input(file, {.most_bytes = kMostConfigBytes});
  if (text) return read_config(*text, file, config);
  return Failure{"cannot read the configuration " + file + ": " + text.failure().message,
                 text.failure().code};
}

}  // namespace

Result<void> read_config(std::string_view text, const std::string& file, Config& config) {
  const toml::parse_result parsed = toml::parse(text);
  if (!parsed) {
    const toml::parse_error& error = parsed.error();
    const std::size_t line = error.source().begin.line;
    return Failure{file + ":" + std::to_string(line) +
                   ": not TOML: " + std::string{error.description()} +
                   (error.description().find("redefine") == std::string_view::npos
                        ? line_hint(text, line)
                        : "; it is there already, further up: keep one of them")};
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
    if (const auto done = read_file(each, config); !done) return done.failure();
  }
  return config;
}

void apply(const Config& config, CycleParameters& parameters) {
  for (const Setting& setting : settings()) {
    const bool said = std::visit(
        [&config](auto member) {
          if constexpr (requires { (config.*member).has_value(); }) {
            return (config.*member).has_value();
          } else {
            return true;
          }
        },
        setting.member);
    if (said && setting.apply != nullptr) setting.apply(config, parameters);
  }
}

}  // namespace cargobay::hal
