#include "hal/learnt/learnt_file.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <locale>
#include <optional>
#include <sstream>
#include <system_error>

#include "hal/file/output_file.hpp"
#include "hal/file/read_input.hpp"
#include "hal/range.hpp"

// Set up to return errors, not to throw them: hal/CMakeLists.txt.
#include <toml++/toml.h>

namespace cargobay::hal {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kVersion = 1;

// A number of the file. Within these bounds, whatever is in it does no harm.
struct Number {
  const char* key = "";
  double rt::LearntPlant::* member = nullptr;
  Range range{};
};
constexpr Range kSpread{0.0, 10.0};
constexpr Range kGain{0.3, 1.5};
constexpr Range kRampS2Mm{0.0, 0.1};
using P = rt::LearntPlant;
constexpr std::array kNumbers{
    Number{"lag_s", &P::lag_s, kLagS},
    Number{"lag_sd_s", &P::lag_sd_s, kSpread},
    Number{"dead_time_s", &P::dead_time_s, {0.0, 0.5}},
    Number{"dead_time_sd_s", &P::dead_time_sd_s, kSpread},
    Number{"ramp_s2_mm", &P::ramp_s2_mm, kRampS2Mm},
    Number{"ramp_sd_s2_mm", &P::ramp_sd_s2_mm, kRampS2Mm},
    Number{"gain_left", &P::gain_left, kGain},
    Number{"gain_left_sd", &P::gain_left_sd, kSpread},
    Number{"gain_right", &P::gain_right, kGain},
    Number{"gain_right_sd", &P::gain_right_sd, kSpread},
    Number{"moved_s", &P::moved_s, {0.0, 1e9}},
};

constexpr std::string_view kFirst = "# What Cargobay has learnt";
constexpr const char* kComment =
    "# What Cargobay has learnt of the wheels of the robot at this port. The next drive begins "
    "from\n"
    "# it, and replaces it. Delete it, or drive with --forget, after other wheels or motors.\n";

}  // namespace

std::string learnt_text(const LearntRecord& record) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << kComment << "version = " << kVersion << '\n'
       << "port = " << toml::value<std::string>{record.port} << '\n';
  for (const Number& number : kNumbers)
    text << number.key << " = " << record.plant.*number.member << '\n';
  if (record.plant.remainder != rt::RemainderBelief::unknown) {
    const bool carried = record.plant.remainder == rt::RemainderBelief::carried;
    text << "remainder = " << (carried ? "'carried'" : "'lost'") << '\n';
  }
  return text.str();
}

Result<LearntRecord> parse_learnt(std::string_view text) {
  const toml::parse_result parsed = toml::parse(text);
  if (!parsed) return Failure{"is not TOML: " + std::string{parsed.error().description()}};
  const toml::table& table = parsed.table();
  if (table["version"].value<std::int64_t>() != kVersion)
    return Failure{"is not a file of version " + std::to_string(kVersion)};
  LearntRecord record{.port = table["port"].value_or(std::string{})};
  for (const Number& number : kNumbers) {
    const std::optional<double> value = table[number.key].value<double>();
    if (!value || !number.range.contains(*value)) {
      return Failure{std::string{number.key} + " must be a number from " + number.range.words()};
    }
    record.plant.*number.member = *value;
  }
  const std::string kind = table["remainder"].value_or(std::string{});
  if (kind == "carried") record.plant.remainder = rt::RemainderBelief::carried;
  if (kind == "lost") record.plant.remainder = rt::RemainderBelief::lost;
  return record;
}

Result<rt::LearntPlant> load_learnt(const std::string& file, const std::string& port) {
  const auto text = read_input(file, {.most_bytes = kMostConfigBytes});
  if (!text) return text.failure();
  const auto record = parse_learnt(*text);
  if (!record) return record.failure();
  if (record->port != port) return Failure{"is of the robot at " + record->port};
  return record->plant;
}

bool is_of_another_kind(const std::string& file) {
  const auto text =
      read_input(file, {.most_bytes = kMostConfigBytes, .begins_with = std::string{kFirst}});
  return text && !text->empty() && text->front() != '\0' && !text->starts_with(kFirst);
}

Result<void> save_learnt(const std::string& file, const LearntRecord& record) {
  std::error_code error;
  const fs::path folder = fs::path{file}.parent_path();
  if (!folder.empty() && !fs::exists(folder, error) && fs::create_directories(folder, error))
    fs::permissions(folder, fs::perms::owner_all, error);  // if it fails, the umask's are fine too
  auto output = OutputFile::open(file);
  if (!output) return output.failure();
  if (auto done = output->write(learnt_text(record)); !done) return done;
  return output->publish();
}

bool worth_keeping(const rt::LearntPlant& plant) {
  constexpr double kLeastS = 3.0;
  constexpr double kKnown = 0.1;  // standard deviation of a gain
  constexpr Range kMotor{0.45, 1.35};
  return plant.moved_s >= kLeastS && std::max(plant.gain_left_sd, plant.gain_right_sd) <= kKnown &&
         kMotor.contains(plant.gain_left) && kMotor.contains(plant.gain_right);
}

}  // namespace cargobay::hal
