#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "hal/web/foxglove/foxglove_conversation.hpp"

namespace {

namespace hal = cargobay::hal;
namespace web = cargobay::web;
using Json = nlohmann::json;
using testing::HasSubstr;

constexpr std::int64_t kNowNs = 1'700'000'000'000'000'000;

const std::string kState =
    R"({"type":"state","seq":7,"tick":2,"robot_time_s":0.03,"unix_time_s":1700000000.25,)"
    R"("pose":{"x_mm":1000.0,"y_mm":-500.0,"heading_rad":0.0}})";

class FoxgloveTest : public testing::Test {
 protected:
  struct Message {
    std::uint32_t subscription = 0;
    std::uint64_t time_ns = 0;
    std::string payload{};
  };

  std::vector<Json> texts() {
    std::vector<Json> result;
    for (const web::Frame& frame : conversation_.to_client()) {
      if (!frame.is_binary) result.push_back(Json::parse(frame.bytes));
    }
    conversation_.to_client().clear();
    return result;
  }
  static std::uint64_t number(const std::string& bytes, std::size_t at, std::size_t length) {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < length; ++i)
      value |= std::uint64_t{static_cast<unsigned char>(bytes.at(at + i))} << 8 * i;
    return value;
  }
  std::vector<Message> data() {
    std::vector<Message> result;
    for (const web::Frame& frame : conversation_.to_client()) {
      if (!frame.is_binary || frame.bytes.at(0) != 1) continue;
      result.push_back({.subscription = static_cast<std::uint32_t>(number(frame.bytes, 1, 4)),
                        .time_ns = number(frame.bytes, 5, 8),
                        .payload = frame.bytes.substr(13)});
    }
    conversation_.to_client().clear();
    return result;
  }
  std::string requests() { return std::exchange(conversation_.to_feed(), {}); }
  void say(const Json& message) { EXPECT_FALSE(conversation_.hear(message.dump(), false)); }
  void say_binary(const std::string& bytes) { EXPECT_FALSE(conversation_.hear(bytes, true)); }
  void subscribe(std::uint32_t subscription, web::ChannelId channel) {
    say({{"op", "subscribe"},
         {"subscriptions", {{{"id", subscription}, {"channelId", static_cast<int>(channel)}}}}});
  }
  void publish(const std::string& payload) {
    say_binary(std::string("\x01\x05\x00\x00\x00", 5) + payload);
  }
  void advertise() {
    say({{"op", "advertise"},
         {"channels",
          {{{"id", 5},
            {"topic", "/cmd_vel"},
            {"encoding", "json"},
            {"schemaName", "geometry_msgs/Twist"}}}}});
  }

  cargobay::rt::TimePoint now_{};
  web::FoxgloveConversation conversation_{[this] { return now_; }};
};

TEST_F(FoxgloveTest, IntroducesItself) {
  const auto greeting = texts();
  ASSERT_EQ(greeting.size(), 3U);
  EXPECT_EQ(greeting[0]["op"], "serverInfo");
  EXPECT_THAT(greeting[0]["capabilities"].dump(), HasSubstr("clientPublish"));
  EXPECT_EQ(greeting[1]["op"], "advertise");
  for (const Json& channel : greeting[1]["channels"]) {
    EXPECT_EQ(channel["encoding"], "json");
    EXPECT_EQ(Json::parse(channel["schema"].get<std::string>())["type"], "object") << channel;
    // Each schema says what is in it.
    EXPECT_FALSE(Json::parse(channel["schema"].get<std::string>())["properties"].empty());
  }
  EXPECT_EQ(greeting[2]["op"], "advertiseServices");
}

TEST_F(FoxgloveTest, PassesTheFeedOnByteByByte) {
  (void)texts();
  subscribe(9, web::own_channel(hal::FeedType::state));
  conversation_.tell(kState, kNowNs);
  const auto messages = data();
  ASSERT_EQ(messages.size(), 1U);
  EXPECT_EQ(messages[0].subscription, 9U);
  EXPECT_EQ(messages[0].payload, kState);
  EXPECT_EQ(messages[0].time_ns, 1'700'000'000'250'000'000U);
  say({{"op", "unsubscribe"}, {"subscriptionIds", {9}}});
  conversation_.tell(kState, kNowNs);
  EXPECT_TRUE(data().empty());
}

