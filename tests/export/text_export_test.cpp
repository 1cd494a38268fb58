// CSV and lines of JSON say the same.
#include "hal/export/text_export.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <system_error>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/export/collected.hpp"
#include "tests/hal/recorded_drive.hpp"

namespace cargobay::hal {
namespace {

using nlohmann::json;
using test::RecordedDrive;
using test::retold;

std::vector<std::uint8_t> bumpy_drive() {
  RecordedDrive drive;
  drive.on_frame = [&](int frame) {
    if (frame == 100) drive.device.inputs().bump_left = true;
    if (frame == 150) drive.device.inputs().cliff_left.cliff = true;  // ends it
  };
  drive.run(400);
  return drive.file();
}

WriteBytes to(std::string& text) {
  return [&text](std::string_view bytes) -> Result<void> {
    text += bytes;
    return {};
  };
}

std::string exported(const std::vector<std::uint8_t>& file, auto make, Topics topics) {
  std::string text;
  const std::unique_ptr<Export> out = make(topics, to(text));
  (void)retold(file, *out);
  EXPECT_TRUE(out->finish());
  return text;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in{text};
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

// None of our texts has line breaks.
std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells{""};
  bool quoted = false;
  for (const char c : line) {
    if (c == '"') quoted = !quoted;
    if (c == ',' && !quoted) cells.emplace_back();
    if (c != '"' && (c != ',' || quoted)) cells.back() += c;
  }
  return cells;
}

// As CSV has them, by their columns.
void flatten(const json& object, const std::string& prefix,
             std::map<std::string, std::string>& cells) {
  for (const auto& [key, value] : object.items()) {
    if (value.is_object()) {
      flatten(value, prefix + key + ".", cells);
    } else if (value.is_array()) {
      std::string words;
      for (const auto& word : value) words += (words.empty() ? "" : ";") + word.get<std::string>();
      cells[prefix + key] = words.empty() ? "none" : words;
    } else if (value.is_boolean()) {
      cells[prefix + key] = value.get<bool>() ? "1" : "0";
    } else {
      cells[prefix + key] = value.is_string() ? value.get<std::string>() : value.dump();
    }
  }
}

TEST(TextExport, HasTheSameInBothFormats) {
  const auto file = bumpy_drive();
  const auto csv = lines_of(exported(file, csv_export, kAllTopics));
  const auto records = lines_of(exported(file, json_lines_export, kAllTopics));
  const std::vector<std::string> header = cells_of(csv.at(0));
  ASSERT_EQ(csv.size(), records.size() + 1);
  EXPECT_EQ(std::set<std::string>(header.begin(), header.end()).size(), header.size());
  std::set<std::string> topics;
  for (std::size_t i = 0; i < records.size(); ++i) {
    std::map<std::string, std::string> wanted;
    flatten(json::parse(records[i]), "", wanted);
    const std::vector<std::string> cells = cells_of(csv[i + 1]);
    ASSERT_EQ(cells.size(), header.size());
    for (std::size_t column = 0; column < header.size(); ++column) {
      const std::string& value = wanted[header[column]];
      if (value == cells[column]) continue;
      // The parser has another way to write a number.
      ASSERT_EQ(std::stod(value), std::stod(cells[column])) << header[column];
    }
    topics.insert(cells[0]);
  }
  EXPECT_EQ(topics, (std::set<std::string>{"states", "sensors", "events", "commands"}));
}

TEST(TextExport, HasOnlyTheTopicsThatWereAskedFor) {
  const auto file = bumpy_drive();
  const Topics events = Topics{}.with(Topic::events);
  const auto csv = lines_of(exported(file, csv_export, events));
  ASSERT_GT(csv.size(), 2U);
  EXPECT_THAT(csv[0], testing::StartsWith("topic,unix_time_s,time_s,tick,robot_time_s,what,text"));
  EXPECT_THAT(csv[0], testing::Not(testing::HasSubstr("pose.x_mm")));
  for (std::size_t i = 1; i < csv.size(); ++i) EXPECT_THAT(csv[i], testing::StartsWith("events,"));
  const auto records = lines_of(exported(file, json_lines_export, events));
  EXPECT_EQ(records.size(), csv.size() - 1);
}

TEST(TextExport, EndsWithTheFirstWriteThatFails) {
  int writes = 0;
  const auto out = csv_export(kAllTopics, [&](std::string_view) -> Result<void> {
    ++writes;
    return Failure{"the disk is full"};
  });
  RecordedDrive drive;
  drive.run(1000);
  (void)retold(drive.file(), *out);
  EXPECT_FALSE(out->wants_more());
  EXPECT_EQ(out->finish().failure().message, "the disk is full");
  EXPECT_EQ(writes, 1);
}

// Twice the same name would be two members of one object.
TEST(Columns, HaveNamesOfTheirOwnAndSayWhatTheyAre) {
  for (std::size_t i = 0; i < kTopics; ++i) {
    std::set<std::string> names;
    std::string group;
    std::set<std::string> groups;
    for (const ColumnInfo* const column : info(static_cast<Topic>(i)).columns) {
      EXPECT_TRUE(names.insert(column->path).second) << column->path;
      EXPECT_FALSE(column->meaning.empty()) << column->path;
      const std::size_t dot = column->path.find('.');
      const std::string of = dot == std::string::npos ? "" : column->path.substr(0, dot);
      if (of != group && !of.empty()) {
        EXPECT_TRUE(groups.insert(of).second) << of << " is in two pieces";
      }
      group = of;
    }
  }
}

}  // namespace
}  // namespace cargobay::hal
