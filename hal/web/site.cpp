#include "hal/web/site.hpp"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "hal/web/page_files.hpp"

namespace cargobay::web {
namespace {

constexpr std::string_view kLogInPage = R"(<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>Cargobay: token</title>
<meta name="viewport" content="width=device-width, initial-scale=1">
<script src="/login.js" defer></script></head>
<body><main><h1>Cargobay</h1>
<p id="message">This robot asks for a token. It is in the link that the server printed.</p>
<form method="post" action="/login"><label>Token
<input name="token" type="password" autocomplete="off" required></label>
<button>Log in</button></form></main></body></html>
)";

// The token of a link's fragment, which no browser sends by itself.
constexpr std::string_view kLogInScript = R"(const token = new URLSearchParams(
  location.hash.slice(1)).get("token");
if (token) {
  history.replaceState(null, "", location.pathname);
  fetch("/login", { method: "POST", body: "token=" + encodeURIComponent(token) }).then((reply) => {
    if (reply.ok) location.replace("/");
    else document.getElementById("message").textContent = "The token of this link is not valid.";
  });
}
)";

constexpr std::string_view kNoStore = "no-store";

Reply api_error(unsigned status, std::string_view text) {
  const nlohmann::json body{{"error", text}};
  return {.status = status,
          .type = "application/json",
          .body = body.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace) + "\n",
          .headers = {{"Cache-Control", std::string{kNoStore}}}};
}

Reply log_in_page(unsigned status) {
  return {.status = status,
          .type = "text/html; charset=utf-8",
          .body = std::string{kLogInPage},
          .headers = {{"Cache-Control", std::string{kNoStore}}}};
}

bool is_api(const Request& request) {
  return request.is_websocket || request.path.starts_with("/api/") || request.path == "/foxglove";
}

}  // namespace

Reply error_reply(unsigned status, std::string_view text) {
  return {.status = status,
          .body = std::string{text} + "\n",
          .headers = {{"Cache-Control", std::string{kNoStore}}}};
}

Reply Site::refusal(const Request& request, Verdict verdict) const {
  if (verdict == Verdict::wrong_host)
    return error_reply(403, "this server does not have that name; use its address, or --name");
  if (verdict == Verdict::wrong_origin)
    return error_reply(403, "pages of other servers may not come in; see --origin");
  if (is_api(request)) return api_error(401, "a token is required");
  return log_in_page(401);
}

Reply Site::state() const {
  NewestState newest = state_();
  if (newest.json.empty()) return api_error(503, newest.reason);
  return {.type = "application/json",
          .body = std::move(newest.json) + "\n",
          .headers = {{"Cache-Control", std::string{kNoStore}}}};
}

Reply Site::get(const Request& request) const {
  const Verdict verdict = gate_.check(request);
  if (verdict != Verdict::welcome) return refusal(request, verdict);
  if (request.path == "/login.js")
    return {.type = "text/javascript; charset=utf-8", .body = std::string{kLogInScript}};
  if (request.path == "/login") return log_in_page(200);
  // The token leaves the address, and with it the history.
  if (request.path == "/" && !request.token.empty()) return log_in(request.token);
  if (request.path == "/api/state") return state();
  if (is_api(request)) return error_reply(426, "this is a WebSocket");
  const auto files = page_files();
  const auto file = std::ranges::find(files, request.path, &PageFile::path);
  if (file == files.end()) return error_reply(404, "there is no such page");
  return {.type = std::string{file->type},
          .body = std::string{file->bytes},
          .headers = {{"Cache-Control", "no-cache"}}};
}

std::optional<Reply> Site::refused_post(const Request& request) const {
  const Verdict verdict = gate_.check(request);
  if (verdict != Verdict::welcome) return refusal(request, verdict);
  if (request.path != "/login") return error_reply(405, "nothing is posted here");
  return std::nullopt;
}

Reply Site::log_in(std::string_view body) const {
  constexpr std::string_view kField = "token=";
  if (body.starts_with(kField)) body.remove_prefix(kField.size());
  if (!gate_.knows(body)) return log_in_page(401);
  Reply reply{.status = 303, .headers = {{"Location", "/"}}};
  reply.headers.emplace_back("Cache-Control", kNoStore);
  if (!gate_.policy().token.empty())
    reply.headers.emplace_back("Set-Cookie", gate_.cookie_header());
  return reply;
}

Reply Site::upgrade(const Request& request) const {
  const Verdict verdict = gate_.check(request);
  if (verdict != Verdict::welcome) return refusal(request, verdict);
  if (request.path != "/api/feed" && request.path != "/foxglove")
    return error_reply(404, "there is no such WebSocket");
  return {.status = 101};
}

}  // namespace cargobay::web
