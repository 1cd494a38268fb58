// The page of a virtual Create that other programs drive.
#pragma once

#include <memory>
#include <string>

#include "hal/cli/serve/web_side.hpp"
#include "hal/feed/feed.hpp"
#include "hal/result.hpp"
#include "hal/sim/line/server.hpp"
#include "hal/sim/world/world.hpp"

namespace cargobay::cli {

class SimView {
 public:
  // A feed of what the virtual Create knows, and the web side that shows it; `http` is where, or
  // empty. Robot and world (null for none) outlive this. Blocks until it serves, 10 s at most.
  static hal::Result<SimView> open(hal::sim::Server& robot, const hal::sim::World* world,
                                   const std::string& port, const std::string& http);

  // "serving URL".
  const std::string& ready_line() const { return web_->ready_line(); }

 private:
  SimView(std::unique_ptr<hal::Feed> feed, std::unique_ptr<WebSide> web)
      : feed_{std::move(feed)}, web_{std::move(web)} {}

  std::unique_ptr<hal::Feed> feed_;
  std::unique_ptr<WebSide> web_;  // ends first
};

}  // namespace cargobay::cli
