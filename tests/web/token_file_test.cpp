#include "hal/web/program/token_file.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hal/web/token.hpp"

namespace {

namespace web = cargobay::web;
using testing::HasSubstr;

class TokenFileTest : public testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directory(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  void write(const std::string& text, mode_t mode) const {
    std::ofstream{path_} << text;
    ASSERT_EQ(chmod(path_.c_str(), mode), 0);
  }

  std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("cargobay_token_" + std::to_string(getpid()));
  std::string path_ = folder_ / "token";
};

TEST_F(TokenFileTest, IsMadeOnceForItsOwnerAndGroup) {
  const auto made = web::token_in(path_);
  ASSERT_TRUE(made) << made.failure().message;
  EXPECT_TRUE(web::is_token(*made));
  struct stat status{};
  ASSERT_EQ(stat(path_.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 07777U, 0640U);
  const auto again = web::token_in(path_);
  ASSERT_TRUE(again);
  EXPECT_EQ(*again, *made);
}

TEST_F(TokenFileTest, HasATokenOfYourOwn) {
  write("of-my-own-choice\n", 0600);
  const auto token = web::token_in(path_);
  ASSERT_TRUE(token);
  EXPECT_EQ(*token, "of-my-own-choice");
}

TEST_F(TokenFileTest, IsRefusedIfItKeepsNoSecretOrHasNone) {
  write("of-my-own-choice\n", 0604);
  EXPECT_THAT(web::token_in(path_).failure().message, HasSubstr("chmod"));
  for (const char* const text : {"", "short\n", "two lines\nof it\n"}) {
    write(text, 0600);
    EXPECT_THAT(web::token_in(path_).failure().message, HasSubstr("no token")) << text;
  }
  EXPECT_THAT(web::token_in(folder_).failure().message, HasSubstr("not a file"));
  EXPECT_FALSE(web::token_in(folder_ / "missing" / "token"));
}

}  // namespace
