#include "hal/cli/view/sensor_view.hpp"

#include <algorithm>
#include <array>
#include <initializer_list>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "hal/cli/terminal/print.hpp"
#include "hal/cli/terminal/sensor_format.hpp"
#include "oi/dialect.hpp"

namespace cargobay::cli {
namespace {

using oi::PacketId;

// In the order in which they matter, and short.
struct Label {
  PacketId packet{};
  std::string_view text{};
  bool alarms = false;  // anything but 0 is one
};

constexpr std::array kLabels{
    Label{PacketId::oi_mode, "mode"},
    Label{PacketId::bumps_and_wheel_drops, "", true},
    Label{PacketId::cliff_left, "cliff L", true},
    Label{PacketId::cliff_front_left, "cliff FL", true},
    Label{PacketId::cliff_front_right, "cliff FR", true},
    Label{PacketId::cliff_right, "cliff R", true},
    Label{PacketId::voltage, "battery"},
    Label{PacketId::battery_charge, "charge"},
    Label{PacketId::battery_capacity, "of"},
    Label{PacketId::current, "current"},
    Label{PacketId::charging_state, "charging"},
    Label{PacketId::overcurrents, "overcurrent", true},
    Label{PacketId::distance, "distance"},
    Label{PacketId::angle, "angle"},
    Label{PacketId::wall, "wall"},
    Label{PacketId::virtual_wall, "virtual wall"},
    Label{PacketId::buttons, "buttons"},
    Label{PacketId::infrared_byte, "infrared"},
    Label{PacketId::charging_sources, "charger"},
    Label{PacketId::battery_temperature, "temperature"},
    Label{PacketId::wall_signal, "wall signal"},
    Label{PacketId::cliff_left_signal, "signal L"},
    Label{PacketId::cliff_front_left_signal, "FL"},
    Label{PacketId::cliff_front_right_signal, "FR"},
    Label{PacketId::cliff_right_signal, "R"},
    Label{PacketId::requested_left_velocity, "set left"},
    Label{PacketId::requested_right_velocity, "right"},
    Label{PacketId::requested_velocity, "velocity"},
    Label{PacketId::requested_radius, "radius"},
    Label{PacketId::digital_inputs, "inputs"},
    Label{PacketId::analog_signal, "analog"},
    Label{PacketId::song_number, "song"},
    Label{PacketId::song_playing, "playing"},
    Label{PacketId::stream_packets, "streamed"},
    Label{PacketId::unused_15, "unused 15"},
    Label{PacketId::unused_16, "16"},
};

struct Cell {
  std::string label{};
  std::string text{};
  TextStyle style = TextStyle::plain;

