// Where the server listens, and under which names it can be reached there.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "hal/result.hpp"

namespace cargobay::web {

struct ListenAddress {
  std::string host = "127.0.0.1";  // a numeric address, IPv6 without brackets
  std::uint16_t port = 8080;       // 0: any that is free
};

// `PORT`, `ADDRESS:PORT`, `[IPV6]:PORT` or `localhost:PORT`; a port alone is on the loopback.
// A failure says what is wrong with it. Any thread.
hal::Result<ListenAddress> parse_listen_address(std::string_view text);

// Whether only this machine can reach it. False for what is not a numeric address.
bool is_loopback(std::string_view host);
// 0.0.0.0 or ::
bool is_any(std::string_view host);
// Numeric, IPv6 without brackets.
bool is_numeric(std::string_view host);

// `host`, in brackets if it is IPv6, with the port.
std::string authority(std::string_view host, std::uint16_t port);

// What a link to a server at `address` has as its host: the address, or, if it is that of all
// networks, the first address of this machine that is not the loopback's.
std::string link_host(const ListenAddress& address);

// What this machine is called: its host name, and that with `.local`, as mDNS has it; in lower
// case.
std::vector<std::string> names_of_this_machine();

}  // namespace cargobay::web
