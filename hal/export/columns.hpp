// The columns of a kind of record: one table from which the header of CSV, the members of JSON, the
// schemas of MCAP and the documentation are made.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "hal/export/value.hpp"

namespace cargobay::hal {

struct ColumnInfo {
  enum class Kind : std::uint8_t { truth, whole, number, text, words };
  std::string path{};  // `estimate_mm_s.left`: in CSV the name, in JSON a member of a member
  Kind kind = Kind::number;
  std::string unit{};  // as printed; empty: none
  std::string meaning{};
};

template <typename Record>
struct Column : ColumnInfo {
  std::function<Value(const Record& record)> value{};
};
template <typename Record>
using Columns = std::vector<Column<Record>>;

// A record as one JSON object, without what is not known.
template <typename Record>
void append_json(std::string& out, const Columns<Record>& columns, const Record& record) {
  ObjectWriter object{out};
  for (const Column<Record>& column : columns) object.put(column.path, column.value(record));
  object.close();
}

// A kind of record, for what lists them all.
struct TopicInfo {
  std::string_view name{};  // "states"
  std::string_view meaning{};
  std::vector<const ColumnInfo*> columns{};
};

// The JSON schema (draft 7) of a topic's objects: types, units and meanings. None of the members is
// required.
std::string json_schema(const TopicInfo& topic);

// Rows of a Markdown table: name, unit and meaning of each column.
std::string markdown_rows(const TopicInfo& topic);

}  // namespace cargobay::hal
