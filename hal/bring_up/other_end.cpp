#include "hal/bring_up/other_end.hpp"

#include <chrono>
#include <string>

#include "hal/bring_up/bring_up_failure.hpp"
#include "hal/bring_up/dialogue.hpp"
#include "hal/port/port_users.hpp"
#include "hal/trouble.hpp"
#include "oi/commands.hpp"

namespace cargobay::hal {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kBetween{60};

}  // namespace

Failure name_other_end(ByteStream& stream, const Failure& silent,
                       const std::function<bool()>& cancelled) {
  if (silent.code != Trouble::silent) return silent;
  Dialogue talk{stream, cancelled};
  for (int i = 0; i < 2; ++i) {  // one question is too short to be known again
    talk.send(oi::Sensors{oi::PacketId::wall});
    (void)talk.pause(kBetween);
  }
  (void)talk.pause(kTimeOfALine);
  Failure named = silent;
  const std::string sender =
      what_sends({.heard = {{.baud = stream.baud(), .heard = talk.heard()}}});
  if (!sender.empty()) named.message = sender;
  if (const std::string others = others_at(stream.terminal().descriptor); !others.empty())
    named.message += ". " + others;
  return named;
}

}  // namespace cargobay::hal
