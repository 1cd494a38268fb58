// The program `cargobay-web` beside `cargobay serve`: a process of its own, which reads the feed as
// any other client does. Its death or hang is nothing to the loop: it is started again.
#pragma once

#include <sys/types.h>

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "hal/file/descriptor.hpp"
#include "hal/result.hpp"

namespace cargobay::cli {

struct WebOptions {
  std::string socket{};                // of the feed
  std::string http{};                  // where to listen; empty: as the program does by itself
  std::string token{};                 // empty: as the program does by itself
  std::string token_file{};            // where it is kept; empty: nowhere
  std::string certificate{};           // empty: none
  std::vector<std::string> names{};    // under which it is reached, beside its addresses
  std::vector<std::string> origins{};  // pages of other servers that may connect
};

class WebSide {
 public:
  // Whether the program is there: beside this one.
  static bool is_installed();
  static constexpr const char* kMissing =
      "cargobay-web is not installed: no page and no HTTP; sudo apt install cargobay-web";

  // Starts it and waits until it serves: 10 s at most. Returns the line that it is ready with,
  // "serving URL". A failure says why; nothing runs then. `tell` gets a line each time that it had
  // to be started again, at the same address, on a thread of its own.
  static hal::Result<std::unique_ptr<WebSide>> start(const WebOptions& options,
                                                     std::function<void(const std::string&)> tell);
  // Ends it: after 2 s by force.
  ~WebSide();
  WebSide(const WebSide&) = delete;
  WebSide& operator=(const WebSide&) = delete;

  const std::string& ready_line() const { return ready_line_; }

 private:
  WebSide() = default;
  hal::Result<void> spawn();
  void keep_address();
  void watch();

  std::vector<std::string> arguments_{};
  std::string token_{};
  std::string ready_line_{};
  std::function<void(const std::string&)> tell_{};
  pid_t process_ = -1;       // the watcher's, while there is one; -1: none runs
  hal::Descriptor ready_{};  // on which it says that it is ready; open as long as it runs
  std::atomic<bool> stopping_{false};
  std::thread watcher_{};
};

}  // namespace cargobay::cli
