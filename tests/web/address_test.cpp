#include "hal/web/address.hpp"

#include <string>

#include <gtest/gtest.h>

namespace {

namespace web = cargobay::web;

std::string parsed(const char* text) {
  const auto address = web::parse_listen_address(text);
  return address ? web::authority(address->host, address->port) : "refused";
}

TEST(ListenAddress, IsThatOfTheLoopbackUnlessNamed) {
  EXPECT_EQ(parsed("8080"), "127.0.0.1:8080");
  EXPECT_EQ(parsed("0"), "127.0.0.1:0");
  EXPECT_EQ(parsed("localhost:80"), "127.0.0.1:80");
  EXPECT_EQ(parsed("0.0.0.0:65535"), "0.0.0.0:65535");
  EXPECT_EQ(parsed("[::1]:8080"), "[::1]:8080");
  EXPECT_EQ(parsed("[::]:8080"), "[::]:8080");
}

TEST(ListenAddress, IsRefusedUnlessItIsNumeric) {
  for (const char* const text :
       {"", ":", ":8080", "robot.local:8080", "127.0.0.1", "127.0.0.1:", "127.0.0.1:65536",
        "127.0.0.1:-1", "127.0.0.1:80x", "::1:8080", "[127.0.0.1]:80", "[::1]", "127.1:80", "x"})
    EXPECT_EQ(parsed(text), "refused") << text;
}

TEST(ListenAddress, KnowsTheLoopback) {
  EXPECT_TRUE(web::is_loopback("127.0.0.1"));
  EXPECT_TRUE(web::is_loopback("127.255.0.9"));
  EXPECT_TRUE(web::is_loopback("::1"));
  for (const char* const host :
       {"0.0.0.0", "::", "128.0.0.1", "10.127.0.1", "localhost", "", "::2"})
    EXPECT_FALSE(web::is_loopback(host)) << host;
  EXPECT_TRUE(web::is_any("0.0.0.0"));
  EXPECT_TRUE(web::is_any("::"));
  EXPECT_FALSE(web::is_any("127.0.0.1"));
}

TEST(ListenAddress, OfALinkCanBeReached) {
  EXPECT_EQ(web::link_host({.host = "10.1.2.3", .port = 1}), "10.1.2.3");
  EXPECT_FALSE(web::is_any(web::link_host({.host = "0.0.0.0", .port = 1})));
}

}  // namespace
