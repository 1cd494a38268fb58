#include "hal/web/site.hpp"

#include <algorithm>
#include <string>

#include <gtest/gtest.h>

namespace {

namespace web = cargobay::web;
using web::Gate;
using web::Reply;
using web::Request;

const std::string kSiteToken = "0123456789abcdef";

std::string header(const Reply& reply, const std::string& name) {
  const auto found =
      std::ranges::find(reply.headers, name, [](const auto& one) { return one.first; });
  return found == reply.headers.end() ? "" : found->second;
}

class SiteTest : public testing::Test {
 protected:
  static Request request(const char* path) {
    return {.path = path, .host = "10.0.0.1", .authorization = "Bearer 0123456789abcdef"};
  }
  static Request stranger(const char* path) { return {.path = path, .host = "10.0.0.1"}; }

  web::NewestState state_{.json = R"({"type":"state"})"};
  Gate gate_{{.address = {.host = "10.0.0.1", .port = 80}, .token = kSiteToken}};
  web::Site site_{gate_, [this] { return state_; }};
};

TEST_F(SiteTest, ServesThePage) {
  const Reply reply = site_.get(request("/"));
  EXPECT_EQ(reply.status, 200U);
  EXPECT_EQ(reply.type, "text/html; charset=utf-8");
  EXPECT_NE(reply.body.find("</html>"), std::string::npos);
  EXPECT_EQ(site_.get(request("/nothing")).status, 404U);
  EXPECT_EQ(site_.get(request("/../etc/passwd")).status, 404U);
}

TEST_F(SiteTest, TellsTheStateOrWhyThereIsNone) {
  const Reply reply = site_.get(request("/api/state"));
  EXPECT_EQ(reply.status, 200U);
  EXPECT_EQ(reply.type, "application/json");
  EXPECT_EQ(reply.body, "{\"type\":\"state\"}\n");
  EXPECT_EQ(header(reply, "Cache-Control"), "no-store");
  state_ = {.reason = "the \"feed\" has ended"};
  const Reply none = site_.get(request("/api/state"));
  EXPECT_EQ(none.status, 503U);
  EXPECT_EQ(none.body, "{\"error\":\"the \\\"feed\\\" has ended\"}\n");
}

TEST_F(SiteTest, SaysNothingToStrangers) {
  const Reply api = site_.get(stranger("/api/state"));
  EXPECT_EQ(api.status, 401U);
  EXPECT_EQ(api.body.find("state\""), std::string::npos);
  const Reply page = site_.get(stranger("/"));
  EXPECT_EQ(page.status, 401U);
  EXPECT_NE(page.body.find("/login"), std::string::npos);
  // Not even whether there is such a page.
  EXPECT_EQ(site_.get(stranger("/nothing")).body, page.body);
  EXPECT_EQ(site_.upgrade(stranger("/api/feed")).status, 401U);
  EXPECT_EQ(page.body.find(kSiteToken), std::string::npos);
}

TEST_F(SiteTest, TakesTheTokenOutOfALink) {
  Request visitor = stranger("/");
  visitor.token = kSiteToken;
  const Reply reply = site_.get(visitor);
  EXPECT_EQ(reply.status, 303U);
  EXPECT_EQ(header(reply, "Location"), "/");
  EXPECT_EQ(header(reply, "Set-Cookie"), gate_.cookie_header());
  visitor.token = "0123456789abcdeX";
  EXPECT_EQ(site_.get(visitor).status, 401U);
  EXPECT_EQ(header(site_.get(visitor), "Set-Cookie"), "");
}

TEST_F(SiteTest, LogsInByTheTokenAlone) {
  EXPECT_EQ(site_.get(stranger("/login")).status, 200U);
  EXPECT_EQ(site_.get(stranger("/login.js")).type, "text/javascript; charset=utf-8");
  EXPECT_FALSE(site_.refused_post(stranger("/login")));
  const Reply in = site_.log_in("token=" + kSiteToken);
  EXPECT_EQ(in.status, 303U);
  EXPECT_EQ(header(in, "Set-Cookie"), gate_.cookie_header());
  for (const char* const body : {"", "token=", "token=wrong", "nothing"}) {
    const Reply out = site_.log_in(body);
    EXPECT_EQ(out.status, 401U) << body;
    EXPECT_EQ(header(out, "Set-Cookie"), "") << body;
  }
}

TEST_F(SiteTest, TakesNoOtherPosts) {
  EXPECT_EQ(site_.refused_post(request("/api/state"))->status, 405U);
  EXPECT_EQ(site_.refused_post(stranger("/api/state"))->status, 401U);
  Request cross = stranger("/login");
  cross.origin = "http://evil.example";
  EXPECT_EQ(site_.refused_post(cross)->status, 403U);
  Request rebound = stranger("/login");
  rebound.host = "evil.example";
  EXPECT_EQ(site_.refused_post(rebound)->status, 403U);
}

TEST_F(SiteTest, BeginsWebSocketsWhereThereAreAny) {
  EXPECT_EQ(site_.upgrade(request("/api/feed")).status, 101U);
  EXPECT_EQ(site_.upgrade(request("/foxglove")).status, 101U);
  EXPECT_EQ(site_.upgrade(request("/")).status, 404U);
  EXPECT_EQ(site_.get(request("/api/feed")).status, 426U);
}

}  // namespace
