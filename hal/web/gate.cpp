#include "hal/web/gate.hpp"

#include <algorithm>
#include <cctype>
#include <optional>

#include "hal/web/token.hpp"

namespace cargobay::web {
namespace {

std::string lower(std::string_view text) {
  std::string result{text};
  std::ranges::transform(result, result.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return result;
}

bool is_port(std::string_view text) {
  return !text.empty() && text.size() <= 5 &&
         std::ranges::all_of(text, [](unsigned char c) { return c >= '0' && c <= '9'; });
}

}  // namespace

std::string host_of(std::string_view header) {
  std::string_view host = header;
  std::string_view rest;
  if (host.starts_with('[')) {
    const std::size_t end = host.find(']');
    if (end == std::string_view::npos) return {};
    rest = host.substr(end + 1);
    host = host.substr(1, end - 1);
    if (host.find(':') == std::string_view::npos || !is_numeric(host)) return {};
  } else {
    const std::size_t colon = host.find(':');
    if (colon != std::string_view::npos) rest = host.substr(colon);
    host = host.substr(0, colon);
  }
  if (!rest.empty() && (rest.front() != ':' || !is_port(rest.substr(1)))) return {};
  return lower(host);
}

bool is_public(std::string_view path) { return path == "/login" || path == "/login.js"; }

Verdict Gate::check(const Request& request) const {
  if (!is_served(request.host)) return Verdict::wrong_host;
  // Browsers send it with each WebSocket and POST; other programs need not.
  if (!request.origin.empty() && !is_own(request.origin, request.host))
    return Verdict::wrong_origin;
  if (!is_public(request.path) && !has_token(request)) return Verdict::no_token;
  return Verdict::welcome;
}

// An address cannot be made to lead elsewhere, a name can. The port may be another one: that of a
// tunnel which ends here.
bool Gate::is_served(std::string_view header) const {
  const std::string host = host_of(header);
  if (host.empty()) return false;
  if (is_loopback(host) || host == "localhost") return true;
  if (std::ranges::find(policy_.names, host) != policy_.names.end()) return true;
  return !is_loopback(policy_.address.host) && is_numeric(host);
}

bool Gate::is_own(std::string_view origin, std::string_view host) const {
  const std::string own = (policy_.is_encrypted ? "https://" : "http://") + lower(host);
  const std::string given = lower(origin);
  return given == own || std::ranges::find(policy_.origins, given) != policy_.origins.end();
}

bool Gate::knows(std::string_view token) const {
  return policy_.token.empty() || is_same_token(token, policy_.token);
}

bool Gate::has_token(const Request& request) const {
  if (policy_.token.empty()) return true;
  const auto matches = [this](std::optional<std::string_view> token) {
    return token && is_same_token(*token, policy_.token);
  };
  return matches(cookie(request.cookies, cookie_name())) ||
         matches(bearer(request.authorization)) ||
         (!request.token.empty() && matches(request.token));
}

std::string Gate::cookie_name() const { return "cargobay_" + std::to_string(policy_.address.port); }

std::string Gate::cookie_header() const {
  return cookie_name() + "=" + policy_.token + "; Path=/; HttpOnly; SameSite=Strict" +
         (policy_.is_encrypted ? "; Secure" : "");
}

}  // namespace cargobay::web
