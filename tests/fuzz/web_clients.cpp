// Any bytes from those who connect to cargobay-web: headers, links, messages of both kinds of
// WebSocket in any parts, and lines of a feed. Nothing reaches the feed but whole lines, and nobody
// gets in without the token.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "hal/feed/message/reading.hpp"
#include "hal/web/conversation.hpp"
#include "hal/web/foxglove/foxglove_conversation.hpp"
#include "hal/web/gate.hpp"
#include "hal/web/site.hpp"
#include "hal/web/token.hpp"

namespace {

using namespace cargobay::web;  // NOLINT(google-build-using-namespace): the subject of this program

constexpr std::string_view kToken = "0123456789abcdef";

void require(bool condition) {
  if (!condition) std::abort();
}

// The next part of the input: up to a byte that nothing else uses.
std::string_view part(std::string_view& input) {
  const std::size_t end = input.find('\xff');
  const std::string_view first = input.substr(0, end);
  input.remove_prefix(end == std::string_view::npos ? input.size() : end + 1);
  return first;
}

void ask_site(std::string_view input) {
  const Gate gate{{.address = {.host = "10.0.0.1", .port = 8080}, .token = std::string{kToken}}};
  const Site site{gate, [] { return NewestState{.json = "{\"secret\":1}"}; }};
  const bool has_token = input.find(kToken) != std::string_view::npos;
  const Request request{.path = part(input),
                        .token = part(input),
                        .host = part(input),
                        .origin = part(input),
                        .cookies = part(input),
                        .authorization = part(input)};
  const Reply reply = site.get(request);
  require(reply.status >= 200 && reply.status < 504);
  // Who does not say the token does not get in, and is not told it.
  if (!has_token) {
    require(reply.body.find("secret") == std::string::npos);
    require(reply.body.find(kToken) == std::string::npos);
    for (const auto& [name, value] : reply.headers)
      require(value.find(kToken) == std::string::npos);
    require(site.upgrade(request).status != 101);
    require(site.log_in(input).status == 401);
  }
  (void)parse_listen_address(input);
}

void require_lines(const std::string& lines) {
  require(lines.empty() || lines.back() == '\n');
  for (const char c : lines) require(c == '\n' || static_cast<unsigned char>(c) >= ' ');
}

void converse(Conversation& conversation, std::string_view input) {
  MessageAssembly message;
  while (!input.empty()) {
    const auto kind = static_cast<unsigned char>(input.front());
    input.remove_prefix(1);
    const std::string_view bytes = part(input);
    if (kind % 4 == 3) {
      conversation.tell(bytes, 1'700'000'000'000'000'000);
      continue;
    }
    if (!message.add(bytes, kind % 2 == 0)) return;
    const auto whole = message.take();
    if (whole && conversation.hear(*whole, kind % 4 == 2)) return;
    require_lines(conversation.to_feed());
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view input{reinterpret_cast<const char*>(data), size};
  ask_site(input);
  FeedConversation feed;
  converse(feed, input);
  FoxgloveConversation foxglove;
  converse(foxglove, input);
  // Like a client that has advertised and subscribed to everything.
  FoxgloveConversation prepared;
  std::string subscriptions;
  for (const Channel& channel : channels()) {
    const std::string number = std::to_string(static_cast<int>(channel.id));
    subscriptions += subscriptions.empty() ? R"({"id":)" : R"(,{"id":)";
    ((subscriptions += number) += R"(,"channelId":)") += number;
    subscriptions += '}';
  }
  (void)prepared.hear(R"({"op":"subscribe","subscriptions":[)" + subscriptions + "]}", false);
  (void)prepared.hear(
      R"({"op":"advertise","channels":[{"id":1,"topic":"/cmd_vel","encoding":"json"}]})", false);
  converse(prepared, input);
  (void)cargobay::hal::read_message(input);
  return 0;
}
