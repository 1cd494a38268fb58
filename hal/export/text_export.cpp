#include "hal/export/text_export.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

namespace cargobay::hal {
namespace {

// Of each kind of record, its topic and its columns.
template <typename Record>
struct Of;
template <>
struct Of<StateRecord> {
  static constexpr Topic kTopic = Topic::states;
  static const Columns<StateRecord>& columns() { return state_columns(); }
};
template <>
struct Of<SensorRecord> {
  static constexpr Topic kTopic = Topic::sensors;
  static const Columns<SensorRecord>& columns() { return sensor_columns(); }
};
template <>
struct Of<EventRecord> {
  static constexpr Topic kTopic = Topic::events;
  static const Columns<EventRecord>& columns() { return event_columns(); }
};
template <>
struct Of<CommandRecord> {
  static constexpr Topic kTopic = Topic::commands;
  static const Columns<CommandRecord>& columns() { return command_columns(); }
};

constexpr std::size_t kPieceBytes = std::size_t{1} << 16U;

// What CSV and lines of JSON share; `Format` writes one record.
template <typename Format>
class TextExport final : public Export {
 public:
  TextExport(Topics topics, WriteBytes write)
      : topics_{topics}, write_{std::move(write)}, format_{topics, text_} {}

  void take(const StateRecord& record) override { put(record); }
  void take(const SensorRecord& record) override { put(record); }
  void take(const EventRecord& record) override { put(record); }
  void take(const CommandRecord& record) override { put(record); }
  const Result<void>& written() const override { return written_; }
  Result<void> finish() override {
    if (written_ && !text_.empty()) written_ = write_(text_);
    text_.clear();
    return written_;
  }

 private:
  template <typename Record>
  void put(const Record& record) {
    if (!topics_.has(Of<Record>::kTopic)) return;
    format_.put(text_, record);
    if (text_.size() >= kPieceBytes) (void)finish();  // written() keeps the result
  }

  Topics topics_;
  WriteBytes write_;
  Result<void> written_{};
  std::string text_{};
  Format format_;
};

class JsonLines {
 public:
  JsonLines(Topics /*topics*/, std::string& /*out*/) {}
  template <typename Record>
  void put(std::string& out, const Record& record) {
    ((out += R"({"topic":")") += name(Of<Record>::kTopic)) += '"';
    append_members(out, Of<Record>::columns(), record);
    out += "}\n";
  }
};

class Csv {
 public:
  Csv(Topics topics, std::string& out) {
    std::vector<std::string> header{"topic"};
    for (std::size_t i = 0; i < kTopics; ++i) {
      const auto topic = static_cast<Topic>(i);
      if (!topics.has(topic)) continue;
      for (const ColumnInfo* const column : info(topic).columns) {
        auto place = std::ranges::find(header, column->path);
        if (place == header.end()) place = header.insert(header.end(), column->path);
        places_[i].push_back(static_cast<std::size_t>(place - header.begin()));
      }
    }
    columns_ = header.size();
    for (const std::string& column : header) (out += column) += ',';
    out.back() = '\n';
  }
  template <typename Record>
  void put(std::string& out, const Record& record) {
    const std::vector<std::size_t>& places = places_[static_cast<std::size_t>(Of<Record>::kTopic)];
    cells_.assign(columns_, Value{});
    for (std::size_t i = 0; i < places.size(); ++i)
      cells_[places[i]] = Of<Record>::columns()[i].value(record);
    out += name(Of<Record>::kTopic);
    for (std::size_t i = 1; i < columns_; ++i) append_csv(out += ',', cells_[i]);
    out += '\n';
  }

 private:
  std::array<std::vector<std::size_t>, kTopics> places_{};  // of a topic's columns in the header
  std::size_t columns_ = 0;
  std::vector<Value> cells_{};
};

}  // namespace

std::unique_ptr<Export> csv_export(Topics topics, WriteBytes write) {
  return std::make_unique<TextExport<Csv>>(topics, std::move(write));
}

std::unique_ptr<Export> json_lines_export(Topics topics, WriteBytes write) {
  return std::make_unique<TextExport<JsonLines>>(topics, std::move(write));
}

}  // namespace cargobay::hal
