// What waits for a reader that is slow, and what it is told.
#include "hal/feed/feed_connection.hpp"

#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace cargobay::hal {
namespace {

using nlohmann::json;

class FeedConnectionTest : public testing::Test {
 public:
  FeedConnectionTest() {
    std::array<int, 2> ends{};
    EXPECT_EQ(socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, ends.data()), 0);
    connection = std::make_unique<FeedConnection>(Descriptor{ends[0]}, 1, rt::TimePoint{});
    reader = Descriptor{ends[1]};
  }

  void put(FeedType type, int number, std::size_t padding = 0) const {
    const json message{{"type", name(type)}, {"n", number}, {"pad", std::string(padding, '.')}};
    connection->put(
        {.type = type, .line = std::make_shared<const std::string>(message.dump() + "\n")});
  }
  // Reads and sends until nothing more comes.
  std::vector<json> all() {
    std::vector<json> messages;
    std::array<char, 65536> bytes{};
    for (;;) {
      EXPECT_TRUE(connection->flush());
      const ssize_t count = ::read(reader.number(), bytes.data(), bytes.size());
      if (count <= 0) break;
      text.append(bytes.data(), static_cast<std::size_t>(count));
      for (std::size_t end = text.find('\n'); end != std::string::npos; end = text.find('\n')) {
        messages.push_back(json::parse(text.substr(0, end)));
        text.erase(0, end + 1);
      }
    }
    EXPECT_TRUE(text.empty()) << "each is whole";
    return messages;
  }

  std::unique_ptr<FeedConnection> connection{};
  Descriptor reader{};
  std::string text{};
};

TEST_F(FeedConnectionTest, PassesAllOnInOrder) {
  for (int i = 0; i < 100; ++i) put(FeedType::state, i);
  const auto messages = all();
  ASSERT_EQ(messages.size(), 100U);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(messages[static_cast<std::size_t>(i)]["n"], i);
  EXPECT_EQ(connection->missed(), 0U);
}

TEST_F(FeedConnectionTest, DropsOldReadingsAndSaysHowMany) {
  constexpr int kMany = 3000;  // of about 1 kB: more than socket and queue hold
  for (int i = 0; i < kMany; ++i) {
    put(FeedType::state, i, 1000);
    if (i % 100 == 0) put(FeedType::event, i);
    EXPECT_TRUE(connection->flush());
  }
  std::size_t states = 0;
  std::size_t events = 0;
  std::uint64_t missed = 0;
  int last = -1;
  for (const json& message : all()) {
    if (message["type"] == "missed") missed += message["messages"].get<std::uint64_t>();
    if (message["type"] == "event") ++events;
    if (message["type"] != "state") continue;
    ++states;
    EXPECT_GT(message["n"], last);
    last = message["n"];
  }
  EXPECT_EQ(events, 30U) << "news are kept";
  EXPECT_EQ(last, kMany - 1) << "and the newest reading";
  EXPECT_GT(missed, 0U);
  EXPECT_EQ(states + missed, kMany) << "all others are accounted for";
  EXPECT_EQ(connection->missed(), missed);
}

TEST_F(FeedConnectionTest, IsBoundedWhateverComes) {
  for (int i = 0; i < 4000; ++i) put(FeedType::event, i, 1000);  // nothing is read or sent
  std::size_t bytes = 0;
  std::uint64_t missed = 0;
  for (const json& message : all()) {
    bytes += message.dump().size() + 1;
    if (message["type"] == "missed") missed = message["messages"];
  }
  EXPECT_LE(bytes, FeedConnection::kMostBytes + 200);
  EXPECT_EQ(missed, connection->missed());
}

TEST_F(FeedConnectionTest, PassesOnWhatIsChosen) {
  FeedChoice choice;
  choice.types.reset().set(static_cast<std::size_t>(FeedType::state));
  choice.every = 3;
  connection->choose(choice);
  for (int i = 0; i < 7; ++i) {
    put(FeedType::state, i);
    put(FeedType::sensors, i);
  }
  put(FeedType::answer, 7);
  std::vector<int> numbers;
  for (const json& message : all()) numbers.push_back(message["n"]);
  EXPECT_THAT(numbers, testing::ElementsAre(0, 3, 6, 7));
  EXPECT_EQ(connection->missed(), 0U) << "it did not want the others";
}

