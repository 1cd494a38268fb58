// Reads a robot's stream as libcreate does (AutonomyLab; serial.cpp, serial_stream.cpp, data.cpp
// and create.cpp in its src): one asynchronous read for each byte, a state machine by bytes,
// packets in a map, two mutexes a packet, and an odometry step a frame. Its structure, not its
// code. Prints nothing while it runs.
// usage: like_libcreate PORT BAUD SECONDS PACKET...
#include <unistd.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <numbers>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <boost/asio.hpp>

namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::uint8_t kStart = 128;
constexpr std::uint8_t kStream = 148;
constexpr std::uint8_t kStop = 173;
constexpr std::uint8_t kHeader = 19;
constexpr std::uint8_t kDistance = 19;
constexpr std::uint8_t kAngle = 20;

unsigned size_of(std::uint8_t packet) {
  switch (packet) {
    case 19:
    case 20:
    case 22:
    case 23:
    case 25:
    case 26:
    case 27:
    case 28:
    case 29:
    case 30:
    case 31:
    case 33:
    case 39:
    case 40:
    case 41:
    case 42: return 2;
    default: return 1;
  }
}

class Packet {
 public:
  explicit Packet(unsigned count) : bytes{count} {}
  void keep(std::uint16_t value) {
    const std::scoped_lock lock{unchecked_mutex_};
    unchecked_ = value;
  }
  void accept() {
    const std::scoped_lock lock{unchecked_mutex_};
    const std::scoped_lock other{mutex_};
    value_ = unchecked_;
  }
  std::uint16_t value() const {
    const std::scoped_lock lock{mutex_};
    return value_;
  }
  const unsigned bytes;

 private:
  std::uint16_t value_ = 0;
  std::uint16_t unchecked_ = 0;
  mutable std::mutex mutex_{};
  std::mutex unchecked_mutex_{};
};

class Data {
 public:
  explicit Data(const Bytes& ids) {
    for (const std::uint8_t id : ids) packets_[id] = std::make_shared<Packet>(size_of(id));
    for (const auto& [id, packet] : packets_) bytes += packet->bytes;
  }
  bool has(std::uint8_t id) const { return packets_.contains(id); }
  std::shared_ptr<Packet> packet(std::uint8_t id) { return has(id) ? packets_[id] : nullptr; }
  void accept_all() {
    for (auto& [id, packet] : packets_) packet->accept();
  }
  std::size_t count() const { return packets_.size(); }
  unsigned bytes = 0;

 private:
  std::map<std::uint8_t, std::shared_ptr<Packet>> packets_{};
};

class Serial : public std::enable_shared_from_this<Serial> {
 public:
  Serial(std::shared_ptr<Data> data, std::function<void()> frame)
      : data_{std::move(data)}, frame_{std::move(frame)} {}

  void connect(const std::string& name, unsigned baud, const Bytes& ids) {
    using boost::asio::serial_port;
    port_.open(name);
    port_.set_option(serial_port::baud_rate(baud));
    port_.set_option(serial_port::flow_control(serial_port::flow_control::none));
    std::this_thread::sleep_for(std::chrono::seconds{1});
    send({kStart});
    Bytes list{kStream, static_cast<std::uint8_t>(ids.size())};
    list.insert(list.end(), ids.begin(), ids.end());
    expected_ = data_->bytes + static_cast<unsigned>(data_->count());
    send(list);
    read_one();
    thread_ = std::thread{[this] { io_.run(); }};
  }
  void disconnect() {
    io_.stop();
    thread_.join();
    send({kStart});
    send({kStop});
    port_.close();
  }
  std::atomic<unsigned> frames{0};
  std::atomic<unsigned> corrupt{0};

 private:
  enum class State { header, count, id, data, checksum };

