#include "hal/cli/jitter/jitter_plot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "hal/cli/terminal/xml_text.hpp"

namespace cargobay::cli {
namespace {

constexpr double kPageWidth = 1000.0;
constexpr double kPageLeft = 84.0;
constexpr double kPageRight = 190.0;  // for the labels
constexpr double kPageTop = 72.0;
constexpr double kCurveHeight = 380.0;
constexpr double kHistogramHeight = 240.0;
constexpr double kPageGap = 76.0;
constexpr double kPageBottom = 58.0;
constexpr double kFromUs = 0.1;

// Colours and dashes that differ in print and to the colour-blind.
struct Style {
  const char* color;
  const char* dash;
};
constexpr std::array<Style, 6> kStyles{{{"#0072b2", ""},
                                        {"#d55e00", ""},
                                        {"#009e73", "7 3"},
                                        {"#cc79a7", "2 3"},
                                        {"#56b4e9", "9 3 2 3"},
                                        {"#4d4d4d", "5 2"}}};

struct ChannelCurve {
  std::string label;
  const ChannelSummary* channel;
  Style style;
};

double log10_us(double ns) { return std::log10(std::max(ns / 1e3, kFromUs)); }

struct Scale {
  double low = 0.0;  // decades of microseconds
  double high = 3.0;
};
Scale scale_of(const std::vector<ChannelCurve>& curves) {
  double low = 9.0;
  double high = -9.0;
  for (const ChannelCurve& curve : curves) {
    low = std::min(low, log10_us(static_cast<double>(curve.channel->figures.min)));
    high = std::max(high, log10_us(static_cast<double>(curve.channel->figures.max)));
  }
  return {std::floor(low), std::max(std::ceil(high), std::floor(low) + 1.0)};
}

// Whole numbers, every `step`-th.
std::vector<double> decades(double low, double high, int step) {
  std::vector<double> all;
  for (int i = static_cast<int>(low); i <= static_cast<int>(high); i += step) all.push_back(i);
  return all;
}

std::string in_words(double decade) {
  const double us = std::pow(10.0, decade);
  return us < 1000.0 ? fmt::format("{:g} us", us) : fmt::format("{:g} ms", us / 1e3);
}

class Drawing {
 public:
  explicit Drawing(const std::vector<ChannelCurve>& curves)
      : curves_{curves}, scale_{scale_of(curves)} {}

  std::string svg(const std::string& title, const std::string& subtitle) {
    const double height = kPageTop + kCurveHeight + kPageGap + kHistogramHeight + kPageBottom;
    out_ = fmt::format(
        R"(<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {0} {1}" width="{0}" height="{1}" font-family="sans-serif" font-size="13" fill="#222">)"
        "\n"
        R"(<rect width="{0}" height="{1}" fill="white"/>)"
        "\n",
        kPageWidth, height);
    put(R"(<text x="{}" y="22" font-size="15">{}</text>)", kPageLeft, xml_text(title));
    put(R"(<text x="{}" y="40" fill="#555">{}</text>)", kPageLeft, xml_text(subtitle));
    draw_curves();
    draw_histograms();
    return out_ + "</svg>\n";
  }

 private:
  struct Label {
    double y = 0.0;
    const ChannelCurve* curve = nullptr;
  };

  // x of a share above: 0 at the left end, for the median, and one step for each further nine.
  double nines_x(double share_above) const {
    const double nines = std::clamp(-std::log10(share_above), 0.0, nines_);
    return kPageLeft + nines / nines_ * (kPageWidth - kPageLeft - kPageRight);
  }
  double latency_y(double ns) const {
    const double part = (log10_us(ns) - scale_.low) / (scale_.high - scale_.low);
    return kPageTop + (1.0 - part) * kCurveHeight;
  }
  double latency_x(double ns) const {
    const double part = (log10_us(ns) - scale_.low) / (scale_.high - scale_.low);
    return kPageLeft + part * (kPageWidth - kPageLeft - kPageRight);
  }

