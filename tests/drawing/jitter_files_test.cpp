// What `cargobay jitter` writes for the plotters of others, against what those write themselves.
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hal/cli/jitter/jitter_formats.hpp"

namespace cargobay::cli {
namespace {

using hal::jitter::Measured;
using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

Measured measured(std::vector<float> ns) {
  Measured made{};
  made.slices = {{.headline_ns = std::move(ns)}};
  return made;
}

// The end of what cyclictest 2.4 -t 2 -h 1000 wrote, with our figures.
TEST(Cyclictest, IsWrittenAsItWritesItself) {
  const Measured one = measured({13'999, 20'000, 13'000, 999'999});
  const Measured other = measured({12'000, 15'500});
  const std::string text = cyclictest(std::vector<const Measured*>{&one, &other});
  EXPECT_THAT(text, StartsWith("# Histogram\n000000 000000\t000000\n000001 000000\t000000\n"));
  EXPECT_THAT(text, HasSubstr("\n000012 000000\t000001\n000013 000002\t000000\n"));
  EXPECT_THAT(text, EndsWith("\n000999 000001\t000000\n"
                             "# Total: 000000004 000000002\n"
                             "# Min Latencies: 00013 00012\n"
                             "# Avg Latencies: 00261 00013\n"
                             "# Max Latencies: 00999 00015\n"
                             "# Histogram Overflows: 00000 00000\n"
                             "# Histogram Overflow at cycle number:\n"
                             "# Thread 0:\n"
                             "# Thread 1:\n"
                             "\n"));
}

// Its total leaves them out, its cycles count from 0, and it has a row for each microsecond.
TEST(Cyclictest, NamesTheCyclesThatOverflow) {
  const Measured one = measured({200'000'000, 1'000, 2e9F});
  const std::string text = cyclictest(std::vector<const Measured*>{&one});
  EXPECT_EQ(std::ranges::count(text, '\n'), 1 + 100'000 + 8);
  EXPECT_THAT(text, EndsWith("# Total: 000000001\n"
                             "# Min Latencies: 00001\n"
                             "# Avg Latencies: 733333\n"
                             "# Max Latencies: 2000000\n"
                             "# Histogram Overflows: 00002\n"
                             "# Histogram Overflow at cycle number:\n"
                             "# Thread 0: 00000 00002\n"
                             "\n"));
}

TEST(Cyclictest, HasAsManyRowsAsItNeeds) {
  const Measured one = measured({1'000'000});
  EXPECT_THAT(cyclictest(std::vector<const Measured*>{&one}),
              HasSubstr("\n009999 000000\n# Total"));
  const Measured none = measured({});
  EXPECT_THAT(cyclictest(std::vector<const Measured*>{&none}),
              HasSubstr("\n000999 000000\n# Total: 000000000\n# Min Latencies: 00000\n"));
}

}  // namespace
}  // namespace cargobay::cli
