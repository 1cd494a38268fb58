#include "hal/web/gate.hpp"

#include <string>

#include <gtest/gtest.h>

namespace {

namespace web = cargobay::web;
using web::Gate;
using web::Request;
using web::Verdict;

const std::string kGateToken = "0123456789abcdef";

Gate on_loopback() { return Gate{{.address = {.host = "127.0.0.1", .port = 8080}}}; }
Gate beyond() {
  return Gate{{.address = {.host = "0.0.0.0", .port = 8080},
               .token = kGateToken,
               .names = {"robot.local"},
               .origins = {"https://app.foxglove.dev"}}};
}

TEST(Gate, KnowsItselfByTheLoopbacksNamesAlone) {
  const Gate gate = on_loopback();
  for (const char* const host : {"127.0.0.1:8080", "localhost:8080", "LocalHost:9000", "[::1]:8080",
                                 "127.0.0.1", "localhost", "127.1.2.3:1"})
    EXPECT_EQ(gate.check({.path = "/", .host = host}), Verdict::welcome) << host;
  for (const char* const host :
       {"", "evil.example:8080", "localhost.evil.example", "127.0.0.1.evil.example", "192.168.0.7",
        "localhost:", "localhost:99999999", "localhost:8080:1", "[::1", "[::1]x", "[localhost]",
        "localhost,evil.example", "robot.local", " localhost", "localhost/", "0.0.0.0:8080",
        "user@localhost"})
    EXPECT_EQ(gate.check({.path = "/", .host = host}), Verdict::wrong_host) << host;
}

TEST(Gate, KnowsItselfByAddressesAndItsNamesBeyondTheLoopback) {
  const Gate gate = beyond();
  for (const char* const host :
       {"192.168.0.7:8080", "[fe80::1]:8080", "robot.local:8080", "ROBOT.local", "localhost:8080"})
    EXPECT_EQ(gate.check({.path = "/", .token = kGateToken, .host = host}), Verdict::welcome)
        << host;
  for (const char* const host : {"evil.example", "robot.local.evil.example", "xrobot.local"})
    EXPECT_EQ(gate.check({.path = "/", .token = kGateToken, .host = host}), Verdict::wrong_host)
        << host;
}

TEST(Gate, RefusesPagesOfOtherServers) {
  const Gate gate = on_loopback();
  const auto verdict = [&](const char* origin) {
    return gate.check(
        {.is_websocket = true, .path = "/api/feed", .host = "localhost:8080", .origin = origin});
  };
  EXPECT_EQ(verdict(""), Verdict::welcome);  // no browser
  EXPECT_EQ(verdict("http://localhost:8080"), Verdict::welcome);
  EXPECT_EQ(verdict("http://LOCALHOST:8080"), Verdict::welcome);
  for (const char* const origin :
       {"http://localhost:3000", "http://localhost", "https://localhost:8080", "null", "file://",
        "http://127.0.0.1:8080", "http://evil.example", "http://localhost:8080.evil.example",
        "http://localhost:8080/", "https://app.foxglove.dev"})
    EXPECT_EQ(verdict(origin), Verdict::wrong_origin) << origin;
}

TEST(Gate, LetsNamedOriginsIn) {
  const Gate gate = beyond();
  EXPECT_EQ(gate.check({.path = "/foxglove",
                        .token = kGateToken,
                        .host = "192.168.0.7:8080",
                        .origin = "https://app.foxglove.dev"}),
            Verdict::welcome);
  // With the token all the same.
  EXPECT_EQ(
      gate.check(
          {.path = "/foxglove", .host = "192.168.0.7:8080", .origin = "https://app.foxglove.dev"}),
      Verdict::no_token);
}

TEST(Gate, WantsHttpsOfAnOriginIfItIsEncrypted) {
  const Gate gate{{.address = {.host = "127.0.0.1", .port = 8443}, .is_encrypted = true}};
  EXPECT_EQ(gate.check({.host = "localhost:8443", .origin = "https://localhost:8443"}),
            Verdict::welcome);
  EXPECT_EQ(gate.check({.host = "localhost:8443", .origin = "http://localhost:8443"}),
            Verdict::wrong_origin);
}

TEST(Gate, TakesTheTokenFromLinkCookieOrHeader) {
  const Gate gate = beyond();
  const std::string in_cookie = "a=b; cargobay_8080=" + kGateToken + "; c=d";
  const std::string in_header = "Bearer " + kGateToken;
  const Request bare{.path = "/api/state", .host = "192.168.0.7"};
  EXPECT_EQ(gate.check(bare), Verdict::no_token);
  Request request = bare;
  request.token = kGateToken;
  EXPECT_EQ(gate.check(request), Verdict::welcome);
  request = bare;
  request.cookies = in_cookie;
  EXPECT_EQ(gate.check(request), Verdict::welcome);
  request = bare;
  request.authorization = in_header;
  EXPECT_EQ(gate.check(request), Verdict::welcome);
}

TEST(Gate, RefusesEachWrongToken) {
  const Gate gate = beyond();
  for (const std::string& wrong :
       {std::string{}, std::string{"0"}, kGateToken.substr(1), kGateToken + "0",
        "1" + kGateToken.substr(1), kGateToken.substr(0, 15) + "e", kGateToken + kGateToken,
        std::string(16, '\0')}) {
    const std::string in_cookie = "cargobay_8080=" + wrong;
    const std::string other_port = "cargobay_8081=" + kGateToken;
    const std::string in_header = "Bearer " + wrong;
    const std::string other_scheme = "Basic " + kGateToken;
    EXPECT_EQ(gate.check({.path = "/", .token = wrong, .host = "10.0.0.1"}), Verdict::no_token);
    EXPECT_EQ(gate.check({.path = "/", .host = "10.0.0.1", .cookies = in_cookie}),
              Verdict::no_token);
    EXPECT_EQ(gate.check({.path = "/", .host = "10.0.0.1", .cookies = other_port}),
              Verdict::no_token);
    EXPECT_EQ(gate.check({.path = "/", .host = "10.0.0.1", .authorization = in_header}),
              Verdict::no_token);
    EXPECT_EQ(gate.check({.path = "/", .host = "10.0.0.1", .authorization = other_scheme}),
              Verdict::no_token);
    EXPECT_FALSE(gate.knows(wrong));
  }
  EXPECT_TRUE(gate.knows(kGateToken));
}

TEST(Gate, HidesNothingButTheLogIn) {
  const Gate gate = beyond();
  EXPECT_EQ(gate.check({.path = "/login", .host = "10.0.0.1"}), Verdict::welcome);
  EXPECT_EQ(gate.check({.path = "/login.js", .host = "10.0.0.1"}), Verdict::welcome);
  for (const char* const path : {"/", "/main.js", "/api/state", "/api/feed", "/foxglove", "/login/",
                                 "/login.js/../api/state", "/nothing"})
    EXPECT_EQ(gate.check({.path = path, .host = "10.0.0.1"}), Verdict::no_token) << path;
}

TEST(Gate, SetsACookieThatScriptsAndOtherPagesDoNotGet) {
  EXPECT_EQ(beyond().cookie_header(),
            "cargobay_8080=" + kGateToken + "; Path=/; HttpOnly; SameSite=Strict");
  const Gate encrypted{
      {.address = {.host = "10.0.0.1", .port = 8443}, .is_encrypted = true, .token = kGateToken}};
  EXPECT_NE(encrypted.cookie_header().find("; Secure"), std::string::npos);
}

}  // namespace
