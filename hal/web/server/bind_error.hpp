// Why nothing can listen at an address; libwebsockets does not say.
#pragma once

#include <string>

#include "hal/web/address.hpp"

namespace cargobay::web {

// Tries it; the system's words, or empty if it could be listened on now.
std::string bind_error(const ListenAddress& address);

}  // namespace cargobay::web
