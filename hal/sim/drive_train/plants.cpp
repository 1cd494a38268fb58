#include "hal/sim/drive_train/plants.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>

#include "hal/sim/next_word.hpp"

namespace cargobay::hal::sim {

namespace {

template <typename Value>
struct Named {
  std::string_view name;
  Value value;
};
constexpr std::array kResponses{Named{"first-order", Response::first_order},
                                Named{"counting", Response::counting}};
constexpr std::array kSigns{Named{"commanded", CounterSign::commanded},
                            Named{"true", CounterSign::true_one}};
constexpr const auto& names_of(Response /*of*/) { return kResponses; }
constexpr const auto& names_of(CounterSign /*of*/) { return kSigns; }

std::string text(double number) {
  std::array<char, 32> digits{};
  constexpr int kDigits = 12;  // those beyond are rounding
  char* const last = digits.data() + digits.size();
  const char* const end =
      std::to_chars(digits.data(), last, number, std::chars_format::general, kDigits).ptr;
  return std::string(static_cast<const char*>(digits.data()), end);
}

bool takes(const PlantValue& value, double number) {
  return value.range.contains(number) || (value.or_none && number == 0.0);
}

struct RangeOf {
  const PlantValue& value;
  std::string_view between;

  std::string operator()(double WheelParameters::* /*member*/) const {
    return (value.or_none ? "0, or " : "") + value.range.words();
  }
  template <typename Choice>
  std::string operator()(Choice WheelParameters::* /*member*/) const {
    const auto& names = names_of(Choice{});
    return std::string{names[0].name} + std::string{between} + std::string{names[1].name};
  }
};

struct TextOf {
  const WheelParameters& parameters;

  std::string operator()(double WheelParameters::* member) const {
    return text(parameters.*member);
  }
  template <typename Choice>
  std::string operator()(Choice WheelParameters::* member) const {
    const auto& names = names_of(Choice{});
    return std::string{parameters.*member == names[0].value ? names[0].name : names[1].name};
  }
};

struct SetTo {
  const PlantValue& value;
  std::string_view word;
  WheelParameters& parameters;

  std::string operator()(double WheelParameters::* member) const {
    constexpr double kMost = std::numeric_limits<double>::max();
    const std::optional<double> number = to_number(word, -kMost, kMost);
    if (number && takes(value, *number)) {
      parameters.*member = *number;
      return {};
    }
    const std::string wrong =
        std::string{value.name} + " is " + std::string{value.unit.words} + ", " + range_of(value);
    return wrong + likely_meaning(value.range, value.unit.mistakes, number.value_or(0.0));
  }
  template <typename Choice>
  std::string operator()(Choice WheelParameters::* member) const {
    for (const auto& named : names_of(Choice{})) {
      if (named.name != word) continue;
      parameters.*member = named.value;
      return {};
    }
    return std::string{value.name} + " is " + range_of(value);
  }
};

// What belongs to the robot and not to how its wheels answer.
WheelParameters on_the_chassis_of(const WheelParameters& robot, WheelParameters wheels) {
  wheels.counts_per_mm = robot.counts_per_mm;
  wheels.wheel_base_mm = robot.wheel_base_mm;
  return wheels;
}

const PlantValue* value_named(std::string_view name) {
  const auto value = std::ranges::find(plant_values(), name, &PlantValue::name);
  return value == plant_values().end() ? nullptr : &*value;
}

// Takes a kind of wheels off the front, if there is one. `ramp` is one, `ramp 300` is not.
const Plant* take_plant(std::string_view& words) {
  std::string_view rest = words;
  const std::string_view name = next_word(rest);
  std::string_view ahead = rest;
  const std::string_view next = next_word(ahead);
  const auto plant = std::ranges::find(plants(), name, &Plant::name);
  const bool has_number = !next.empty() && value_named(next) == nullptr;
  if (plant == plants().end() || (has_number && value_named(name) != nullptr)) return nullptr;
  words = rest;
  return &*plant;
}

std::string known() {
  std::string list = "the plants are: " + plant_names() + "; the values are:";
  for (const PlantValue& value : plant_values()) list += " " + std::string{value.name};
  return list;
}

}  // namespace

std::string plant_names() {
  std::string list;
  for (const Plant& plant : plants()) list += (list.empty() ? "" : " ") + std::string{plant.name};
  return list;
}

std::string range_of(const PlantValue& value, std::string_view between_choices) {
  return std::visit(RangeOf{value, between_choices}, value.member);
}

std::string value_of(const PlantValue& value, const WheelParameters& parameters) {
  return std::visit(TextOf{parameters}, value.member);
}

std::string set_value(const PlantValue& value, std::string_view word, WheelParameters& parameters) {
  return std::visit(SetTo{value, word, parameters}, value.member);
}

std::string set_plant(std::string_view words, WheelParameters& parameters) {
  WheelParameters taken = parameters;
  if (const Plant* const plant = take_plant(words))
    taken = on_the_chassis_of(parameters, plant->parameters);
  for (std::string_view word = next_word(words); !word.empty(); word = next_word(words)) {
    const PlantValue* const value = value_named(word);
    if (value == nullptr) return "unknown plant or value '" + std::string{word} + "'; " + known();
    if (std::string wrong = set_value(*value, next_word(words), taken); !wrong.empty())
      return wrong;
  }
  parameters = taken;
  return {};
}

std::optional<std::string_view> plant_name(const WheelParameters& parameters) {
  const auto plant = std::ranges::find_if(plants(), [&parameters](const Plant& known) {
    return on_the_chassis_of(parameters, known.parameters) == parameters;
  });
  if (plant == plants().end()) return std::nullopt;
  return plant->name;
}

}  // namespace cargobay::hal::sim
