#include "tests/conformance/subject.hpp"

#include <algorithm>

#include "oi/dialect.hpp"

namespace cargobay::conformance {

std::unique_ptr<hal::ByteStream> port;
std::uint32_t boot_baud = oi::kCreate.default_baud;

namespace {

constexpr std::uint32_t kFastBaud = 115200;

}  // namespace

void Conformance::SetUp() {
  if (!port) {
    device_ = std::make_unique<hal::sim::Device>(hal::sim::Parameters{});
    link_ = std::make_unique<hal::sim::VirtualLink>(*device_);
  }
  ASSERT_FALSE(stream().set_baud(boot_baud));
  // Enough to complete any command left half-sent, and to leave Off.
  send(Bytes(520, 128));
  send({150, 0, 152, 0, 136, 255});
  wait(300ms);
  ASSERT_EQ(mode(), 1) << "no device answers at " << boot_baud << " baud";
}

void Conformance::TearDown() {
  send({128, 150, 0});
  wait(100ms);
}

void Conformance::send(const Bytes& bytes) {
  std::size_t sent = 0;
  const rt::TimePoint deadline = stream().now() + 20s;
  while (sent < bytes.size() && stream().now() < deadline) {
    // 115200 needs 200 us between the beginnings of two bytes.
    const std::size_t piece = stream().baud() == kFastBaud ? 1 : bytes.size() - sent;
    sent += stream().write({bytes.data() + sent, piece}).count;
    if (stream().drain(20s) && piece == 1) (void)stream().wait(stream().now() + 1ms);
  }
}

Bytes Conformance::receive(std::size_t count, rt::Duration patience) {
  Bytes bytes(count);
  std::size_t received = 0;
  const rt::TimePoint deadline = stream().now() + patience;
  while (received < count) {
    const auto transfer = stream().read({bytes.data() + received, count - received});
    received += transfer.count;
    if (transfer.count == 0 && stream().wait(deadline) != hal::ByteStream::Wait::ready) break;
  }
  bytes.resize(received);
  return bytes;
}

Bytes Conformance::listen(rt::Duration period) {
  Bytes heard;
  const rt::TimePoint deadline = stream().now() + period;
  while (stream().now() < deadline) {
    const Bytes piece = receive(1, deadline - stream().now());
    heard.insert(heard.end(), piece.begin(), piece.end());
  }
  return heard;
}

std::uint8_t Conformance::packet(std::uint8_t id) {
  const Bytes answer = ask({142, id}, 1);
  EXPECT_EQ(answer.size(), 1U) << "packet " << int{id};
  return answer.empty() ? std::uint8_t{0xff} : answer[0];
}

std::int16_t Conformance::word_packet(std::uint8_t id) {
  const Bytes answer = ask({142, id}, 2);
  EXPECT_EQ(answer.size(), 2U) << "packet " << int{id};
  return answer.size() < 2 ? std::int16_t{-1}
                           : static_cast<std::int16_t>(answer[0] * 256 + answer[1]);
}

int Conformance::moved_within(rt::Duration period) {
  (void)word_packet(19);
  wait(period);
  return word_packet(19);
}

}  // namespace cargobay::conformance
