#include "hal/sim/line/server.hpp"

#include <sys/ioctl.h>

#include <cstdlib>
#include <numeric>

#include <gtest/gtest.h>

#include "hal/sim/random.hpp"
#include "oi/checksum.hpp"
#include "oi/dialect.hpp"
#include "tests/pty/serial_client.hpp"

namespace cargobay::hal::sim {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace): this folder's own helpers

std::unique_ptr<Server> serve(const ServerOptions& options = {},
                              const Parameters& parameters = {}) {
  Result<std::unique_ptr<Server>> server = Server::open(parameters, options);
  if (!server || (*server)->start()) return nullptr;
  return std::move(*server);
}

TEST(Server, AnswersAClient) {
  const auto server = serve();
  ASSERT_TRUE(server);
  const SerialClient client{server->path()};
  EXPECT_EQ(client.ask({128, 142, 35}, 1), (Bytes{1}));
  EXPECT_EQ(client.ask({132, 149, 2, 35, 18}, 2), (Bytes{3, 0}));
}

TEST(Server, DoesNotEchoBeforeAClientHasSetThePortUp) {
  const auto server = serve();
  ASSERT_TRUE(server);
  server->with_device([](Device& device) {
    device.receive(128);
    for (const std::uint8_t byte : Bytes{148, 1, 35}) device.receive(byte);
  });
  ASSERT_TRUE(eventually([&] { return server->snapshot().device.frames_sent > 5; }));
  const int descriptor = open(server->path().c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
  ASSERT_TRUE(eventually([&] { return server->snapshot().device.frames_sent > 20; }));
  close(descriptor);
  EXPECT_EQ(server->snapshot().device.bytes_received, 4U);
}

TEST(Server, ServesASecondClientAfterTheFirst) {
  const auto server = serve();
  ASSERT_TRUE(server);
  {
    const SerialClient first{server->path()};
    EXPECT_EQ(first.ask({128, 131, 142, 35}, 1), (Bytes{2}));
  }
  const SerialClient second{server->path()};
  EXPECT_EQ(second.ask({142, 35}, 1), (Bytes{2})) << "the state survives";
}

TEST(Server, KeepsNothingForAClientThatIsGone) {
  const auto server = serve();
  ASSERT_TRUE(server);
  {
    const SerialClient first{server->path()};
    ASSERT_TRUE(first.send({128, 148, 1, 6}));
    ASSERT_TRUE(eventually([&] { return server->snapshot().device.frames_sent > 20; }));
  }
  const std::uint64_t frames = server->snapshot().device.frames_sent;
  ASSERT_TRUE(eventually([&] { return server->snapshot().device.frames_sent > frames + 5; }));
  EXPECT_GT(server->snapshot().server.bytes_undelivered, 0U);
  server->with_device([](Device& device) {
    for (const std::uint8_t byte : Bytes{150, 0}) device.receive(byte);
  });
  const std::uint64_t sent = server->snapshot().device.bytes_sent;
  ASSERT_TRUE(eventually([&] {
    const std::uint64_t delivered = server->snapshot().server.bytes_undelivered;
    poll(nullptr, 0, 20);
    return server->snapshot().server.bytes_undelivered == delivered;
  })) << sent;
  const SerialClient second{server->path()};
  EXPECT_FALSE(second.has_input());
}

TEST(Server, EndsTheExclusiveUseOfAClientThatIsGone) {
  const auto server = serve();
  ASSERT_TRUE(server);
  {
    const SerialClient first{server->path()};
    ASSERT_EQ(ioctl(first.descriptor(), TIOCEXCL), 0);
    EXPECT_EQ(first.ask({128, 142, 35}, 1), (Bytes{1}));
  }
  ASSERT_TRUE(eventually([&] {
    int exclusive = 1;
    const int descriptor = open(server->path().c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
    const bool known = descriptor >= 0 && ioctl(descriptor, TIOCGEXCL, &exclusive) == 0;
    close(descriptor);
    return known && exclusive == 0;
  }));
}

TEST(Server, HearsNothingAtAWrongRate) {
  const auto server = serve();
  ASSERT_TRUE(server);
  const SerialClient client{server->path(), 19200};
  ASSERT_TRUE(client.send({128}));
  ASSERT_TRUE(eventually([&] { return server->snapshot().device.bytes_received > 0; }));
  EXPECT_EQ(server->snapshot().mode, oi::Mode::off);
  ASSERT_TRUE(client.set_baud(57600));
  EXPECT_EQ(client.ask({128, 142, 35}, 1), (Bytes{1}));
}

TEST(Server, IsGarbledToAClientAtAWrongRate) {
  const auto server = serve();
  ASSERT_TRUE(server);
  const SerialClient client{server->path()};
  ASSERT_TRUE(client.send({128, 148, 1, 35}));
  ASSERT_EQ(client.receive(5), (Bytes{19, 2, 35, 1, 199}));
  ASSERT_TRUE(client.set_baud(19200));
  // The frame in flight arrives whole; after that there is no further header.
  EXPECT_TRUE(eventually([&client] {
    const Bytes garbled = client.receive(50);
    return garbled.size() == 50 && std::count(garbled.begin(), garbled.end(), 19) == 0;
  }));
}

TEST(Server, FollowsAClientThatChangesTheRateAtOnce) {
  const auto server = serve();
  ASSERT_TRUE(server);
  const SerialClient client{server->path()};
  EXPECT_EQ(client.ask({128, 142, 35}, 1), (Bytes{1}));
  for (const std::uint8_t code : Bytes{7, 9, 6, 8, 10, 11}) {
    ASSERT_TRUE(client.send({129, code}));
    ASSERT_TRUE(client.set_baud(oi::kCreate.baud_rates[code]));
    ASSERT_TRUE(
        eventually([&] { return server->snapshot().baud == oi::kCreate.baud_rates[code]; }));
    const rt::Duration changed = server->snapshot().time;
    ASSERT_TRUE(eventually(
        [&] { return server->snapshot().time > changed + std::chrono::milliseconds{120}; }));
    ASSERT_TRUE(client.send({142}));
    const rt::Duration sent =
        server->snapshot().time;  // at 115200 the next has to keep its distance
    ASSERT_TRUE(
        eventually([&] { return server->snapshot().time > sent + std::chrono::milliseconds{2}; }));
    EXPECT_EQ(client.ask({35}, 1), (Bytes{1})) << oi::kCreate.baud_rates[code];
  }
}

TEST(Server, StreamsWholeFramesInOrder) {
  const auto server = serve();
  ASSERT_TRUE(server);
  const SerialClient client{server->path()};
  ASSERT_TRUE(client.send({128, 132, 148, 3, 19, 20, 35, 145, 0, 200, 0, 200}));
  const Bytes bytes = client.receive(100 * 11);
  ASSERT_EQ(bytes.size(), 1100U);
  for (std::size_t at = 0; at < bytes.size(); at += 11) {
    const std::span<const std::uint8_t> frame{bytes.data() + at, 11};
    ASSERT_EQ(frame[0], 19) << at;
    ASSERT_TRUE(oi::checksum_matches(frame, oi::Checksum::including_header)) << at;
  }
  EXPECT_EQ(server->snapshot().server.bytes_undelivered, 0U);
}

// Late is the machine's fault; early is never right.
TEST(Server, SendsNoByteEarlierThanTheWireAllows) {
  const auto server = serve({.batch_bytes = 1});
  ASSERT_TRUE(server);
  const SerialClient client{server->path()};
  ASSERT_EQ(client.ask({128, 142, 35}, 1), (Bytes{1}));
  const auto start = std::chrono::steady_clock::now();
  ASSERT_TRUE(client.send({149, 4, 6, 6, 6, 6}));
  for (std::size_t received = 0; received < 208;) {
    const std::size_t count = client.receive(1).size();
    ASSERT_EQ(count, 1U);
    received += count;
    const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - start;
    ASSERT_LE(static_cast<double>(6 + received), passed.count() * 5760.0);
  }
}

TEST(PtyPort, DoesNotWaitForAClientThatDoesNotRead) {
  Result<std::unique_ptr<PtyPort>> port = PtyPort::open("", 57600);
  ASSERT_TRUE(port);
  const SerialClient client{(*port)->path()};
  const Bytes chunk(4096, 0x55);
  std::size_t written = 0;
  while (const std::size_t count = (*port)->write(chunk)) written += count;
  EXPECT_GT(written, 4000U);
  // The kernel may move bytes to the reader's buffer later, and then has room again.
  for (int time = 0; time < 1000; ++time) written += (*port)->write(chunk);
  EXPECT_LT(written, 1000 * chunk.size());
}

TEST(Server, SurvivesTenThousandRandomBytes) {
  const auto server = serve();
  ASSERT_TRUE(server);
  Random random{1};
  {
    const SerialClient client{server->path()};
    Bytes noise(10'000);
    // All except Baud, after which the rate to go on at would be unknown, and scripts and waits,
    // which may leave a robot deaf for any time.
    for (std::uint8_t& byte : noise) {
      do byte = static_cast<std::uint8_t>(random.next());
      while (byte == 129 || (byte >= 152 && byte <= 158));
    }
    ASSERT_TRUE(client.send(noise));
    ASSERT_TRUE(
        eventually([&] { return server->snapshot().device.bytes_received == noise.size(); }));
  }
  const SerialClient client{server->path()};
  ASSERT_TRUE(client.send(Bytes(520, 128)));
  ASSERT_TRUE(client.send({150, 0}));
  ASSERT_TRUE(eventually([&] { return server->snapshot().device.bytes_received >= 10'522; }));
  ASSERT_TRUE(eventually([&] {
    while (client.has_input()) (void)client.receive(1);
    const std::uint64_t sent = server->snapshot().device.bytes_sent;
    poll(nullptr, 0, 20);
    return server->snapshot().device.bytes_sent == sent && !client.has_input();
  }));
  EXPECT_EQ(client.ask({142, 35}, 1), (Bytes{1}));
}

// All possible bytes, at all rates, from clients that read or do not. After that no host can know
// the robot's rate or what it waits for, so its battery is taken out.
TEST(Server, ServesOnAfterAnyClientsWhatever) {
  const auto server = serve();
  ASSERT_TRUE(server);
  Random random{2};
  for (int i = 0; i < 60; ++i) {
    const std::uint32_t rates = static_cast<std::uint32_t>(oi::kCreate.baud_rates.size());
    const std::uint32_t rate = i % 5 == 4 ? 1U + static_cast<std::uint32_t>(random.below(100'000))
                                          : oi::kCreate.baud_rates[random.below(rates)];
    const SerialClient client{server->path(), rate};
    ASSERT_TRUE(client.is_open());
    Bytes noise(random.below(400));
    for (std::uint8_t& byte : noise) byte = static_cast<std::uint8_t>(random.next());
    (void)!write(client.descriptor(), noise.data(), noise.size());  // what has room, as it is
    if (i % 3 == 0) poll(nullptr, 0, 5);
    if (i % 4 == 0 && client.has_input()) (void)client.receive(1);
  }
  server->with_device([](Device& device) {
    if (device.power() == Power::off) device.press_power();
    device.inputs() = {};
    device.brown_out();
  });
  const SerialClient client{server->path()};
  ASSERT_TRUE(eventually([&] {
    while (client.has_input()) (void)client.receive(1);
    bool on = false;
    server->with_device([&on](Device& device) { on = device.power() == Power::on; });
    return on;
  }));
  poll(nullptr, 0, 20);
  while (client.has_input()) (void)client.receive(1);
  EXPECT_EQ(client.ask({128, 142, 35}, 1), (Bytes{1}));
}

TEST(Server, OpensAndClosesAtWill) {
  const auto server = serve();
  ASSERT_TRUE(server);
  for (int i = 0; i < 100; ++i) {
    const SerialClient client{server->path()};
    ASSERT_TRUE(client.is_open());
    if (i % 2 == 0) {
      ASSERT_TRUE(client.send({128}));
    }
  }
  const SerialClient client{server->path()};
  EXPECT_EQ(client.ask({128, 142, 35}, 1), (Bytes{1}));
}

TEST(Server, KeepsTheTruthOfEachTick) {
  const auto server = serve();
  ASSERT_TRUE(server);
  const SerialClient client{server->path()};
  ASSERT_EQ(client.ask({128, 132, 145, 0, 200, 0, 100, 142, 35}, 1), (Bytes{3}));
  ASSERT_TRUE(eventually([&] { return server->snapshot().truth.speeds.right_mm_s > 150.0; }));
  std::vector<TruthSample> samples;
  server->take_truth(samples);
  ASSERT_GT(samples.size(), 5U);
  for (std::size_t i = 1; i < samples.size(); ++i) {
    EXPECT_EQ((samples[i].time - samples[i - 1].time) % std::chrono::milliseconds{15},
              rt::Duration{0});
    EXPECT_GT(samples[i].time, samples[i - 1].time);
  }
  EXPECT_EQ(samples.back().commanded.right_mm_s, 200.0);
  EXPECT_EQ(samples.back().commanded.left_mm_s, 100.0);
  EXPECT_EQ(samples.back().mode, oi::Mode::full);
}

TEST(Server, SaysWhetherItGotItsPriority) {
  const auto server = serve({.priority = 10});
  ASSERT_TRUE(server);
  EXPECT_TRUE(server->priority_error() == 0 || server->priority_error() == EPERM);
}

// What the robot sends meanwhile is lost, as from an open plug.
TEST(Server, StreamsOnWhileItsPortIsAway) {
  const auto server = serve();
  ASSERT_TRUE(server);
  {
    const SerialClient client{server->path()};
    EXPECT_FALSE(client.ask({128, 148, 1, 35}, 5).empty());
    server->unplug();
  }
  const Snapshot unplugged = server->snapshot();
  EXPECT_TRUE(eventually([&] {
    const Snapshot now = server->snapshot();
    return now.time > unplugged.time + std::chrono::milliseconds{100} &&
           now.server.bytes_undelivered > unplugged.server.bytes_undelivered;
  }));
  EXPECT_TRUE(server->replug());
  const SerialClient again{server->path()};
  EXPECT_EQ(again.receive(5).size(), 5U) << "it did not notice";
}

}  // namespace
}  // namespace cargobay::hal::sim
