#include "hal/cli/serve/sim_view.hpp"

#include <string_view>
#include <utility>

#include "hal/cli/terminal/print.hpp"
#include "hal/feed/feed_place.hpp"
#include "hal/sim/remote/control_socket.hpp"
#include "oi/dialect.hpp"

namespace cargobay::cli {

hal::Result<SimView> SimView::open(hal::sim::Server& robot, const hal::sim::World* world,
                                   const std::string& port, const std::string& http) {
  hal::FeedOptions options{.of = {.program = "cargobay sim",
                                  .port = port,
                                  .is_virtual = true,
                                  .baud = oi::kCreate.default_baud,
                                  .wheel_base_mm = oi::kCreate.wheel_base_mm},
                           // The port's own name is for the feed of whoever drives it. Hidden:
                           // who names no port wants a robot that is driven.
                           .name = "." + hal::feed_name(port) + "-sim",
                           .create = &robot,
                           .world = world};
  options.steering.control = [&robot](std::string_view line) {
    return hal::sim::control(line, robot);
  };
  auto feed = hal::Feed::open(std::move(options));
  if (!feed) return feed.failure();
  (*feed)->report("simulator", "no loop runs here; another program may drive this robot");
  if (!WebSide::is_installed()) return hal::Failure{.message = WebSide::kMissing};
  auto web = WebSide::start({.socket = (*feed)->socket(), .http = http},
                            [](const std::string& what) { print_remark(what); });
  if (!web) return web.failure();
  return SimView{std::move(*feed), std::move(*web)};
}

}  // namespace cargobay::cli
