// The services of the Foxglove server: requests to the feed that need nothing but their name.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace cargobay::web {

// `advertiseServices`: JSON. Made once.
const std::string& services_advertisement();

// What the feed is asked for by a service, its `do`.
std::optional<std::string_view> service_request(std::uint64_t service);

}  // namespace cargobay::web
