#include "hal/cli/drive/velocity_plot.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <iterator>
#include <limits>

#include <fmt/format.h>

#include "hal/cli/drawing/svg_page.hpp"

namespace cargobay::cli {
namespace {

constexpr double kWidth = 1000.0;
constexpr double kPanelHeight = 300.0;
constexpr double kIntervalHeight = 120.0;
constexpr double kLeft = 70.0;
constexpr double kRight = 150.0;  // for the labels
constexpr double kTop = 26.0;     // from the heading to the first panel
constexpr double kGap = 44.0;
constexpr double kBottom = 48.0;

struct Curve {
  std::string label;
  std::string color;
  std::string style;
  std::function<double(const DriveSample&)> value;
};

struct Range {
  double low = std::numeric_limits<double>::max();
  double high = std::numeric_limits<double>::lowest();
  void include(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
};

// 1, 2 or 5 times a power of ten, such that about `count` steps fill the range.
double nice_step(double range, int count) {
  const double rough = range / count;
  const double magnitude = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (rough <= factor * magnitude) return factor * magnitude;
  }
  return 10.0 * magnitude;
}

// The multiples of `step` from `low` to `high`.
std::vector<double> marks(double low, double high, double step) {
  std::vector<double> all;
  const long last = std::lround(std::floor(high / step + 1e-9));
  for (long i = std::lround(std::ceil(low / step - 1e-9)); i <= last; ++i) {
    all.push_back(static_cast<double>(i) * step);
  }
  return all;
}

enum class TimeAxis : std::uint8_t { labelled, unlabelled };

class Panel {
 public:
  // `time_s`: of the axis.
  Panel(double top, double height, Range time_s, Range range)
      : top_{top}, height_{height}, time_s_{time_s}, range_{range} {}

  void frame(const std::string& heading, TimeAxis time_axis) {
    const double step = nice_step(range_.high - range_.low, height_ < kPanelHeight ? 3 : 5);
    for (const double v : marks(range_.low, range_.high, step)) {
      put(R"(<line x1="{:.1f}" x2="{:.1f}" y1="{:.1f}" y2="{:.1f}" stroke="#e3e3e3"/>)", kLeft,
          kWidth - kRight, y(v), y(v));
      put(R"(<text x="{:.1f}" y="{:.1f}" text-anchor="end">{:g}</text>)", kLeft - 8, y(v) + 4, v);
    }
    const double time_step = nice_step(time_s_.high - time_s_.low, 10);
    for (const double t : marks(time_s_.low, time_s_.high, time_step)) {
      put(R"(<line x1="{:.1f}" x2="{:.1f}" y1="{:.1f}" y2="{:.1f}" stroke="#e3e3e3"/>)", x(t), x(t),
          top_, top_ + height_);
      if (time_axis == TimeAxis::labelled)
        put(R"(<text x="{:.1f}" y="{:.1f}" text-anchor="middle">{:g}</text>)", x(t),
            top_ + height_ + 18, t);
    }
    put(R"(<rect x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{:.1f}" fill="none" stroke="#888"/>)",
        kLeft, top_, kWidth - kLeft - kRight, height_);
    put(R"(<text x="{:.1f}" y="{:.1f}" font-weight="bold">{}</text>)", kLeft, top_ - 8, heading);
    if (time_axis == TimeAxis::labelled) {
      put(R"(<text x="{:.1f}" y="{:.1f}" text-anchor="middle">seconds of robot time</text>)",
          (kLeft + kWidth - kRight) / 2, top_ + height_ + 38);
    }
  }

  void draw(const Curve& curve, const std::vector<DriveSample>& samples) {
    std::string points;
    for (const DriveSample& sample : samples) {
      fmt::format_to(std::back_inserter(points), "{:.1f},{:.1f} ", x(sample.time_s),
                     y(curve.value(sample)));
    }
    put(R"(<polyline fill="none" stroke="{}" {} points="{}"/>)", curve.color, curve.style, points);
    labels_.push_back({y(curve.value(samples.back())), curve.label, curve.color});
  }

  // At the right end of its curve, moved just enough that no two labels overlap.
  void write_labels() {
    constexpr double kLine = 17.0;
    std::sort(labels_.begin(), labels_.end(),
              [](const Label& a, const Label& b) { return a.y < b.y; });
    double lowest = top_ + 10;
    for (Label& label : labels_) {
      label.y = std::max(label.y, lowest);
      lowest = label.y + kLine;
    }
    double highest = top_ + height_ - 4;
    std::reverse(labels_.begin(), labels_.end());
    for (Label& label : labels_) {
      label.y = std::min(label.y, highest);
      highest = label.y - kLine;
      put(R"(<text x="{:.1f}" y="{:.1f}" fill="{}" font-weight="bold">{}</text>)",
          kWidth - kRight + 8, label.y + 4, label.color, label.text);
    }
  }

