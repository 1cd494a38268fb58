#include "hal/web/conversation.hpp"

#include <string>

#include <gtest/gtest.h>

#include "hal/feed/message/messages.hpp"
#include "hal/feed/world_messages.hpp"
#include "hal/file/read_input.hpp"

namespace {

namespace hal = cargobay::hal;
namespace web = cargobay::web;

TEST(FeedConversation, PassesLinesOnUnchanged) {
  web::FeedConversation conversation;
  EXPECT_FALSE(conversation.hear(R"({"do":"stop"})", false));
  EXPECT_FALSE(conversation.hear("", false));
  EXPECT_EQ(conversation.to_feed(), "{\"do\":\"stop\"}\n");
  conversation.tell(R"({"type":"state","n":0.1})", 0);
  ASSERT_EQ(conversation.to_client().size(), 1U);
  EXPECT_EQ(conversation.to_client().front().bytes, R"({"type":"state","n":0.1})");
  EXPECT_FALSE(conversation.to_client().front().is_binary);
}

TEST(FeedConversation, EndsOverWhatIsNoLine) {
  for (const char* const message : {"{}\n{}", "\n", "{}\r", "{\t}"}) {
    web::FeedConversation conversation;
    const auto ending = conversation.hear(message, false);
    ASSERT_TRUE(ending) << message;
    EXPECT_EQ(ending->code, web::CloseCode::policy);
    EXPECT_EQ(conversation.to_feed(), "");
  }
  web::FeedConversation conversation;
  const auto ending = conversation.hear("{}", true);
  ASSERT_TRUE(ending);
  EXPECT_EQ(ending->code, web::CloseCode::unacceptable);
  EXPECT_EQ(conversation.to_feed(), "");
}

TEST(MessageAssembly, PutsPartsTogether) {
  web::MessageAssembly message;
  EXPECT_TRUE(message.add("ab", false));
  EXPECT_FALSE(message.take());
  EXPECT_TRUE(message.add("", false));
  EXPECT_TRUE(message.add("c", true));
  EXPECT_EQ(message.take(), "abc");
  EXPECT_FALSE(message.take());
  EXPECT_TRUE(message.add("d", true));
  EXPECT_EQ(message.take(), "d");
}

TEST(MessageAssembly, HoldsNoMoreThanAMessage) {
  web::MessageAssembly message;
  EXPECT_TRUE(message.add(std::string(web::kMostMessageBytes, 'x'), true));
  EXPECT_EQ(message.take()->size(), web::kMostMessageBytes);
  EXPECT_FALSE(message.add(std::string(web::kMostMessageBytes + 1, 'x'), true));
  for (std::size_t i = 0; i < web::kMostMessageBytes; ++i) ASSERT_TRUE(message.add("x", false));
  EXPECT_FALSE(message.add("x", false));
}

TEST(LineSplitter, SplitsWhereverTheBytesWereCut) {
  const std::string bytes = "one\ntwo\n\nthree\n";
  for (std::size_t cut = 0; cut <= bytes.size(); ++cut) {
    web::LineSplitter lines;
    std::string found;
    for (const std::string& part : {bytes.substr(0, cut), bytes.substr(cut)}) {
      ASSERT_TRUE(lines.add(part));
      while (const auto line = lines.next()) found += "[" + std::string{*line} + "]";
    }
    EXPECT_EQ(found, "[one][two][][three]") << cut;
  }
}

TEST(LineSplitter, RefusesALineWithoutEnd) {
  web::LineSplitter lines;
  const std::string part(web::LineSplitter::kMostLineBytes, 'x');
  EXPECT_TRUE(lines.add(part));
  EXPECT_FALSE(lines.add("x"));
}

// The file that has the most in it: each byte of it costs the most as JSON.
TEST(LineSplitter, TakesTheLargestWorldThereIs) {
  for (const std::string row : {"post 0 0 9\n", "wall 0 0 9 9\n", "wall 1e5 1e5 1e5 2e5\n"}) {
    std::string text;
    while (text.size() + row.size() <= hal::kMostConfigBytes) text += row;
    const auto world = hal::sim::World::parse(text);
    ASSERT_TRUE(world) << row << world.failure().message;
    hal::JsonObject message = hal::message(hal::FeedType::world, 1);
    hal::put_world(message, *world);
    web::LineSplitter lines;
    EXPECT_TRUE(lines.add(message.take() + "\n")) << row;
    EXPECT_TRUE(lines.next());
    EXPECT_FALSE(lines.next());
  }
}

}  // namespace
