#include "hal/bring_up/other_end.hpp"

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "hal/bring_up/bring_up_failure.hpp"
#include "hal/bring_up/dialogue.hpp"
#include "hal/bring_up/rate_probe.hpp"
#include "hal/port/port_users.hpp"
#include "hal/trouble.hpp"
#include "oi/commands.hpp"
#include "oi/dialect.hpp"

namespace cargobay::hal {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kBetween{60};
constexpr milliseconds kBetweenLooks{50};

bool is_known(const Heard& heard) { return heard.is_robots_text() || heard.is_strangers_text(); }
bool is_text_or_echo(const Heard& heard) {
  return is_known(heard) || heard.is_text() || heard.is_echo();
}

// What is heard at the stream's present rate.
Heard listen(ByteStream& stream, Dialogue& talk) {
  talk.forget();
  for (int i = 0; i < 2; ++i) {  // one question is too short to be known again
    talk.send(oi::Sensors{oi::PacketId::wall});
    (void)talk.pause(kBetween);
  }
  const rt::TimePoint limit = stream.now() + kTimeOfALine;
  while (stream.now() < limit && !is_known(talk.heard()) && !talk.heard().is_gibberish() &&
         talk.pause(kBetweenLooks)) {
  }
  return talk.heard();
}

// Text at another rate arrives as bytes that are none.
std::vector<HeardAt> listen_at_each_rate(ByteStream& stream, Dialogue& talk) {
  const std::uint32_t present = stream.baud();
  std::vector<HeardAt> heard{{.baud = present, .heard = listen(stream, talk)}};
  if (heard.front().heard.bytes == 0 || is_text_or_echo(heard.front().heard)) return heard;
  std::vector<std::uint32_t> rates{kRatesOfOthers.begin(), kRatesOfOthers.end()};
  rates.insert(rates.end(), {oi::kCreate.default_baud, oi::kCreate.brc_baud});
  for (const std::uint32_t baud : rates) {
    if (talk.over() || is_text_or_echo(heard.back().heard)) break;
    if (baud == present || stream.set_baud(baud)) continue;
    stream.discard_input();
    heard.push_back({.baud = baud, .heard = listen(stream, talk)});
  }
  (void)stream.set_baud(present);  // it was at this rate
  return heard;
}

}  // namespace

Failure name_other_end(ByteStream& stream, const Failure& silent,
                       const std::function<bool()>& cancelled) {
  if (silent.code != Trouble::silent) return silent;
  Dialogue talk{stream, cancelled};
  Failure named = silent;
  const std::string sender = what_sends({.heard = listen_at_each_rate(stream, talk)});
  if (!sender.empty()) named.message = sender;
  if (const std::string others = others_at(stream.terminal().descriptor); !others.empty())
    named.message += ". " + others;
  return named;
}

}  // namespace cargobay::hal
