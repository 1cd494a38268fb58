// The columns of a kind of record: one table from which the header of CSV, the members of JSON in
// files and in a feed, their schemas and their documentation are made, and by which a feed is read.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "hal/columns/value.hpp"
#include "hal/json_object.hpp"

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
  // Puts a value of the column's kind into the record; empty if it follows from other columns.
  std::function<void(Record& record, const Value& value)> take{};
};
template <typename Record>
using Columns = std::vector<Column<Record>>;

// A record's members, without what is not known, into the JSON object that is open in `out`.
template <typename Record>
void append_members(std::string& out, const Columns<Record>& columns, const Record& record) {
  MemberWriter members{out};
  for (const Column<Record>& column : columns) members.put(column.path, column.value(record));
  members.end();
}
// The same as an object of its own.
template <typename Record>
void append_json(std::string& out, const Columns<Record>& columns, const Record& record) {
  out += '{';
  append_members(out, columns, record);
  out += '}';
}
// The same behind what is in the object already, which is something.
template <typename Record>
void put_columns(JsonObject& object, const Columns<Record>& columns, const Record& record) {
  std::string members;
  append_members(members, columns, record);
  object.members(members);
}

// A kind of record, for what lists them all.
struct TopicInfo {
  std::string_view name{};  // "states"
  std::string_view meaning{};
  std::vector<const ColumnInfo*> columns{};
};

// Rows of a Markdown table: name, unit and meaning of each column.
std::string markdown_rows(const TopicInfo& topic);

}  // namespace cargobay::hal