  void send(const Bytes& bytes) { boost::asio::write(port_, boost::asio::buffer(bytes)); }
  void read_one() {
    boost::asio::async_read(
        port_, boost::asio::buffer(&byte_, 1),
        [self = shared_from_this()](const boost::system::error_code& error, std::size_t size) {
          self->on_byte(error, size);
        });
  }
  void on_byte(const boost::system::error_code& error, std::size_t size) {
    if (error) return;
    if (size == 1) take(byte_);
    read_one();
  }
  void take(std::uint8_t byte) {
    ++read_;
    sum_ = static_cast<std::uint8_t>(sum_ + byte);
    switch (state_) {
      case State::header:
        if (byte != kHeader) return;
        state_ = State::count;
        sum_ = byte;
        return;
      case State::count:
        state_ = byte == expected_ ? State::id : State::header;
        read_ = 0;
        return;
      case State::id:
        id_ = byte;
        state_ = data_->has(id_) ? State::data : State::header;
        if (state_ == State::data) left_ = data_->packet(id_)->bytes;
        value_ = 0;
        return;
      case State::data:
        value_ = static_cast<std::uint16_t>(value_ << 8U | byte);
        if (--left_ != 0) return;
        data_->packet(id_)->keep(value_);
        state_ = read_ >= expected_ ? State::checksum : State::id;
        return;
      case State::checksum:
        state_ = State::header;
        if (sum_ != 0) {
          ++corrupt;
          return;
        }
        ++frames;
        data_->accept_all();
        first_.lock();
        first_.unlock();
        frame_();
    }
  }

  std::shared_ptr<Data> data_;
  std::function<void()> frame_;
  boost::asio::io_service io_{};
  boost::asio::serial_port port_{io_};
  std::thread thread_{};
  std::mutex first_{};
  State state_ = State::header;
  std::uint8_t byte_ = 0, sum_ = 0, id_ = 0;
  std::uint16_t value_ = 0;
  unsigned read_ = 0, expected_ = 0, left_ = 0;
};

// What libcreate does with each frame of a Create of 2006.
class Odometry {
 public:
  explicit Odometry(std::shared_ptr<Data> data) : data_{std::move(data)} {}
  void step() {
    const auto now = std::chrono::system_clock::now();
    const float dt_s = std::chrono::duration<float>(now - before_).count();
    before_ = now;
    if (!data_->has(kDistance) || !data_->has(kAngle)) return;
    const auto signed_value = [this](std::uint8_t id) {
      return static_cast<float>(static_cast<std::int16_t>(data_->packet(id)->value()));
    };
    const float distance_m = signed_value(kDistance) / 1000.0F;
    const float turn = signed_value(kAngle) * std::numbers::pi_v<float> / 180.0F;
    x_ += distance_m * std::cos(yaw_);
    y_ += distance_m * std::sin(yaw_);
    yaw_ = std::remainder(yaw_ + turn, 2.0F * std::numbers::pi_v<float>);
    speed_ = dt_s > 1e-4F ? distance_m / dt_s : 0.0F;
  }

 private:
  std::shared_ptr<Data> data_;
  std::chrono::system_clock::time_point before_ = std::chrono::system_clock::now();
  float x_ = 0, y_ = 0, yaw_ = 0;
  volatile float speed_ = 0;
};

}  // namespace

int main(int count, char** words) {
  if (count < 5) return 2;
  Bytes ids;
  for (int i = 4; i < count; ++i)
    ids.push_back(static_cast<std::uint8_t>(std::strtoul(words[i], nullptr, 10)));
  const auto data = std::make_shared<Data>(ids);
  Odometry odometry{data};
  const auto serial = std::make_shared<Serial>(data, [&odometry] { odometry.step(); });
  serial->connect(words[1], static_cast<unsigned>(std::strtoul(words[2], nullptr, 10)), ids);
  std::this_thread::sleep_for(std::chrono::duration<double>{std::strtod(words[3], nullptr)});
  serial->disconnect();
  std::printf("%u %u\n", serial->frames.load(), serial->corrupt.load());
  return 0;
}
