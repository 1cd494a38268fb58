// One reader of a feed: what waits for it, and what it asks. Nothing here blocks.
#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "hal/feed/message/messages.hpp"
#include "hal/file/descriptor.hpp"
#include "hal/file/port_descriptor.hpp"
#include "rt/clock.hpp"

namespace cargobay::hal {

// One message for all readers: a line with its end.
struct FeedMessage {
  FeedType type = FeedType::hello;
  std::shared_ptr<const std::string> line{};
};

// What a reader wants to get.
struct FeedChoice {
  std::bitset<kFeedTypes> types = std::bitset<kFeedTypes>{}.set();
  std::uint32_t every = 1;  // of state, sensors and truth
};

// One thread.
class FeedConnection {
 public:
  static constexpr std::size_t kMostBytes = std::size_t{256} << 10U;  // that wait
  static constexpr std::size_t kLongestLine = 4096;

  FeedConnection(Descriptor socket, std::uint64_t number, rt::TimePoint since)
      : socket_{std::move(socket)},
        for_children_{PortDescriptor::borrow(socket_.number())},
        number_{number},
        since_{since} {}

  int descriptor() const { return socket_.number(); }
  std::uint64_t number() const { return number_; }
  rt::TimePoint since() const { return since_; }
  // What to poll for.
  short events() const;

  void choose(const FeedChoice& choice);
  bool wants(FeedType type) const { return choice_.types.test(static_cast<std::size_t>(type)); }
  // Puts the message behind those that wait, unless this reader has not chosen it. If there is no
  // more room, the oldest make way: readings first, then news, and answers last.
  void put(const FeedMessage& message);
  // So many messages of that type were gone before they could be put: counts those of them that
  // this reader has chosen.
  void lose(FeedType type, std::uint64_t count);
  // What it did not get adds up to.
  std::uint64_t missed() const { return missed_; }

  // Sends what the reader takes. False if it is gone.
  bool flush();
  // Reads what is there and calls `hear` with each whole line, without its end. False if the reader
  // is gone, or sent a line that is too long.
  bool receive(const std::function<void(std::string_view line)>& hear);

 private:
  // How many of the next `count` of that type this reader has chosen; counts them as passed.
  std::uint64_t pass(FeedType type, std::uint64_t count);
  void make_room();
  void tell_missed();
  void sent(std::size_t bytes);

  Descriptor socket_;
  PortDescriptor for_children_;  // closed in a forked child, or the reader would not see our end
  std::uint64_t number_;
  rt::TimePoint since_;
  FeedChoice choice_{};
  // Of each type, those since the last that was chosen, and that one; 0: the next one is chosen.
  std::array<std::uint32_t, kFeedTypes> passed_{};
  std::deque<FeedMessage> waiting_{};
  std::size_t waiting_bytes_ = 0;
  std::size_t sent_of_first_ = 0;  // bytes
  std::uint64_t untold_ = 0;       // missed since the reader was last told
  std::uint64_t missed_ = 0;
  std::string received_{};
};

}  // namespace cargobay::hal