TEST_F(FeedConnectionTest, HearsWholeLines) {
  std::vector<std::string> heard;
  const auto hear = [&](std::string_view line) { heard.emplace_back(line); };
  EXPECT_EQ(write(reader.number(), "one\ntw", 6), 6);
  EXPECT_TRUE(connection->receive(hear));
  EXPECT_EQ(write(reader.number(), "o\n\n", 3), 3);
  EXPECT_TRUE(connection->receive(hear));
  EXPECT_THAT(heard, testing::ElementsAre("one", "two", ""));
}

TEST_F(FeedConnectionTest, IsOverWithALineThatIsTooLong) {
  const std::string line(FeedConnection::kLongestLine + 1, 'x');
  EXPECT_EQ(write(reader.number(), line.data(), line.size()), static_cast<ssize_t>(line.size()));
  const auto hear = [](std::string_view) { FAIL() << "it has no end"; };
  EXPECT_TRUE(connection->receive(hear));
  EXPECT_FALSE(connection->receive(hear));
}

TEST_F(FeedConnectionTest, IsOverWhenTheReaderIsGone) {
  reader = Descriptor{};
  EXPECT_FALSE(connection->receive([](std::string_view) {}));
  put(FeedType::state, 1);
  EXPECT_FALSE(connection->flush());
}

TEST_F(FeedConnectionTest, TellsOfWhatWasGoneBeforeItCouldBePut) {
  connection->lose(FeedType::state, 44);
  connection->lose(FeedType::event, 2);
  put(FeedType::state, 45);
  auto messages = all();
  ASSERT_EQ(messages.size(), 2U);
  EXPECT_EQ(messages[0], (json{{"type", "missed"}, {"messages", 46}}));
  EXPECT_EQ(connection->missed(), 46U);
  FeedChoice choice;
  choice.types.reset().set(static_cast<std::size_t>(FeedType::state));
  choice.every = 10;
  connection->choose(choice);
  connection->lose(FeedType::event, 5);
  connection->lose(FeedType::state, 100);
  EXPECT_EQ(connection->missed(), 56U) << "only of those it has chosen";
}

// However they come: one at a time or many at once, put or lost.
TEST_F(FeedConnectionTest, CountsWhatIsLostAsItWouldHaveBeenPut) {
  constexpr std::uint64_t kSome[] = {1, 5, 2, 12, 0, 3, 24, 7};
  for (std::uint32_t every = 1; every <= 7; ++every) {
    FeedChoice choice;
    choice.every = every;
    FeedConnection at_once{Descriptor{}, 1, {}};
    FeedConnection by_one{Descriptor{}, 2, {}};
    at_once.choose(choice);
    by_one.choose(choice);
    std::uint64_t passed = 0;
    for (const std::uint64_t count : kSome) {
      at_once.lose(FeedType::state, count);
      for (std::uint64_t i = 0; i < count; ++i) by_one.lose(FeedType::state, 1);
      passed += count;
      EXPECT_EQ(at_once.missed(), (passed + every - 1) / every) << "every " << every;
      EXPECT_EQ(by_one.missed(), at_once.missed()) << "every " << every;
    }
  }
}

TEST_F(FeedConnectionTest, CountsAnyNumberAtOnce) {
  FeedChoice choice;
  choice.every = 4;
  connection->choose(choice);
  put(FeedType::state, 0);
  constexpr std::uint64_t kVeryMany = std::uint64_t{1} << 62U;  // one by one, years
  connection->lose(FeedType::state, kVeryMany);
  EXPECT_EQ(connection->missed(), kVeryMany / 4);
  for (int i = 1; i < 5; ++i) put(FeedType::state, i);
  std::vector<int> numbers;
  for (const json& message : all()) {
    if (message["type"] == "state") numbers.push_back(message["n"]);
  }
  EXPECT_THAT(numbers, testing::ElementsAre(0, 4)) << "every fourth, as if none had been lost";
}

TEST_F(FeedConnectionTest, GoesOnInTurnsWhenItIsChosenAgain) {
  FeedChoice choice;
  choice.every = 8;
  connection->choose(choice);
  for (int i = 0; i < 8; ++i) put(FeedType::state, i);  // 0
  connection->choose(choice);
  for (int i = 8; i < 14; ++i) put(FeedType::state, i);  // 8
  choice.every = 3;
  connection->choose(choice);
  for (int i = 14; i < 18; ++i) put(FeedType::state, i);  // 14, 17
  std::vector<int> numbers;
  for (const json& message : all()) numbers.push_back(message["n"]);
  EXPECT_THAT(numbers, testing::ElementsAre(0, 8, 14, 17));
}

}  // namespace
}  // namespace cargobay::hal
