#include "hal/cli/jitter/jitter_plot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "hal/cli/drawing/svg_page.hpp"
#include "hal/cli/drawing/xml_text.hpp"

namespace cargobay::cli {
namespace {

constexpr double kPageWidth = 1000.0;
constexpr double kPageLeft = 84.0;
constexpr double kPageRight = 190.0;  // for the labels
constexpr double kPageTop = 28.0;     // from the heading to the first panel
constexpr double kCurveHeight = 380.0;
constexpr double kHistogramHeight = 240.0;
constexpr double kPageGap = 76.0;
constexpr double kPageBottom = 58.0;
constexpr double kFromUs = 0.1;

// A colour for each channel, the same in every drawing; they differ to the colour-blind as well.
struct ChannelColor {
  std::string_view channel;
  const char* color;
};
constexpr std::array<ChannelColor, 6> kColors{{{"robot", "#4d4d4d"},
                                               {"loop", "#0072b2"},
                                               {"echo", "#d55e00"},
                                               {"again", "#009e73"},
                                               {"pipe", "#cc79a7"},
                                               {"sleep", "#b8860b"}}};
static_assert(kColors.size() == hal::jitter::kChannelNames.size());

const char* color_of(std::string_view channel) {
  const auto* const found = std::ranges::find(kColors, channel, &ChannelColor::channel);
  return found == kColors.end() ? "#000000" : found->color;
}

// A dash for each file.
constexpr std::array<const char*, 16> kDashes{"none",     "7 3",         "2 3",         "10 3 2 3",
                                              "14 4",     "1 5",         "7 3 2 3 2 3", "5 7",
                                              "12 3 5 3", "3 3 3 9",     "20 3 2 3",    "2 3 2 10",
                                              "16 3 6 3", "9 3 1 3 1 3", "4 2 1 2",     "24 6"};

struct ChannelCurve {
  const ChannelSummary* channel;
  const char* color;
  const char* dash;
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

  std::string svg(const Heading& heading, const std::vector<JitterSummary>& runs) {
    top_ = heading_height(heading, kPageWidth) + kPageTop;
    const double height = top_ + kCurveHeight + kPageGap + kHistogramHeight + kPageBottom;
    draw_curves();
    draw_histograms();
    write_legend(runs);
    return svg_page(kPageWidth, height, kPageLeft, heading, out_);
  }

 private:
  // x of a share above: 0 at the left end, for the median, and one step for each further nine.
  double nines_x(double share_above) const {
    const double nines = std::clamp(-std::log10(share_above), 0.0, nines_);
    return kPageLeft + nines / nines_ * (kPageWidth - kPageLeft - kPageRight);
  }
  double latency_y(double ns) const {
    const double part = (log10_us(ns) - scale_.low) / (scale_.high - scale_.low);
    return top_ + (1.0 - part) * kCurveHeight;
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
        top_ - 6);
    for (const double decade : decades(scale_.low, scale_.high, 1)) {
      const double y = latency_y(std::pow(10.0, decade) * 1e3);
      rule(kPageLeft, y, kPageWidth - kPageRight, y);
      put(R"(<text x="{}" y="{:.1f}" text-anchor="end">{}</text>)", kPageLeft - 8, y + 4,
          in_words(decade));
    }
    for (const double nines : decades(0.0, nines_, 1)) {
      const double x = nines_x(std::pow(10.0, -nines));
      rule(x, top_, x, top_ + kCurveHeight);
      put(R"(<text x="{:.1f}" y="{:.1f}" text-anchor="middle">{:g} %</text>)", x,
          top_ + kCurveHeight + 18, 100.0 * (1.0 - std::pow(10.0, -nines)));
    }
    const double median = nines_x(0.5);
    put(R"(<text x="{:.1f}" y="{:.1f}" text-anchor="middle">50 %</text>)", median,
        top_ + kCurveHeight + 18);
    for (const ChannelCurve& curve : curves_) draw_curve(curve);
    put(R"(<text x="{:.1f}" y="{:.1f}" text-anchor="middle">share of the frames</text>)",
        (kPageLeft + kPageWidth - kPageRight) / 2, top_ + kCurveHeight + 38);
  }
  void draw_curve(const ChannelCurve& curve) {
    const auto total = static_cast<double>(curve.channel->figures.count);
    std::string points;
    double seen = 0.0;
    for (const auto& [value, count] : curve.channel->buckets) {
      const double y = latency_y(static_cast<double>(value));
      fmt::format_to(std::back_inserter(points), "{:.1f},{:.1f} ",
                     nines_x(std::max(1.0 - seen / total, 1e-12)), y);
      seen += static_cast<double>(count);
      fmt::format_to(std::back_inserter(points), "{:.1f},{:.1f} ",
                     nines_x(std::max(1.0 - seen / total, 1.0 / total)), y);
    }
    line(curve, points);
  }