  const std::string& svg() const { return svg_; }

 private:
  struct Label {
    double y = 0.0;
    std::string text;
    std::string color;
  };
  double x(double time_s) const {
    return kLeft +
           (time_s - time_s_.low) / (time_s_.high - time_s_.low) * (kWidth - kLeft - kRight);
  }
  double y(double value) const {
    return top_ + (range_.high - value) / (range_.high - range_.low) * height_;
  }
  template <typename... Arguments>
  void put(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    fmt::format_to(std::back_inserter(svg_), format, std::forward<Arguments>(arguments)...);
    svg_ += '\n';
  }

  std::string svg_;
  double top_;
  double height_;
  Range time_s_;
  Range range_;
  std::vector<Label> labels_;
};

std::vector<Curve> curves(double rt::WheelSpeeds::* wheel, bool has_truth) {
  std::vector<Curve> all;
  all.push_back({"command", "#9a9a9a", R"(stroke-width="1")",
                 [wheel](const DriveSample& s) { return s.command.*wheel; }});
  if (has_truth) {
    all.push_back({"true speed", "#1a7f37", R"(stroke-width="2.4")",
                   [wheel](const DriveSample& s) { return s.truth.value_or(s.estimate).*wheel; }});
  }
  all.push_back({"estimate", "#0a58ca", R"(stroke-width="1.2")",
                 [wheel](const DriveSample& s) { return s.estimate.*wheel; }});
  all.push_back({"set speed", "#c1121f", R"(stroke-width="1.4" stroke-dasharray="7 4")",
                 [wheel](const DriveSample& s) { return s.set.*wheel; }});
  return all;
}

// From the beginning of the drive, unless the samples begin well after it.
Range times(const std::vector<DriveSample>& samples) {
  const double first_s = samples.front().time_s;
  const double low_s = first_s < 1.0 ? 0.0 : first_s;
  return {low_s, std::max(samples.back().time_s, low_s + 0.1)};
}

// Of both wheels: what looks higher is faster, on whichever side.
Range speeds(const std::vector<DriveSample>& samples) {
  Range range;
  range.include(0.0);
  for (const auto wheel : {&rt::WheelSpeeds::left_mm_s, &rt::WheelSpeeds::right_mm_s}) {
    for (const Curve& curve : curves(wheel, samples.back().truth.has_value())) {
      for (const DriveSample& sample : samples) range.include(curve.value(sample));
    }
  }
  const double margin = std::max(0.05 * (range.high - range.low), 5.0);
  return {range.low - margin, range.high + margin};
}

std::string wheel_panel(const std::string& name, double rt::WheelSpeeds::* wheel,
                        const std::vector<DriveSample>& samples, double top, TimeAxis time_axis) {
  Panel panel{top, kPanelHeight, times(samples), speeds(samples)};
  panel.frame(name + " wheel, mm/s", time_axis);
  for (const Curve& curve : curves(wheel, samples.back().truth.has_value()))
    panel.draw(curve, samples);
  panel.write_labels();
  return panel.svg();
}

std::string interval_panel(const std::vector<DriveSample>& samples, double top) {
  Range range;
  range.include(0.0);
  range.include(30.0);  // two ticks
  for (const DriveSample& sample : samples) range.include(1.05 * sample.interval_ms);
  const Curve curve{"interval", "#8250df", R"(stroke-width="1.2")",
                    [](const DriveSample& s) { return s.interval_ms; }};
  Panel panel{top, kIntervalHeight, times(samples), range};
  panel.frame("Between two frames, ms", TimeAxis::labelled);
  panel.draw(curve, samples);
  panel.write_labels();
  return panel.svg();
}

}  // namespace

std::string velocity_plot(const std::vector<DriveSample>& samples, const std::string& title,
                          Intervals intervals) {
  const bool third = intervals == Intervals::drawn;
  const Heading heading{.title = title};
  const double top = heading_height(heading, kWidth) + kTop;
  const double right_top = top + kPanelHeight + kGap;
  const double third_top = right_top + kPanelHeight + kGap;
  const double height = (third ? third_top + kIntervalHeight : right_top + kPanelHeight) + kBottom;
  std::string svg;
  if (!samples.empty()) {
    svg += wheel_panel("Left", &rt::WheelSpeeds::left_mm_s, samples, top, TimeAxis::unlabelled);
    svg += wheel_panel("Right", &rt::WheelSpeeds::right_mm_s, samples, right_top,
                       third ? TimeAxis::unlabelled : TimeAxis::labelled);
    if (third) svg += interval_panel(samples, third_top);
  }
  return svg_page(kWidth, height, kLeft, heading, svg);
}

}  // namespace cargobay::cli
