#include "hal/cli/pasted/line_samples.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "hal/cli/pasted/text_lines.hpp"

namespace cargobay::cli {
namespace {

struct Edge {
  double time_s = 0.0;
  bool high = true;
};

struct SampledLine {
  std::string name{};
  std::vector<Edge> edges{};  // a level from each on; the first is the level at the beginning

  void add(double time_s, bool high) {
    if (edges.empty() || edges.back().high != high) edges.push_back({time_s, high});
  }
};

std::optional<double> real_number(std::string_view text) {
  text = trimmed(text);
  double value = 0.0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || stop != text.data() + text.size()) return std::nullopt;
  return value;
}

std::vector<std::string_view> parts_of(std::string_view row, char separator) {
  std::vector<std::string_view> parts;
  for (std::size_t begin = 0; begin <= row.size();) {
    const std::size_t end = std::min(row.find(separator, begin), row.size());
    parts.push_back(trimmed(row.substr(begin, end - begin)));
    begin = end + 1;
  }
  return parts;
}

// `1 MHz`, `12.5 kHz`, `1000000`.
std::optional<double> samples_a_second(std::string_view text) {
  text = trimmed(text);
  const std::size_t unit = std::min(text.find(' '), text.size());
  const std::optional<double> number = real_number(text.substr(0, unit));
  if (!number || !(*number > 0.0)) return std::nullopt;
  const std::string_view name = trimmed(text.substr(unit));
  if (name.empty() || name == "Hz") return number;
  if (name == "kHz") return *number * 1e3;
  if (name == "MHz") return *number * 1e6;
  if (name == "GHz") return *number * 1e9;
  return std::nullopt;
}

// What sigrok writes over its column of time; it may also be `Time`.
constexpr std::array<std::string_view, 7> kTimeTitles{"samples",     "milliseconds", "microseconds",
                                                      "nanoseconds", "picoseconds",  "femtoseconds",
                                                      "attoseconds"};

// The step of that column from one sample to the next: a whole number, cut off, of the largest of
// these units that is not longer than a sample.
double sigrok_step(double rate_hz) {
  double units_a_second = 1.0;
  while (units_a_second < rate_hz) units_a_second *= 1e3;
  return std::floor(units_a_second / rate_hz);
}

class SampleReader {
 public:
  explicit SampleReader(std::string_view text) : rows_{lines_of(text)} {}

  // Whether the text begins as such an export.
  bool begin() {
    for (; next_ < rows_.size(); ++next_) {
      const std::string_view row = trimmed(rows_[next_]);
      if (row.empty()) continue;
      if (row.starts_with("; CSV") && row.find("sigrok") != std::string_view::npos) sigrok_ = true;
      if (row.starts_with(';')) {
        const std::string_view value = row.substr(std::min(row.find(": ") + 1, row.size()));
        if (row.starts_with("; Channels")) channels_ = value;
        if (row.starts_with("; Samplerate:")) {
          rate_hz_ = samples_a_second(value);
          step_ = rate_hz_ ? sigrok_step(*rate_hz_) : 0.0;
        }
        continue;
      }
      constexpr std::string_view kRate = "META samplerate:";  // of a file that it has read
      if (row.starts_with(kRate)) {
        rate_hz_ = samples_a_second(row.substr(kRate.size()));
        continue;
      }
      return titles(row);
    }
    return false;
  }

  hal::Result<std::vector<SampledLine>> read() {
    if (sigrok_ && !rate_hz_)
      return hal::Failure{"the samples have no samplerate; export them with the header of sigrok"};
    for (std::size_t index = 0; ++next_ < rows_.size();) {
      const std::string_view row = trimmed(rows_[next_]);
      if (row.empty() || row.starts_with(';')) continue;
      if (!sample(parts_of(row, ','), index)) {
        return hal::Failure{
            fmt::format("line {}: '{}' is not a row of samples", next_ + 1, row.substr(0, 40))};
      }
      ++index;
    }
    return lines_;
  }

 private:
  bool titles(std::string_view row) {
    const std::vector<std::string_view> titles = parts_of(row, ',');
    const bool time = titles[0].starts_with("Time") ||
                      (sigrok_ && std::ranges::find(kTimeTitles, titles[0]) != kTimeTitles.end());
    if (!sigrok_ && !time) return false;
    first_ = time ? 1 : 0;
    const std::vector<std::string_view> names = parts_of(channels_, ',');
    for (std::size_t i = first_; i < titles.size(); ++i) {
      const bool named = sigrok_ && i - first_ < names.size() && !names[i - first_].empty();
      lines_.push_back({std::string{named ? names[i - first_] : titles[i]}, {}});
    }
    return !lines_.empty() && is_sample_next();
  }