  void draw_histograms() {
    const double top = top_ + kCurveHeight + kPageGap;
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
    for (const ChannelCurve& curve : curves_) draw_histogram(curve, top, bottom, kDecades);
    put(R"(<text x="{:.1f}" y="{:.1f}" text-anchor="middle">latency, twenty steps to each power of ten</text>)",
        (kPageLeft + kPageWidth - kPageRight) / 2, bottom + 38);
  }
  // Steps without frames are gaps: a line down to the bottom and up again would say more of them
  // than of the frames.
  void draw_histogram(const ChannelCurve& curve, double top, double bottom, double decades) {
    const std::vector<double> shares = shares_of(*curve.channel);
    const auto x_at = [&](std::size_t step) {
      return kPageLeft + static_cast<double>(step) / static_cast<double>(shares.size()) *
                             (kPageWidth - kPageLeft - kPageRight);
    };
    std::string points;
    for (std::size_t step = 0; step < shares.size(); ++step) {
      if (shares[step] == 0.0) {
        line(curve, points);
        points.clear();
        continue;
      }
      const double y = top + std::min(-std::log10(shares[step]) / decades, 1.0) * (bottom - top);
      fmt::format_to(std::back_inserter(points), "{:.1f},{:.1f} {:.1f},{:.1f} ", x_at(step), y,
                     x_at(step + 1), y);
    }
    line(curve, points);
  }
  // Of the frames, twenty to each power of ten.
  std::vector<double> shares_of(const ChannelSummary& channel) const {
    constexpr double kSteps = 20.0;
    const auto steps = static_cast<std::size_t>(std::lround((scale_.high - scale_.low) * kSteps));
    std::vector<double> shares(steps);
    for (const auto& [value, count] : channel.buckets) {
      const double place = (log10_us(static_cast<double>(value)) - scale_.low) * kSteps;
      const auto step =
          static_cast<std::size_t>(std::clamp(place, 0.0, static_cast<double>(steps - 1)));
      shares[step] += static_cast<double>(count) / static_cast<double>(channel.figures.count);
    }
    return shares;
  }

  // Beside the curves: which colour is which channel and, of several files, which dash is which.
  void write_legend(const std::vector<JitterSummary>& runs) {
    double y = top_ + 10.0;
    const auto entry = [&](const char* color, const char* dash, const std::string& text) {
      put(R"(<line x1="{:.1f}" x2="{:.1f}" y1="{:.1f}" y2="{:.1f}" stroke="{}" stroke-width="2" stroke-dasharray="{}"/>)",
          kPageWidth - kPageRight + 8, kPageWidth - kPageRight + 44, y, y, color, dash);
      put(R"(<text x="{:.1f}" y="{:.1f}" fill="{}">{}</text>)", kPageWidth - kPageRight + 50, y + 4,
          color, xml_text(text));
      y += 17.0;
    };
    for (const ChannelColor& each : kColors) {
      const bool drawn = std::ranges::any_of(curves_, [&each](const ChannelCurve& curve) {
        return curve.channel->name == each.channel;
      });
      if (drawn) entry(each.color, "none", std::string{each.channel});
    }
    if (runs.size() < 2) return;
    y += 10.0;
    for (std::size_t i = 0; i < runs.size(); ++i)
      entry("#222", kDashes[i % kDashes.size()], shortened(runs[i].label));
  }
  // The end of a name says more than its folders.
  static std::string shortened(const std::string& name) {
    constexpr std::size_t kMost = 19;
    std::size_t from = name.size() <= kMost ? 0 : name.size() - kMost + 2;
    while (from < name.size() && (static_cast<unsigned char>(name[from]) & 0xc0U) == 0x80U) ++from;
    return from == 0 ? name : ".." + name.substr(from);
  }

  void rule(double x1, double y1, double x2, double y2) {
    put(R"(<line x1="{:.1f}" x2="{:.1f}" y1="{:.1f}" y2="{:.1f}" stroke="#e3e3e3"/>)", x1, x2, y1,
        y2);
  }
  void line(const ChannelCurve& curve, const std::string& points) {
    if (points.empty()) return;
    put(R"(<polyline fill="none" stroke="{}" stroke-width="1.8" stroke-dasharray="{}" points="{}"/>)",
        curve.color, curve.dash, points);
  }
  template <typename... Arguments>
  void put(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    fmt::format_to(std::back_inserter(out_), format, std::forward<Arguments>(arguments)...);
    out_ += '\n';
  }

  const std::vector<ChannelCurve>& curves_;
  Scale scale_;
  double top_ = 0.0;  // of the first panel
  double nines_ = 1.0;
  std::string out_;
};

}  // namespace

std::string jitter_plot(const std::vector<JitterSummary>& runs, const std::string& title) {
  std::vector<ChannelCurve> curves;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    for (const ChannelSummary& channel : runs[i].channels) {
      if (channel.figures.count == 0) continue;
      curves.push_back({&channel, color_of(channel.name), kDashes[i % kDashes.size()]});
    }
  }
  const hal::jitter::Conditions& now = runs.front().conditions;
  const std::string conditions = fmt::format(
      "{}{}, Linux {}, preemption {}, {}", runs.size() > 1 ? "The first: " : "", now.processor,
      now.kernel, now.preemption, runs.front().fifo ? "SCHED_FIFO" : "no real-time rights");
  return Drawing{curves}.svg({.title = title, .subtitle = conditions}, runs);
}

}  // namespace cargobay::cli
