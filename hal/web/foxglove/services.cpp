#include "hal/web/foxglove/services.hpp"

#include <algorithm>
#include <array>

#include <nlohmann/json.hpp>

namespace cargobay::web {
namespace {

using Json = nlohmann::json;

struct Service {
  std::uint64_t id = 0;
  std::string_view name;
  std::string_view request;
};

constexpr auto kServices = std::to_array<Service>({
    {1, "/stop", "stop"},
    {2, "/rearm", "rearm"},
    {3, "/release", "release"},
});

Json definition(std::string_view name, const Json& schema) {
  return {{"encoding", "json"},
          {"schemaName", name},
          {"schemaEncoding", "jsonschema"},
          {"schema", schema.dump()}};
}

std::string made_advertisement_of_services() {
  const Json nothing{{"type", "object"}, {"properties", Json::object()}};
  const Json answer{
      {"type", "object"},
      {"properties", {{"ok", {{"type", "boolean"}}}, {"error", {{"type", "string"}}}}}};
  Json services = Json::array();
  for (const Service& service : kServices) {
    services.push_back({{"id", service.id},
                        {"name", service.name},
                        {"type", "cargobay.Request"},
                        {"request", definition("cargobay.Nothing", nothing)},
                        {"response", definition("cargobay.Answer", answer)}});
  }
  return Json{{"op", "advertiseServices"}, {"services", services}}.dump();
}

}  // namespace

const std::string& services_advertisement() {
  static const std::string kMade = made_advertisement_of_services();
  return kMade;
}

std::optional<std::string_view> service_request(std::uint64_t service) {
  const auto* const found = std::ranges::find(kServices, service, &Service::id);
  if (found == kServices.end()) return std::nullopt;
  return found->request;
}

}  // namespace cargobay::web