  int width() const { return static_cast<int>(label.size() + text.size()) + 1; }
};

std::optional<std::int64_t> sum_of(PacketId packet, const hal::SensorFrame& frame) {
  if (packet == PacketId::distance) return frame.distance_mm;
  if (packet == PacketId::angle) return frame.angle_deg;
  return std::nullopt;
}

std::string value(PacketId packet, const hal::SensorFrame& frame) {
  std::string out = text(packet, frame.values);
  if (const auto sum = sum_of(packet, frame)) out += fmt::format(" (sum {})", *sum);
  return out;
}

TextStyle style_of(const Label& label, const hal::SensorFrame& frame) {
  if (label.packet == PacketId::oi_mode) return TextStyle::strong;
  return label.alarms && frame.values.raw(label.packet) != 0 ? TextStyle::alarm : TextStyle::plain;
}

// Of those packets that the frame has.
std::vector<const Label*> labels_of(const std::vector<PacketId>& packets,
                                    const oi::SensorValues& values) {
  const std::vector<PacketId> wanted = singles(packets);
  std::vector<const Label*> labels;
  for (const Label& label : kLabels) {
    const bool is_wanted = std::ranges::find(wanted, label.packet) != wanted.end();
    if (is_wanted && values.has(label.packet)) labels.push_back(&label);
  }
  return labels;
}

std::string sides(oi::BitSet<oi::Bump> all,
                  std::initializer_list<std::pair<oi::Bump, const char*>> of) {
  std::string out;
  for (const auto& [bit, name] : of) {
    if (all.has(bit)) out += fmt::format("{}{}", out.empty() ? "" : ", ", name);
  }
  return out.empty() ? "none" : out;
}

// Bumps and wheel drops apart, and short: in the words of the manual they do not fit a line.
std::vector<Cell> cells(const Label& label, const hal::SensorFrame& frame) {
  if (label.packet != PacketId::bumps_and_wheel_drops)
    return {{std::string{label.text}, value(label.packet, frame), style_of(label, frame)}};
  using enum oi::Bump;
  const oi::BitSet<oi::Bump> all = frame.values.bumps_and_wheel_drops();
  const auto cell = [](const char* name, std::string text) {
    const TextStyle style = text == "none" ? TextStyle::plain : TextStyle::alarm;
    return Cell{name, std::move(text), style};
  };
  return {cell("bumps", sides(all, {{bump_left, "left"}, {bump_right, "right"}})),
          cell("wheel drops", sides(all, {{wheel_drop_left, "left"},
                                          {wheel_drop_right, "right"},
                                          {wheel_drop_front, "front"}}))};
}

// What is too long for its line goes on in the next: nothing is cut.
void add_broken(std::vector<ScreenLine>& lines, std::string head, const Cell& cell, int columns) {
  const std::size_t indent = head.size();
  const auto whole = static_cast<std::size_t>(std::max(columns, 0));
  const std::string text = wrapped(cell.text, whole > indent ? whole - indent : 1, 0);
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    lines.push_back(
        {{std::exchange(head, std::string(indent, ' '))}, {text.substr(at, end - at), cell.style}});
    at = end + 1;
  }
}

std::vector<ScreenLine> one_a_line(const std::vector<const Label*>& labels,
                                   const hal::SensorFrame& frame, int columns) {
  std::vector<ScreenLine> lines;
  for (const Label* const label : labels) {
    const oi::PacketInfo& info = oi::kCreate.packet(label->packet);
    const std::vector<Cell> all = cells(*label, frame);
    for (const Cell& cell : all) {
      const std::string name =
          all.size() == 1 ? std::string{info.name} : fmt::format("{}: {}", info.name, cell.label);
      add_broken(lines, fmt::format("{:>3}  {:<40}", info.id, name), cell, columns);
    }
  }
  return lines;
}

// Values keep their places while they change: a cell has the room of the longest that is usual.
int room(const Cell& cell) {
  constexpr int kStep = 15;
  return (cell.width() + 2 + kStep - 1) / kStep * kStep;
}

std::vector<ScreenLine> several_a_line(const std::vector<const Label*>& labels,
                                       const hal::SensorFrame& frame, int columns) {
  std::vector<ScreenLine> lines;
  int column = columns;  // full: the first cell begins a line
  for (const Label* const label : labels) {
    for (const Cell& cell : cells(*label, frame)) {
      if (cell.width() > columns) {
        add_broken(lines, cell.label + " ", cell, columns);
        column = columns;
        continue;
      }
      if (column + cell.width() > columns) {
        lines.emplace_back();
        column = 0;
      }
      lines.back().push_back({cell.label + " "});
      lines.back().push_back({cell.text, cell.style});
      const int gap = room(cell) - cell.width();
      lines.back().push_back({std::string(static_cast<std::size_t>(gap), ' ')});
      column += room(cell);
    }
  }
  return lines;
}

}  // namespace

std::vector<ScreenLine> sensor_lines(const std::vector<PacketId>& packets,
                                     const hal::SensorFrame& frame, int columns) {
  return several_a_line(labels_of(packets, frame.values), frame, columns);
}

std::vector<ScreenLine> sensor_view(const SensorPicture& picture,
                                    const std::vector<PacketId>& packets,
                                    const WindowSize& window) {
  constexpr int kFullColumns = 80;
  const std::vector<const Label*> labels = labels_of(packets, picture.frame.values);
  const int room = window.rows - 2;  // without the first line and the last
  std::vector<ScreenLine> lines = one_a_line(labels, picture.frame, window.columns);
  if (window.columns < kFullColumns || static_cast<int>(lines.size()) > room)
    lines = several_a_line(labels, picture.frame, window.columns);
  std::string last = "Ctrl-C ends it";
  if (const int lost = static_cast<int>(lines.size()) - room; lost > 0) {
    lines.resize(static_cast<std::size_t>(std::max(room, 0)));
    last += fmt::format("; {} lines more in a larger window, or with fewer --packets", lost);
  }
  const std::string first =
      fmt::format("sensors  {:.1f} s, frame {}  {}", picture.time_s, picture.frames, picture.where);
  lines.insert(lines.begin(), ScreenLine{{fitted(first, window.columns), TextStyle::title}});
  lines.resize(static_cast<std::size_t>(std::max(window.rows - 1, 1)));
  lines.push_back({{last}});
  return lines;
}

}  // namespace cargobay::cli
