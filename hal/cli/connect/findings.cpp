#include "hal/cli/connect/findings.hpp"

#include <nlohmann/json.hpp>

namespace cargobay::cli {

std::vector<hal::Finding> examine(const std::string& port, const rt::RealtimeRequest& rights) {
  // Only asking for the rights shows whether they are granted.
  rt::RealtimeThread thread;
  rt::RealtimeGrant grant = thread.start(rights, [] {});
  thread.join();
  return hal::examine({.port = port, .priority = rights.priority, .grant = std::move(grant)});
}

std::string json(const std::vector<hal::Finding>& findings) {
  using nlohmann::json;
  json out = json::array();
  for (const hal::Finding& finding : findings) {
    out.push_back({{"check", finding.check},
                   {"verdict", hal::name(finding.verdict)},
                   {"what", finding.what},
                   {"remedy", finding.remedy}});
  }
  return out.dump();
}

}  // namespace cargobay::cli
