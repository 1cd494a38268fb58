#include "hal/cli/drive/last_frames.hpp"

#include <iterator>

#include <fmt/format.h>

#include "oi/value_names.hpp"

namespace cargobay::cli {
namespace {

std::string row(const hal::Exchange& exchange, double before_end_ms) {
  std::string out = fmt::format("{:>8.1f} ", -before_end_ms);
  const auto to_out = std::back_inserter(out);
  if (exchange.state.has_value()) {
    const hal::CycleState& state = *exchange.state;
    fmt::format_to(to_out, "{:>7}  {:<8}{:>5.0f}{:>5.0f}{:>8.1f}{:>7.1f}{:>6.0f}{:>5.0f}  ",
                   state.tick, oi::name(state.mode), state.target.left_mm_s,
                   state.target.right_mm_s, state.estimate.left_mm_s, state.estimate.right_mm_s,
                   state.command.left_mm_s, state.command.right_mm_s);
  } else {
    fmt::format_to(
        to_out, "{:>7}  {:<44}  ", "",
        exchange.wait == hal::ByteStream::Wait::hung_up ? "the port hung up" : "no whole frame");
  }
  fmt::format_to(to_out, "{:02x}\n", fmt::join(exchange.read, " "));
  return out;
}

bool silent(const hal::Exchange& exchange) {
  return exchange.wait != hal::ByteStream::Wait::hung_up && exchange.read.empty();
}

}  // namespace

std::string last_frames_table(std::span<const hal::Exchange> exchanges) {
  if (exchanges.empty()) return "";
  std::string out =
      fmt::format("The last frames before it ended\n{:>8} {:>7}  {:<8}{:>10}{:>15}{:>11}  {}\n",
                  "ms", "tick", "mode", "target", "estimate", "command", "from the robot");
  const rt::TimePoint end = exchanges.back().time;
  std::size_t waits = 0;
  const auto flush = [&] {
    if (waits > 0) {
      fmt::format_to(std::back_inserter(out), "{:>16}  {} wait{} in which nothing arrived\n", "",
                     waits, waits == 1 ? "" : "s");
    }
    waits = 0;
  };
  for (const hal::Exchange& exchange : exchanges) {
    if (silent(exchange)) {
      ++waits;
      continue;
    }
    flush();
    out += row(exchange, 1e3 * rt::seconds(end - exchange.time));
  }
  flush();
  return out;
}

}  // namespace cargobay::cli
