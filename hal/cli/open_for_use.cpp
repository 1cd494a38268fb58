#include "hal/cli/open_for_use.hpp"

#include "hal/cli/print.hpp"
#include "hal/open_port.hpp"

namespace cargobay::cli {

hal::Result<std::unique_ptr<hal::ByteStream>> open_for_use(const std::string& path,
                                                           std::uint32_t baud) {
  auto port = hal::open_port(path, baud);
  if (!port) return port.failure();
  if (!port->remark.empty()) print_remark(port->remark);
  return std::move(port->stream);
}

}  // namespace cargobay::cli
