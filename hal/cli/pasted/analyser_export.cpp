#include "hal/cli/pasted/analyser_export.hpp"

#include <algorithm>
#include <charconv>
#include <string>

#include <fmt/format.h>

#include "hal/cli/pasted/text_lines.hpp"

namespace cargobay::cli {
namespace {

using TableCells = std::vector<std::string>;

constexpr const char* kUndecoded =
    "there is no column of data or values, and these are no samples of 0 and 1: export what the "
    "analyser (Async Serial, UART) decodes";

std::string lower_case(std::string_view text) {
  std::string lowered{text};
  for (char& c : lowered) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return lowered;
}

// A row of a table, by RFC 4180: quotes around a cell are taken off, doubled quotes halved.
TableCells cells_of(std::string_view row, char separator) {
  TableCells cells(1);
  bool quoted = false;
  for (std::size_t at = 0; at < row.size(); ++at) {
    const char c = row[at];
    if (c == '"' && quoted && at + 1 < row.size() && row[at + 1] == '"') {
      cells.back() += c;
      ++at;
    } else if (c == '"') {
      quoted = !quoted;
    } else if (c == separator && !quoted) {
      cells.emplace_back();
    } else {
      cells.back() += c;
    }
  }
  return cells;
}

std::optional<std::uint8_t> byte_in_base(std::string_view digits, int base) {
  unsigned value = 0;
  const auto [stop, error] =
      std::from_chars(digits.data(), digits.data() + digits.size(), value, base);
  if (error != std::errc{} || stop != digits.data() + digits.size() || value > 255)
    return std::nullopt;
  return static_cast<std::uint8_t>(value);
}

// `0x89`, `\x89`, `'a' (0x61)`.
std::optional<std::uint8_t> hex_cell(std::string_view cell) {
  const std::size_t mark = std::min(cell.find("0x"), cell.find("\\x"));
  if (mark == std::string_view::npos) return std::nullopt;
  std::string_view digits = cell.substr(mark + 2);
  const auto* const end = std::ranges::find_if_not(digits, is_hex_digit);
  digits = digits.substr(0, static_cast<std::size_t>(end - digits.begin()));
  while (digits.size() > 2 && digits.starts_with('0'))
    digits.remove_prefix(1);  // 0x0000000000000089
  return byte_in_base(digits, 16);
}

std::optional<std::uint8_t> character_cell(std::string_view cell) {
  if (cell.size() == 3 && cell.starts_with('\'') && cell.ends_with('\'')) cell = cell.substr(1, 1);
  if (cell.size() == 1) return static_cast<std::uint8_t>(cell[0]);
  constexpr std::string_view kEscapes = "0abtnvfr\\";
  constexpr std::string_view kValues{"\0\a\b\t\n\v\f\r\\", 9};
  const std::size_t at =
      cell.size() == 2 && cell[0] == '\\' ? kEscapes.find(cell[1]) : std::string_view::npos;
  if (at == std::string_view::npos) return std::nullopt;
  return static_cast<std::uint8_t>(kValues[at]);
}

PastedLine& line_named(std::vector<PastedLine>& lines, std::string_view name) {
  const auto found = std::ranges::find(lines, name, &PastedLine::name);
  if (found != lines.end()) return *found;
  return lines.emplace_back(PastedLine{std::string{name}, {}});
}

// The columns of a table of decoded bytes.
struct AnalyserColumns {
  std::optional<std::size_t> data{};
  std::optional<std::size_t> name{};
  std::optional<std::size_t> type{};
};

struct AnalyserRow {
  std::size_t number = 0;  // of its line, from 1
  std::string name{};
  std::string data{};
};

class AnalyserTable {
 public:
  // Whether these are the titles of a table that is known.
  bool begin(std::string_view titles) {
    for (const char separator : {',', ';', '\t'}) {
      separator_ = separator;
      const TableCells cells = cells_of(titles, separator);
      if (cells.size() < 2) continue;
      columns_ = {};
      bool time = false;
      for (std::size_t i = 0; i < cells.size(); ++i) {
        const std::string title = lower_case(trimmed(cells[i]));
        if (title == "data" || title == "value") columns_.data = i;
        if (title == "name" || title == "analyzer name") columns_.name = i;
        if (title == "type") columns_.type = i;
        if (title.starts_with("time") || title.starts_with("start")) time = true;
      }
      if (time) return true;
    }
    return false;
  }