  void draw_curves() {
    std::uint64_t most = 10;
    for (const ChannelCurve& curve : curves_) most = std::max(most, curve.channel->figures.count);
    nines_ = std::ceil(std::log10(static_cast<double>(most)));
    put(R"(<text x="{}" y="{}" font-weight="bold">Latency percentiles</text>)", kPageLeft,
        kPageTop - 6);
    for (const double decade : decades(scale_.low, scale_.high, 1)) {
      const double y = latency_y(std::pow(10.0, decade) * 1e3);
      rule(kPageLeft, y, kPageWidth - kPageRight, y);
      put(R"(<text x="{}" y="{:.1f}" text-anchor="end">{}</text>)", kPageLeft - 8, y + 4,
          in_words(decade));
    }
    for (const double nines : decades(0.0, nines_, 1)) {
      const double x = nines_x(std::pow(10.0, -nines));
      rule(x, kPageTop, x, kPageTop + kCurveHeight);
      put(R"(<text x="{:.1f}" y="{:.1f}" text-anchor="middle">{:g} %</text>)", x,
          kPageTop + kCurveHeight + 18, 100.0 * (1.0 - std::pow(10.0, -nines)));
    }
    const double median = nines_x(0.5);
    put(R"(<text x="{:.1f}" y="{:.1f}" text-anchor="middle">50 %</text>)", median,
        kPageTop + kCurveHeight + 18);
    std::vector<Label> labels;
    labels.reserve(curves_.size());
    for (const ChannelCurve& curve : curves_) labels.push_back({draw_curve(curve), &curve});
    write_labels(labels, kPageTop, kCurveHeight);
    put(R"(<text x="{:.1f}" y="{:.1f}" text-anchor="middle">share of the frames</text>)",
        (kPageLeft + kPageWidth - kPageRight) / 2, kPageTop + kCurveHeight + 38);
  }
  // Returns the end of the curve.
  double draw_curve(const ChannelCurve& curve) {
    const auto total = static_cast<double>(curve.channel->figures.count);
    std::string points;
    double seen = 0.0;
    double y = kPageTop + kCurveHeight;
    for (const auto& [value, count] : curve.channel->buckets) {
      y = latency_y(static_cast<double>(value));
      fmt::format_to(std::back_inserter(points), "{:.1f},{:.1f} ",
                     nines_x(std::max(1.0 - seen / total, 1e-12)), y);
      seen += static_cast<double>(count);
      fmt::format_to(std::back_inserter(points), "{:.1f},{:.1f} ",
                     nines_x(std::max(1.0 - seen / total, 1.0 / total)), y);
    }
    line(curve, points);
    return y;
  }

  void draw_histograms() {
    const double top = kPageTop + kCurveHeight + kPageGap;
    const double bottom = top + kHistogramHeight;
    put(R"(<text x="{}" y="{}" font-weight="bold">Frames at each latency, share of all</text>)",
        kPageLeft, top - 6);
    constexpr double kDecades = 6.0;  // of shares
    for (const double decade : decades(0.0, kDecades, 2)) {
      const double y = top + decade / kDecades * kHistogramHeight;
      rule(kPageLeft, y, kPageWidth - kPageRight, y);
      put(R"(<text x="{}" y="{:.1f}" text-anchor="end">{:g} %</text>)", kPageLeft - 8, y + 4,
          100.0 * std::pow(10.0, -decade));
    }
    for (const double decade : decades(scale_.low, scale_.high, 1)) {
      const double x = latency_x(std::pow(10.0, decade) * 1e3);
      rule(x, top, x, bottom);
      put(R"(<text x="{:.1f}" y="{:.1f}" text-anchor="middle">{}</text>)", x, bottom + 18,
          in_words(decade));
    }
    std::vector<Label> labels;
    labels.reserve(curves_.size());
    for (const ChannelCurve& curve : curves_)
      labels.push_back({draw_histogram(curve, top, bottom, kDecades), &curve});
    write_labels(labels, top, kHistogramHeight);
    put(R"(<text x="{:.1f}" y="{:.1f}" text-anchor="middle">latency, twenty steps to each power of ten</text>)",
        (kPageLeft + kPageWidth - kPageRight) / 2, bottom + 38);
  }
  double draw_histogram(const ChannelCurve& curve, double top, double bottom, double decades) {
    constexpr double kSteps = 20.0;
    const auto steps = static_cast<std::size_t>((scale_.high - scale_.low) * kSteps) + 1;
    std::vector<double> shares(steps);
    for (const auto& [value, count] : curve.channel->buckets) {
      const double place = (log10_us(static_cast<double>(value)) - scale_.low) * kSteps;
      const auto step =
          static_cast<std::size_t>(std::clamp(place, 0.0, static_cast<double>(steps - 1)));
      shares[step] +=
          static_cast<double>(count) / static_cast<double>(curve.channel->figures.count);
    }
    std::string points;
    double last_y = bottom;
    for (std::size_t step = 0; step < steps; ++step) {
      const double y =
          shares[step] == 0.0
              ? bottom
              : top + std::min(-std::log10(shares[step]) / decades, 1.0) * (bottom - top);
      const auto x_at = [&](double at) {
        return kPageLeft +
               at / static_cast<double>(steps - 1) * (kPageWidth - kPageLeft - kPageRight);
      };
      fmt::format_to(std::back_inserter(points), "{:.1f},{:.1f} {:.1f},{:.1f} ",
                     x_at(static_cast<double>(step)), y,
                     std::min(x_at(static_cast<double>(step) + 1.0), kPageWidth - kPageRight), y);
      if (shares[step] > 0.0) last_y = y;
    }
    line(curve, points);
    return last_y;
  }

