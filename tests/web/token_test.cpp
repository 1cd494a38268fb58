#include "hal/web/token.hpp"

#include <set>
#include <string>

#include <gtest/gtest.h>

namespace {

namespace web = cargobay::web;

TEST(Token, IsMadeOf128RandomBits) {
  std::set<std::string> tokens;
  for (int i = 0; i < 100; ++i) {
    const auto token = web::make_token();
    ASSERT_TRUE(token);
    EXPECT_EQ(token->size(), 32U);
    EXPECT_TRUE(web::is_token(*token));
    tokens.insert(*token);
  }
  EXPECT_EQ(tokens.size(), 100U);
}

TEST(Token, HasOnlyWhatALinkAndACookieLeaveAlone) {
  EXPECT_TRUE(web::is_token("abcDEF12"));
  EXPECT_TRUE(web::is_token("-_.~-_.~"));
  EXPECT_FALSE(web::is_token("1234567"));
  EXPECT_TRUE(web::is_token(std::string(128, 'a')));
  EXPECT_FALSE(web::is_token(std::string(129, 'a')));
  for (const char* const odd :
       {"12345678;", "12345678 ", "1234\r\n5678", "12345678\xc3\xa4", "1234&567=8", "1234%5678"})
    EXPECT_FALSE(web::is_token(odd)) << odd;
}

TEST(Token, IsTheSameOnlyIfAllOfItIs) {
  EXPECT_TRUE(web::is_same_token("abcdefgh", "abcdefgh"));
  EXPECT_FALSE(web::is_same_token("abcdefg", "abcdefgh"));
  EXPECT_FALSE(web::is_same_token("abcdefghabcdefgh", "abcdefgh"));
  EXPECT_FALSE(web::is_same_token("abcdefgx", "abcdefgh"));
  EXPECT_FALSE(web::is_same_token("", "abcdefgh"));
  // Without a token there is nothing to know.
  EXPECT_FALSE(web::is_same_token("", ""));
}

TEST(Token, OfACookieHeaderIsThatOfItsName) {
  EXPECT_EQ(web::cookie("a=1; b=2;c=3", "b"), "2");
  EXPECT_EQ(web::cookie("a=1; b=2;c=3", "c"), "3");
  EXPECT_EQ(web::cookie("ab=1; b=2", "b"), "2");
  EXPECT_EQ(web::cookie("b=", "b"), "");
  EXPECT_FALSE(web::cookie("ab=1", "b"));
  EXPECT_FALSE(web::cookie("b", "b"));
  EXPECT_FALSE(web::cookie("", "b"));
  EXPECT_FALSE(web::cookie(";;; ;", "b"));
}

}  // namespace
