#include "hal/web/address.hpp"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <memory>
#include <optional>

namespace cargobay::web {
namespace {

std::optional<in_addr> ipv4(std::string_view host) {
  in_addr address{};
  if (inet_pton(AF_INET, std::string{host}.c_str(), &address) != 1) return std::nullopt;
  return address;
}

std::optional<in6_addr> ipv6(std::string_view host) {
  in6_addr address{};
  if (inet_pton(AF_INET6, std::string{host}.c_str(), &address) != 1) return std::nullopt;
  return address;
}

std::optional<std::uint16_t> port_of(std::string_view text) {
  std::uint16_t port = 0;
  const char* const begin = text.data();
  const char* const end = begin + text.size();
  const auto [stop, error] = std::from_chars(begin, end, port);
  if (error != std::errc{} || stop != end) return std::nullopt;
  return port;
}

hal::Failure bad(std::string_view text, const std::string& why) {
  return {.message = "--http " + std::string{text} + ": " + why};
}

}  // namespace

hal::Result<ListenAddress> parse_listen_address(std::string_view text) {
  ListenAddress address;
  std::string_view port_text = text;
  if (const std::size_t colon = text.rfind(':'); colon != std::string_view::npos) {
    std::string_view host = text.substr(0, colon);
    port_text = text.substr(colon + 1);
    const bool in_brackets = host.size() > 1 && host.front() == '[' && host.back() == ']';
    if (in_brackets) host = host.substr(1, host.size() - 2);
    if (host == "localhost") host = "127.0.0.1";
    if (in_brackets ? !ipv6(host) : !ipv4(host))
      return bad(text,
                 "its address is not numeric; use 127.0.0.1, [::1], 0.0.0.0 for every "
                 "network, or an address of this machine, then a colon and the port");
    address.host = host;
  }
  const auto port = port_of(port_text);
  if (!port) return bad(text, "the port is a number from 0 to 65535");
  address.port = *port;
  return address;
}

bool is_loopback(std::string_view host) {
  if (const auto address = ipv4(host)) return ntohl(address->s_addr) >> 24U == 127;
  const auto address = ipv6(host);
  return address && IN6_IS_ADDR_LOOPBACK(&*address);
}

bool is_any(std::string_view host) {
  if (const auto address = ipv4(host)) return address->s_addr == htonl(INADDR_ANY);
  const auto address = ipv6(host);
  return address && IN6_IS_ADDR_UNSPECIFIED(&*address);
}

bool is_numeric(std::string_view host) { return ipv4(host) || ipv6(host); }

std::string authority(std::string_view host, std::uint16_t port) {
  const std::string name{host};
  return (ipv6(host) ? "[" + name + "]" : name) + ":" + std::to_string(port);
}

std::string link_host(const ListenAddress& address) {
  if (!is_any(address.host)) return address.host;
  ifaddrs* list = nullptr;
  if (getifaddrs(&list) != 0) return "127.0.0.1";
  const std::unique_ptr<ifaddrs, void (*)(ifaddrs*)> owner{list, freeifaddrs};
  for (const ifaddrs* one = list; one != nullptr; one = one->ifa_next) {
    if (one->ifa_addr == nullptr || one->ifa_addr->sa_family != AF_INET) continue;
    if ((one->ifa_flags & IFF_LOOPBACK) != 0 || (one->ifa_flags & IFF_UP) == 0) continue;
    std::array<char, INET_ADDRSTRLEN> text{};
    const auto* const address4 = reinterpret_cast<const sockaddr_in*>(one->ifa_addr);
    if (inet_ntop(AF_INET, &address4->sin_addr, text.data(), text.size()) != nullptr)
      return text.data();
  }
  return "127.0.0.1";
}

std::vector<std::string> names_of_this_machine() {
  std::array<char, 256> buffer{};
  if (gethostname(buffer.data(), buffer.size() - 1) != 0) return {};
  std::string name{buffer.data()};
  std::ranges::transform(name, name.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  std::vector<std::string> names{name};
  const std::string first = name.substr(0, name.find('.'));
  names.push_back(first + ".local");
  if (first != name) names.push_back(first);
  return names;
}

}  // namespace cargobay::web