  // At the right, as close to the end of its curve as the other labels allow, with no leader line.
  void write_labels(std::vector<Label>& labels, double top, double height) {
    constexpr double kLine = 17.0;
    std::ranges::sort(labels, {}, &Label::y);
    double lowest = top + 10.0;
    for (Label& label : labels) {
      label.y = std::max(label.y, lowest);
      lowest = label.y + kLine;
    }
    double highest = top + height - 2.0;
    std::ranges::reverse(labels);
    for (Label& label : labels) {
      label.y = std::min(label.y, highest);
      highest = label.y - kLine;
      const Style& style = label.curve->style;
      put(R"(<line x1="{:.1f}" x2="{:.1f}" y1="{:.1f}" y2="{:.1f}" stroke="{}" stroke-width="2" stroke-dasharray="{}"/>)",
          kPageWidth - kPageRight + 8, kPageWidth - kPageRight + 34, label.y, label.y, style.color,
          style.dash);
      put(R"(<text x="{:.1f}" y="{:.1f}" fill="{}" font-weight="bold">{}</text>)",
          kPageWidth - kPageRight + 40, label.y + 4, style.color, xml_text(label.curve->label));
    }
  }

  void rule(double x1, double y1, double x2, double y2) {
    put(R"(<line x1="{:.1f}" x2="{:.1f}" y1="{:.1f}" y2="{:.1f}" stroke="#e3e3e3"/>)", x1, x2, y1,
        y2);
  }
  void line(const ChannelCurve& curve, const std::string& points) {
    put(R"(<polyline fill="none" stroke="{}" stroke-width="1.8" stroke-dasharray="{}" points="{}"/>)",
        curve.style.color, curve.style.dash, points);
  }
  template <typename... Arguments>
  void put(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    fmt::format_to(std::back_inserter(out_), format, std::forward<Arguments>(arguments)...);
    out_ += '\n';
  }

  const std::vector<ChannelCurve>& curves_;
  Scale scale_;
  double nines_ = 1.0;
  std::string out_;
};

}  // namespace

std::string jitter_plot(const std::vector<JitterSummary>& runs, const std::string& title) {
  std::vector<ChannelCurve> curves;
  for (const JitterSummary& run : runs) {
    for (const ChannelSummary& channel : run.channels) {
      if (channel.figures.count == 0) continue;
      const std::string label = runs.size() > 1 ? channel.name + " " + run.label : channel.name;
      curves.push_back({label, &channel, kStyles[curves.size() % kStyles.size()]});
    }
  }
  const hal::jitter::Conditions& now = runs.front().conditions;
  const std::string subtitle =
      fmt::format("{}, Linux {}, preemption {}, {}", now.processor, now.kernel, now.preemption,
                  runs.front().fifo ? "SCHED_FIFO" : "no real-time rights");
  return Drawing{curves}.svg(title, subtitle);
}

}  // namespace cargobay::cli