TEST_F(FoxgloveTest, AsksTheFeedForNoMoreThanIsWanted) {
  conversation_.tell(R"({"type":"hello","seq":1,"wheel_base_mm":258})", kNowNs);
  EXPECT_EQ(requests(),
            "{\"do\":\"subscribe\",\"types\":[\"statistics\",\"virtual_create\",\"world\"]}\n");
  subscribe(1, web::ChannelId::true_pose);
  EXPECT_THAT(requests(), HasSubstr(R"(["state","statistics","truth","virtual_create","world"])"));
  subscribe(2, web::own_channel(hal::FeedType::truth));
  EXPECT_EQ(requests(), "");
}

TEST_F(FoxgloveTest, GivesLateSubscribersWhatComesRarely) {
  const std::string statistics = R"({"type":"statistics","seq":3,"unsent":0})";
  conversation_.tell(statistics, kNowNs);
  conversation_.to_client().clear();
  subscribe(4, web::own_channel(hal::FeedType::statistics));
  const auto messages = data();
  ASSERT_EQ(messages.size(), 1U);
  EXPECT_EQ(messages[0].payload, statistics);
}

TEST_F(FoxgloveTest, GivesTheWorldToEachThatSubscribes) {
  const std::string world = R"({"type":"world","seq":2,"walls":[]})";
  conversation_.tell(world, kNowNs);
  conversation_.to_client().clear();
  for (std::uint32_t subscription = 4; subscription < 7; ++subscription) {
    subscribe(subscription, web::own_channel(hal::FeedType::world));
    const auto messages = data();
    ASSERT_EQ(messages.size(), 1U);
    EXPECT_EQ(messages[0].subscription, subscription);
    EXPECT_EQ(messages[0].payload, world);
    EXPECT_EQ(messages[0].time_ns, static_cast<std::uint64_t>(kNowNs)) << "when it came";
  }
}

TEST_F(FoxgloveTest, DrawsThePoseAndTheWorldInOneFrame) {
  subscribe(1, web::ChannelId::pose);
  subscribe(2, web::ChannelId::scene);
  subscribe(3, web::ChannelId::true_pose);
  subscribe(4, web::ChannelId::transform);
  subscribe(5, web::ChannelId::path);
  conversation_.to_client().clear();
  conversation_.tell(
      R"({"type":"world","seq":2,"walls":[{"x1_mm":0,"y1_mm":0,"x2_mm":2000,"y2_mm":0}],)"
      R"("boxes":[],"posts":[{"x_mm":500,"y_mm":0,"radius_mm":50}],"home_base":null})",
      kNowNs);
  conversation_.tell(kState, kNowNs);
  // The world's origin is where the odometry has (0, -1.5), turned by -90 degrees.
  conversation_.tell(R"({"type":"truth","seq":9,"time_s":0.5,)"
                     R"("pose":{"x_mm":-1000,"y_mm":1000,"heading_deg":90}})",
                     kNowNs);
  const auto messages = data();
  ASSERT_EQ(messages.size(), 5U);
  const Json pose = Json::parse(messages[0].payload);
  EXPECT_EQ(pose["frame_id"], "odom");
  EXPECT_DOUBLE_EQ(pose["pose"]["position"]["x"], 1.0);
  const Json scene = Json::parse(messages[3].payload)["entities"][0];
  const Json wall = scene["cubes"][0];
  EXPECT_DOUBLE_EQ(wall["size"]["x"], 2.0);
  EXPECT_NEAR(wall["pose"]["position"]["x"], 0.0, 1e-9);
  EXPECT_NEAR(wall["pose"]["position"]["y"], -2.5, 1e-9);
  EXPECT_NEAR(scene["cylinders"][0]["pose"]["position"]["y"], -2.0, 1e-9);
  // Both agree where they begin.
  const Json truth = Json::parse(messages[4].payload);
  EXPECT_EQ(messages[4].subscription, 3U);
  EXPECT_NEAR(truth["pose"]["position"]["x"], 1.0, 1e-9);
  EXPECT_NEAR(truth["pose"]["position"]["y"], -0.5, 1e-9);
}

