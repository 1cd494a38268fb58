// The drawings of the command: what they show, and what they become as a file.
#include <cstdlib>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hal/cli/drawing/picture.hpp"
#include "hal/cli/drawing/svg_page.hpp"
#include "hal/cli/drive/velocity_plot.hpp"
#include "hal/cli/jitter/jitter_plot.hpp"

namespace cargobay::cli {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
    ++found;
  return found;
}

TEST(SvgPage, WrapsAtSpacesAndCutsLongWords) {
  EXPECT_THAT(wrapped("one two three", 7), ElementsAre("one two", "three"));
  EXPECT_THAT(wrapped("abcdefghij kl", 4), ElementsAre("abcd", "efgh", "ij", "kl"));
  EXPECT_THAT(wrapped("", 4), ElementsAre());
  EXPECT_THAT(wrapped("ab\u00e4\u00e4", 3), ElementsAre("ab", "\u00e4", "\u00e4"));
}

TEST(SvgPage, MakesRoomForItsTitleOnABackgroundOfItsOwn) {
  const Heading title{.title = std::string(300, 'x') + " <&>"};
  EXPECT_GT(heading_height(title, 1000.0), heading_height({.title = "short"}, 1000.0) + 30.0);
  const std::string page = svg_page(1000.0, 100.0, 70.0, title, "");
  EXPECT_THAT(page, HasSubstr(R"(<rect width="1000" height="100" fill="white"/>)"));
  EXPECT_GE(count(page, "<text "), 3U);
  EXPECT_THAT(page, HasSubstr("&lt;&amp;&gt;"));
}

ChannelSummary channel(const std::string& name,
                       std::vector<std::pair<std::uint64_t, std::uint64_t>> buckets) {
  ChannelSummary made{.name = name, .headline = "written", .buckets = std::move(buckets)};
  for (const auto& [value, frames] : made.buckets) made.figures.count += frames;
  made.figures.min = made.buckets.front().first;
  made.figures.max = made.buckets.back().first;
  return made;
}

// The colours of the curves, each with its dash: "#0072b2 none".
std::vector<std::string> strokes(const std::string& svg) {
  std::vector<std::string> all;
  for (std::size_t at = svg.find("<polyline"); at != std::string::npos;
       at = svg.find("<polyline", at + 1)) {
    const auto value = [&](const std::string& name) {
      const std::size_t from = svg.find(name + "=\"", at) + name.size() + 2;
      return svg.substr(from, svg.find('"', from) - from);
    };
    all.push_back(value("stroke") + " " + value("stroke-dasharray"));
  }
  return all;
}

// loop of one file and echo of the other once had one colour and one dash.
TEST(JitterPlot, HasAColourForEachChannelAndADashForEachFile) {
  const JitterSummary one{.label = "one.json",
                          .channels = {channel("loop", {{20'000, 9}, {21'000, 9}}),
                                       channel("echo", {{20'000, 9}, {21'000, 9}})}};
  JitterSummary other = one;
  other.label = "other.json";
  std::swap(other.channels[0], other.channels[1]);
  const std::vector<std::string> drawn = strokes(jitter_plot({one, other}, "title"));
  ASSERT_EQ(drawn.size(), 8U) << "four curves, four histograms";
  EXPECT_THAT(std::vector<std::string>(drawn.begin(), drawn.begin() + 4),
              ElementsAre("#0072b2 none", "#d55e00 none", "#d55e00 7 3", "#0072b2 7 3"));
  const std::string svg = jitter_plot({one, other}, "title");
  for (const char* named : {">loop<", ">echo<", ">one.json<", ">other.json<"})
    EXPECT_EQ(count(svg, named), 1U) << named;
}

TEST(JitterPlot, HasAsManyDashesAsFilesThatMayBeCompared) {
  std::vector<JitterSummary> runs(16);
  for (JitterSummary& run : runs) run.channels = {channel("echo", {{20'000, 9}})};
  std::vector<std::string> drawn = strokes(jitter_plot(runs, "title"));
  std::ranges::sort(drawn);
  drawn.erase(std::unique(drawn.begin(), drawn.end()), drawn.end());
  EXPECT_EQ(drawn.size(), 16U);
}

// Three values far apart are three lines, and no line goes down to the axis between them.
TEST(JitterPlot, LeavesGapsInHistograms) {
  const JitterSummary run{
      .channels = {channel("echo", {{10'000, 90}, {100'000, 9}, {900'000, 1}})}};
  EXPECT_EQ(strokes(jitter_plot({run}, "title")).size(), 4U) << "one curve, three steps";
}

// Both wheels are drawn on the scale of the faster one.
TEST(VelocityPlot, HasOneScaleForBothWheels) {
  std::vector<DriveSample> samples(2);
  samples[1].time_s = 1.0;
  samples[1].set = samples[1].estimate =
      samples[1].command = {.left_mm_s = 400.0, .right_mm_s = 40.0};
  const std::string svg = velocity_plot(samples, "title");
  EXPECT_EQ(count(svg, ">400</text>"), 2U);
  EXPECT_EQ(count(svg, ">40</text>"), 0U);
}

TEST(Picture, IsNamedByItsKind) {
  for (const char* good : {"", "-", "x.svg", "x", "/dev/null", "v1.2", ".png/x", "x.json"})
    EXPECT_TRUE(check_picture_name("--plot", good)) << good;
  for (const char* bad : {"x.jpg", "x.JPEG", "a.b/x.pdf", "x.webp", "x.svgz"}) {
    const auto checked = check_picture_name("--plot", bad);
    ASSERT_FALSE(checked) << bad;
    EXPECT_THAT(checked.failure().message, HasSubstr("draws SVG and PNG"));
  }
}

TEST(Picture, IsAPngIfItsNameSaysSo) {
  ASSERT_TRUE(check_picture_name("--plot", "x.png")) << "it is in .ci/packages.sh quick";
  const std::string svg = svg_page(300.0, 200.0, 10.0, {.title = "title"}, "");
  const auto png = picture(svg, "x.PNG");
  ASSERT_TRUE(png) << png.failure().message;
  EXPECT_THAT(*png, StartsWith("\x89PNG\r\n\x1a\n"));
  EXPECT_EQ(*picture(svg, "x.svg"), svg);
  const auto broken = picture("<svg", "x.png");
  ASSERT_FALSE(broken) << "what cannot be drawn is said";
  EXPECT_THAT(broken.failure().message, HasSubstr("could not make x.png"));
  // More than pipes hold, in both directions.
  const std::string large = svg_page(2000.0, 2000.0, 10.0, {}, std::string(2'000'000, ' '));
  EXPECT_TRUE(picture(large, "x.png"));
}

// NOLINTBEGIN(concurrency-mt-unsafe): one thread
TEST(Picture, IsRefusedAsPngWithoutItsConverter) {
  const std::string path = std::getenv("PATH");
  ASSERT_EQ(setenv("PATH", "/nowhere", 1), 0);
  const auto checked = check_picture_name("--plot", "x.png");
  const auto made = picture("<svg/>", "x.png");
  ASSERT_EQ(setenv("PATH", path.c_str(), 1), 0);
  ASSERT_FALSE(checked);
  EXPECT_THAT(checked.failure().message, HasSubstr("librsvg2-bin"));
  EXPECT_THAT(checked.failure().message, Not(HasSubstr("\n")));
  EXPECT_FALSE(made);
}
// NOLINTEND(concurrency-mt-unsafe)

}  // namespace
}  // namespace cargobay::cli
