// What users read of the settings, made from their table: the keys of cargobay.toml(5), and the
// example file.
#include <cctype>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hal/config/setting_table.hpp"

namespace cargobay::hal {
namespace {

constexpr const char* kManualPage = CARGOBAY_SOURCE_DIR "/docs/man/cargobay.toml.5";
constexpr const char* kExample = CARGOBAY_SOURCE_DIR "/examples/system/cargobay.toml";
constexpr std::size_t kWidth = 100;

std::string contents_of(const char* path) {
  std::ostringstream text;
  text << std::ifstream{path}.rdbuf();
  return text.str();
}

bool writes_docs() {
  // NOLINTNEXTLINE(concurrency-mt-unsafe): one thread
  return std::getenv("CARGOBAY_WRITE_DOCS") != nullptr;
}

std::string_view kind(const SettingMember& member) {
  struct Kind {
    std::string_view operator()(std::string Config::*) const { return "text"; }
    std::string_view operator()(std::optional<rt::Remainder> Config::*) const { return "text"; }
    std::string_view operator()(bool Config::*) const { return "true or false"; }
    std::string_view operator()(std::optional<std::uint32_t> Config::*) const { return "number"; }
    std::string_view operator()(std::optional<double> Config::*) const { return "number"; }
    std::string_view operator()(std::optional<int> Config::*) const { return "number"; }
  };
  return std::visit(Kind{}, member);
}

// "Distance between the wheels, 50 to 1000 mm."
std::string sentence(const Setting& setting) {
  std::string text{setting.meaning};
  if (setting.range) text += ", " + setting.range->words();
  if (setting.range && !setting.unit.empty()) text += " " + std::string{setting.unit};
  return text + ".";
}

std::vector<Setting> settings_of(std::string_view table) {
  std::vector<Setting> found;
  for (const Setting& setting : settings()) {
    if (setting.table == table) found.push_back(setting);
  }
  return found;
}

std::string in_manual_page(std::string_view table) {
  std::string text;
  for (const Setting& setting : settings_of(table)) {
    text += ".TP\n.BR " + std::string{setting.key} + " \" = " + std::string{kind(setting.member)} +
            "\"\n";
    for (const char character : sentence(setting))
      text += character == '-' ? std::string{"\\-"} : std::string{character};
    text += "\nLeft out: " + std::string{setting.left_out} + ".\n";
  }
  return text;
}

// As comment lines, with their ends.
std::string comment(const std::string& text) {
  std::string lines;
  std::string line = "#";
  std::istringstream words{text};
  for (std::string word; words >> word;) {
    if (line.size() + 1 + word.size() > kWidth) {
      lines += line + "\n";
      line = "#";
    }
    line += " " + word;
  }
  return lines + line + "\n";
}

std::string in_example(std::string_view table) {
  std::string text = table.empty() ? "" : "#[" + std::string{table} + "]\n";
  for (const Setting& setting : settings_of(table)) {
    text += comment(sentence(setting) + " Left out: " + std::string{setting.left_out} + ".");
    text += "#" + std::string{setting.key} + " = " + std::string{setting.example} + "\n";
  }
  return text;
}

struct Section {
  std::string_view table;
  std::string begin;  // the text before it
  std::string end;    // and after it; empty: the end of the file
};

// The file with each section as it is made from the table.
std::string remade(std::string text, const std::vector<Section>& sections,
                   std::string (*make)(std::string_view table)) {
  for (const Section& section : sections) {
    const std::size_t begin = text.find(section.begin);
    EXPECT_NE(begin, std::string::npos) << section.begin;
    if (begin == std::string::npos) return text;
    const std::size_t from = begin + section.begin.size();
    const std::size_t to = section.end.empty() ? text.size() : text.find(section.end, from);
    EXPECT_NE(to, std::string::npos) << section.end;
    text.replace(from, to - from, make(section.table));
  }
  return text;
}

void expect_fresh(const char* path, const std::vector<Section>& sections,
                  std::string (*make)(std::string_view table)) {
  const std::string made = remade(contents_of(path), sections, make);
  if (writes_docs()) std::ofstream{path} << made;
  EXPECT_EQ(contents_of(path), made)
      << path << " is stale: CARGOBAY_WRITE_DOCS=1 makes this test write it";
}

TEST(SettingsPage, OfTheManualIsNotStale) {
  expect_fresh(kManualPage,
               {{"", ".SH KEYS\n", ".SS [pins.brc]"},
                {"robot", ".SS [robot]\n", ".SS [realtime]\n"},
                {"realtime", ".SS [realtime]\n", ".SH EXAMPLES"}},
               &in_manual_page);
}

TEST(SettingsPage, OfTheExampleIsNotStale) {
  expect_fresh(
      kExample,
      {{"", "reported with its line.\n\n", "\n# Wires between"},
       {"robot", "#line = 23\n#active_low = false\n#bias = \"pull_down\"\n\n", "\n#[realtime]"},
       {"realtime", "stop_if_implausible = true\n\n", ""}},
      &in_example);
}

TEST(SettingsPage, SaysOfEachSettingAllThatUsersAsk) {
  for (const Setting& setting : settings()) {
    EXPECT_FALSE(setting.meaning.empty() || setting.meaning.ends_with('.')) << setting.key;
    EXPECT_FALSE(setting.left_out.empty() || setting.example.empty()) << setting.key;
    const std::string_view numeric = kind(setting.member);
    EXPECT_EQ(numeric == "number" && setting.key != "baud", setting.range.has_value())
        << setting.key;
  }
}

}  // namespace
}  // namespace cargobay::hal