  hal::Result<Pasted> read(const std::vector<std::string_view>& lines, std::size_t first) {
    if (!columns_.data) return hal::Failure{kUndecoded};
    for (std::size_t i = first; i < lines.size(); ++i) {
      if (!trimmed(lines[i]).empty()) add(i + 1, cells_of(lines[i], separator_));
    }
    // Digits are characters if there are others: the export shows text, not numbers.
    const bool characters = std::ranges::any_of(rows_, [](const AnalyserRow& row) {
      if (row.data.find("\\x") != std::string::npos) return true;
      return !hex_cell(row.data) && !byte_in_base(row.data, 10) && character_cell(row.data);
    });
    Pasted pasted{.form = "a table of Saleae Logic"};
    for (const AnalyserRow& row : rows_) {
      std::optional<std::uint8_t> byte = hex_cell(row.data);
      if (!byte && !characters) byte = byte_in_base(row.data, 10);
      if (!byte) byte = character_cell(row.data);
      if (!byte)
        return hal::Failure{fmt::format(
            "line {}: '{}' is not a byte; export the bytes in hexadecimal", row.number, row.data)};
      line_named(pasted.lines, row.name).bytes.push_back(*byte);
    }
    return pasted;
  }

 private:
  void add(std::size_t number, const TableCells& cells) {
    const auto cell = [&cells](std::optional<std::size_t> column) {
      return column && *column < cells.size() ? cells[*column] : std::string{};
    };
    const std::string type = lower_case(cell(columns_.type));
    if (columns_.type && type != "data" && type != "result") return;
    std::string data = cell(columns_.data);
    if (data != " ") data = std::string{trimmed(data)};
    rows_.push_back({number, cell(columns_.name), data});
  }

  char separator_ = ',';
  AnalyserColumns columns_{};
  std::vector<AnalyserRow> rows_{};
};

// `uart-1: 89`, `518-657 uart-1: 89`, `518-657 UART: TX: 89`: its name and its last words.
struct Annotated {
  std::string_view name{};
  std::string_view what{};
};

std::optional<Annotated> annotation_in(std::string_view line) {
  line = trimmed(line);
  const std::size_t digits = std::min(line.find_first_not_of("0123456789-"), line.size());
  if (digits > 0 && line.substr(digits).starts_with(' ')) line = trimmed(line.substr(digits));
  const std::size_t colon = line.rfind(": ");
  if (colon == std::string_view::npos || colon == 0 ||
      std::isalpha(static_cast<unsigned char>(line[0])) == 0)
    return std::nullopt;
  return Annotated{line.substr(0, colon), trimmed(line.substr(colon + 2))};
}

// What a UART decoder writes beside the bytes.
bool is_beside_bytes(std::string_view what) {
  const std::string lowered = lower_case(what);
  return lowered == "0" || lowered == "1" || lowered.find("bit") != std::string::npos ||
         lowered.find("parity") != std::string::npos ||
         lowered.find("error") != std::string::npos || lowered.find("break") != std::string::npos ||
         lowered.find("packet") != std::string::npos;
}

std::optional<hal::Result<Pasted>> read_annotations(const std::vector<std::string_view>& lines) {
  Pasted pasted{.form = "annotations of sigrok"};
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (trimmed(lines[i]).empty()) continue;
    const std::optional<Annotated> annotated = annotation_in(lines[i]);
    const bool pair = annotated && annotated->what.size() == 2;
    const auto byte = pair ? byte_in_base(annotated->what, 16) : std::nullopt;
    if (byte) {
      line_named(pasted.lines, annotated->name).bytes.push_back(*byte);
    } else if (!annotated || !is_beside_bytes(annotated->what)) {
      if (pasted.lines.empty()) return std::nullopt;
      return hal::Failure{
          fmt::format("line {}: '{}' is not a byte of a sigrok decoder", i + 1, trimmed(lines[i]))};
    }
  }
  if (pasted.lines.empty()) return std::nullopt;
  return pasted;
}

}  // namespace

std::optional<hal::Result<Pasted>> read_analyser_export(std::string_view text) {
  const std::vector<std::string_view> lines = lines_of(text);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::string_view line = trimmed(lines[i]);
    if (line.empty()) continue;
    AnalyserTable table;
    if (table.begin(line)) return table.read(lines, i + 1);
    return read_annotations(lines);
  }
  return std::nullopt;
}

}  // namespace cargobay::cli