TEST_F(FoxgloveTest, TakesTheLeaseForTheFirstVelocityAndSendsTheNewest) {
  advertise();
  publish(R"({"linear":{"x":0.1},"angular":{"z":0.5}})");
  EXPECT_EQ(requests(), "{\"id\":1,\"do\":\"hold\",\"name\":\"Foxglove\"}\n");
  publish(R"({"twist":{"linear":{"x":0.2},"angular":{"z":0}}})");
  EXPECT_EQ(requests(), "");
  conversation_.tell(R"({"type":"answer","id":1,"ok":true})", kNowNs);
  EXPECT_EQ(requests(),
            "{\"id\":2,\"do\":\"drive\",\"velocity_mm_s\":200.0,\"turn_rate_rad_s\":0.0}\n");
  conversation_.tell(R"({"type":"answer","id":2,"ok":true})", kNowNs);
  publish(R"({"linear":{"x":-0.1}})");
  EXPECT_THAT(requests(), HasSubstr("\"velocity_mm_s\":-100.0"));
  say({{"op", "unadvertise"}, {"channelIds", {5}}});
  EXPECT_THAT(requests(), HasSubstr("\"do\":\"release\""));
}

TEST_F(FoxgloveTest, SaysWhoSteersIfItIsSomebodyElse) {
  advertise();
  publish(R"({"linear":{"x":0.1}})");
  (void)requests();
  (void)texts();
  conversation_.tell(R"({"type":"answer","id":1,"ok":false,"error":"Ada steers"})", kNowNs);
  EXPECT_EQ(requests(), "");
  const auto said = texts();
  ASSERT_EQ(said.size(), 1U);
  EXPECT_THAT(said[0]["message"].get<std::string>(), HasSubstr("Ada steers"));
  say({{"op", "setParameters"}, {"parameters", {{{"name", "steer.take"}, {"value", true}}}}});
  publish(R"({"linear":{"x":0.1}})");
  EXPECT_THAT(requests(), HasSubstr("\"take\":true"));
}

// A stop is everyone's, also against who goes on publishing.
TEST_F(FoxgloveTest, AsksForTheLeaseAgainOnlyWhenItWasLetGo) {
  advertise();
  // Another one may have the same name.
  for (const char* const holder :
       {R"(null,"lease":null)", R"("Ada","lease":8)", R"("Foxglove","lease":8)"}) {
    now_ += web::Steering::kLetGo;
    publish(R"({"linear":{"x":0.1}})");
    const std::string hold = requests();
    ASSERT_THAT(hold, HasSubstr("\"do\":\"hold\""));
    const std::string id = hold.substr(0, hold.find(','));  // {"id":N
    conversation_.tell(id + R"(,"type":"answer","ok":true,"result":{"lease":7}})", kNowNs);
    EXPECT_THAT(requests(), HasSubstr("\"do\":\"drive\""));
    (void)texts();
    conversation_.tell(R"({"type":"holder","seq":4,"name":"Foxglove","lease":7})", kNowNs);
    EXPECT_TRUE(texts().empty()) << "that is this one";
    conversation_.tell(std::string{R"({"type":"holder","seq":5,"name":)"} + holder + "}", kNowNs);
    EXPECT_EQ(texts().size(), 1U) << "says why";
    for (int i = 0; i < 20; ++i) {
      now_ += std::chrono::milliseconds{100};
      publish(R"({"linear":{"x":0.1}})");
      EXPECT_EQ(requests(), "");
    }
    EXPECT_TRUE(texts().empty());
  }
}

TEST_F(FoxgloveTest, DrivesNoMoreAfterARefusalUntilItWasLetGo) {
  advertise();
  publish(R"({"linear":{"x":0.1}})");
  conversation_.tell(R"({"type":"answer","id":1,"ok":true})", kNowNs);
  conversation_.tell(R"({"type":"answer","id":2,"ok":false,"error":"passive"})", kNowNs);
  (void)requests();
  publish(R"({"linear":{"x":0.1}})");
  EXPECT_EQ(requests(), "");
  now_ += web::Steering::kLetGo;
  publish(R"({"linear":{"x":0.1}})");
  EXPECT_THAT(requests(), HasSubstr("\"do\":\"hold\""));
}

TEST_F(FoxgloveTest, DrivesByNoVelocityThatIsNone) {
  advertise();
  for (const char* const payload : {"", "x", "[]", "1", R"({"linear":{"x":"1"}})",
                                    R"({"linear":{"x":null}})", R"({"angular":{"z":1e999}})"}) {
    (void)texts();
    publish(payload);
    EXPECT_EQ(requests(), "") << payload;
    EXPECT_EQ(texts().size(), 1U) << payload;
  }
  say_binary(std::string("\x01\x06\x00\x00\x00{}", 7));  // a channel that was not advertised
  EXPECT_EQ(requests(), "");
}