  // Tables of decoded bytes begin with a time too.
  bool is_sample_next() const {
    if (sigrok_) return true;
    const auto row =
        std::find_if(rows_.begin() + static_cast<std::ptrdiff_t>(next_) + 1, rows_.end(),
                     [](std::string_view text) { return !trimmed(text).empty(); });
    if (row == rows_.end()) return false;
    const auto cells = parts_of(*row, ',');
    return cells.size() == lines_.size() + 1 &&
           std::all_of(cells.begin() + 1, cells.end(), [](std::string_view cell) {
             return cell == "0" || cell == "1" || cell == "X";
           });
  }

  bool sample(const std::vector<std::string_view>& cells, std::size_t index) {
    if (cells.size() != lines_.size() + first_) return false;
    const auto time = first_ == 0 ? std::optional{0.0} : real_number(cells[0]);
    if (!time) return false;
    double time_s = *time;
    // By its column of time, since rows may be left out that repeat the one before.
    if (sigrok_)
      time_s =
          (step_ > 0.0 && first_ == 1 ? *time / step_ : static_cast<double>(index)) / *rate_hz_;
    for (std::size_t i = 0; i < lines_.size(); ++i) {
      const std::string_view level = cells[i + first_];
      if (level != "0" && level != "1" && level != "X") return false;
      lines_[i].add(time_s, level != "0");
    }
    return true;
  }

  std::vector<std::string_view> rows_;
  std::size_t next_ = 0;  // the row of titles, then the one that is read
  bool sigrok_ = false;
  std::string_view channels_{};
  std::optional<double> rate_hz_{};
  double step_ = 0.0;      // from one sample to the next in sigrok's time; 0 if that stands still
  std::size_t first_ = 0;  // column of the first line
  std::vector<SampledLine> lines_{};
};

struct LineBytes {
  std::vector<std::uint8_t> bytes{};
  std::size_t without_stop = 0;
};

// A start bit is a fall; each bit is read in its middle.
LineBytes read_serial(const std::vector<Edge>& edges, double bit_s) {
  LineBytes read;
  std::size_t at = 0;
  const auto level_at = [&](double time_s) {
    while (at + 1 < edges.size() && edges[at + 1].time_s <= time_s) ++at;
    return edges[at].high;
  };
  while (at + 1 < edges.size()) {
    if (!edges[at].high) {
      ++at;
      continue;
    }
    const double start_s = edges[++at].time_s;
    unsigned byte = 0;
    for (unsigned bit = 0; bit < 8; ++bit)
      byte |= (level_at(start_s + (1.5 + bit) * bit_s) ? 1U : 0U) << bit;
    if (level_at(start_s + 9.5 * bit_s)) {
      read.bytes.push_back(static_cast<std::uint8_t>(byte));
    } else {
      ++read.without_stop;
    }
  }
  return read;
}

}  // namespace

std::optional<hal::Result<Pasted>> read_line_samples(std::string_view text, std::uint32_t baud) {
  SampleReader reader{text};
  if (!reader.begin()) return std::nullopt;
  const auto lines = reader.read();
  if (!lines) return lines.failure();
  Pasted pasted{.form = "samples of a logic analyser"};
  LineBytes all;
  for (const SampledLine& line : *lines) {
    const LineBytes read = read_serial(line.edges, 1.0 / baud);
    all.without_stop += read.without_stop;
    all.bytes.insert(all.bytes.end(), read.bytes.begin(), read.bytes.end());
    if (!read.bytes.empty()) pasted.lines.push_back({line.name, read.bytes});
  }
  const std::size_t count = all.bytes.size() + all.without_stop;
  if (all.without_stop * 10 > count) {
    return hal::Failure{
        fmt::format("{} of {} bytes have no stop bit at {} baud; is another --baud "
                    "right, or the line inverted?",
                    all.without_stop, count, baud)};
  }
  if (pasted.lines.empty())
    return hal::Failure{fmt::format("no line of the samples has a byte at {} baud", baud)};
  return pasted;
}

}  // namespace cargobay::cli
