// The other end of a feed: reads what a driving process publishes, and asks it things.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "hal/file/descriptor.hpp"
#include "hal/result.hpp"
#include "rt/clock.hpp"

namespace cargobay::hal {

// One thread. Allocates.
class FeedReader {
 public:
  // Attaches to the feed of the port, whichever of its names is used here or there, to the socket
  // at that path, or, if it is empty, to the only feed there is. A failure names the feeds there
  // are; its code is no_such_device if nothing publishes that port. Under another name than the
  // driving process has, the feeds are asked: blocks for up to a second for each that hangs.
  static Result<FeedReader> attach(const std::string& port);

  // The next message, a line without its end; nothing if none has come by the deadline. Blocks
  // until then. A failure means that the feed has ended.
  Result<std::optional<std::string>> next(rt::TimePoint deadline);
  // Sends one request, a line without its end. Blocks for up to a second.
  Result<void> ask(std::string_view request);

  // To be polled for input; next() may have whole lines already: call it until it has nothing.
  int descriptor() const { return socket_.number(); }
  const std::string& path() const { return path_; }  // of the socket

 private:
  FeedReader(std::string path, Descriptor socket)
      : path_{std::move(path)}, socket_{std::move(socket)} {}
  static Result<FeedReader> attach_to(const std::string& socket_path);
  static bool publishes(const std::string& socket_path, const std::string& port);
  Failure ended() const;

  std::string path_;
  Descriptor socket_;
  std::string received_{};
  std::size_t begin_ = 0;  // of what next() has not returned yet
};

}  // namespace cargobay::hal