TEST_F(FoxgloveTest, HasParameters) {
  conversation_.tell(R"({"type":"hello","seq":1,"wheel_base_mm":258,"steerable":true})", kNowNs);
  (void)texts();
  say({{"op", "getParameters"}, {"parameterNames", {"wheel_base_mm", "steerable"}}, {"id", "a"}});
  const auto answers = texts();
  ASSERT_EQ(answers.size(), 1U);
  EXPECT_EQ(answers[0]["id"], "a");
  EXPECT_EQ(answers[0]["parameters"].size(), 2U);
  EXPECT_EQ(answers[0]["parameters"][1]["value"], 258);
  say({{"op", "setParameters"}, {"parameters", {{{"name", "wheel_base_mm"}, {"value", 1}}}}});
  const auto refused = texts();
  EXPECT_EQ(refused[0]["op"], "status");
  EXPECT_EQ(refused[1]["parameters"][0]["value"], 258);
  say({{"op", "subscribeParameterUpdates"}, {"parameterNames", {"holder"}}});
  conversation_.tell(R"({"type":"holder","seq":5,"name":"Ada"})", kNowNs);
  const auto updates = texts();
  (void)updates;
}

TEST_F(FoxgloveTest, StopsByAService) {
  (void)texts();
  say_binary(std::string("\x02\x01\x00\x00\x00\x2a\x00\x00\x00\x04\x00\x00\x00json{}", 19));
  EXPECT_EQ(requests(), "{\"id\":1,\"do\":\"stop\"}\n");
  conversation_.tell(R"({"type":"answer","id":1,"ok":true})", kNowNs);
  ASSERT_EQ(conversation_.to_client().size(), 1U);
  const std::string answer = conversation_.to_client().front().bytes;
  EXPECT_EQ(answer.at(0), 3);
  EXPECT_EQ(number(answer, 5, 4), 42U);
  EXPECT_EQ(answer.substr(17), R"({"error":"","ok":true})");
  // Another one, in another encoding, and longer than it is.
  conversation_.to_client().clear();
  say_binary(std::string("\x02\x09\x00\x00\x00\x2a\x00\x00\x00\x04\x00\x00\x00json{}", 19));
  say_binary(
      std::string("\x02\x01\x00\x00\x00\x2a\x00\x00\x00\x04\x00\x00\x00"
                  "cdr1",
                  17));
  say_binary(std::string("\x02\x01\x00\x00\x00\x2a\x00\x00\x00\xff\xff\xff\xff", 13));
  EXPECT_EQ(requests(), "");
  EXPECT_EQ(texts().size(), 3U);
}

TEST_F(FoxgloveTest, AnswersNonsenseWithAStatus) {
  for (const char* const text : {"", "x", "[]", "{}", "null", R"({"op":1})", R"({"op":"fly"})",
                                 R"({"op":"subscribe","subscriptions":[{"id":-1}]})",
                                 R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":999}]})",
                                 R"({"op":"unsubscribe","subscriptionIds":["a"]})",
                                 R"({"op":"advertise","channels":[{"id":1,"topic":"/x"}]})",
                                 R"({"op":"getParameters","parameterNames":[1]})"}) {
    (void)texts();
    EXPECT_FALSE(conversation_.hear(text, false));
    const auto said = texts();
    ASSERT_EQ(said.size(), 1U) << text;
    EXPECT_EQ(said[0]["op"], "status") << text;
    EXPECT_EQ(requests(), "") << text;
  }
}

TEST_F(FoxgloveTest, BoundsWhatAClientCanPileUp) {
  for (std::uint32_t i = 0; i < 1000; ++i) subscribe(i, web::own_channel(hal::FeedType::state));
  (void)texts();
  conversation_.tell(kState, kNowNs);
  EXPECT_EQ(data().size(), 128U);
  // Requests without answer.
  for (int i = 0; i < 1000; ++i)
    say_binary(std::string("\x02\x01\x00\x00\x00\x2a\x00\x00\x00\x04\x00\x00\x00json{}", 19));
  std::string all = requests();
  EXPECT_EQ(std::count(all.begin(), all.end(), '\n'), 33);  // a subscription among them
}

}  // namespace
