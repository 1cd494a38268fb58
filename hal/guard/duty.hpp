// Who owes the robot its stop. From the first byte that a program sends until the robot was seen
// standing, or its port is gone for everybody, that is this object and the guard behind it.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "hal/guard/farewell.hpp"
#include "hal/guard/guard.hpp"
#include "hal/result.hpp"
#include "hal/stream/byte_stream.hpp"

namespace cargobay::hal {

// What became of the robot in the end.
struct Discharge {
  Parting parting = Parting::unconfirmed;
  bool by_guard = false;  // the guard said the last word

  bool standing() const { return parting == Parting::standing; }
};

// For the end of a message: "; the robot was stopped by its guard", "; the robot could not be
// reached: it may be moving", or nothing if the program itself left it standing.
std::string fate(const Discharge& discharge);

class Duty {
 public:
  // Before anything is sent. Starts the guard, if the stream has a terminal and one is wanted;
  // `priority` as for Guard::start(). `stream` outlives it. A failure leaves the robot as it was.
  static Result<std::unique_ptr<Duty>> begin(ByteStream& stream, const GuardOptions& options,
                                             int priority);
  // Discharges, if that was not done.
  ~Duty();
  Duty(const Duty&) = delete;
  Duty& operator=(const Duty&) = delete;

  // Null if there is none.
  Guard* guard() { return guard_.get(); }

  // The robot is told to run a demo: to be aborted in the end.
  void expect_demo();

  // Says farewell by the stream, and if the robot does not confirm that, by the guard, who has a
  // descriptor of its own. At most `owed` bytes of a command are missing. Once; from then on
  // nothing may be sent. Blocks for up to 2 s at 57600 baud and 5 s if the guard hangs.
  Discharge discharge(std::size_t owed = 0);
  // The same for a robot that the program cannot reach, or that was told already: by the guard, if
  // `left` is not a robot that stands.
  Discharge discharge_after(Parting left);
  // Nobody needs to say anything: the wheels never turned, or it was asked for that they go on.
  void waive();

 private:
  explicit Duty(ByteStream& stream) : stream_{stream} {}

  ByteStream& stream_;
  std::unique_ptr<Guard> guard_{};
  bool demo_ = false;
  std::optional<Discharge> discharged_{};
};

}  // namespace cargobay::hal
