// Who owes the robot its stop. From the first byte that a program sends until the robot has been
// seen to stand, or its port is gone for every process, it is this object and its guard.
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
  bool by_guard = false;  // the guard had the last word

  bool standing() const { return parting == Parting::standing; }
};

// For the end of a message: "; the robot was stopped by its guard", "; the robot could not be
// reached: it may be moving", or empty if the program itself left it standing.
std::string fate(const Discharge& discharge);

class Duty {
 public:
  // Call before anything is sent. Starts the guard if the stream has a terminal and a guard is
  // wanted; `priority` as for Guard::start(). `stream` must outlive this. A failure leaves the
  // robot as it was.
  static Result<std::unique_ptr<Duty>> begin(ByteStream& stream, const GuardOptions& options,
                                             int priority);
  // Discharges if that has not been done.
  ~Duty();
  Duty(const Duty&) = delete;
  Duty& operator=(const Duty&) = delete;

  // Null if there is none.
  Guard* guard() { return guard_.get(); }

  // The robot is being told to run a demo, which must be aborted in the end.
  void expect_demo();

  // Says farewell over the stream, and if the robot does not confirm, through the guard, which has
  // a descriptor of its own. At most `owed` bytes of a command are missing. Call once; after it,
  // send nothing. Blocks for up to 2 s at 57600 baud, and 5 s if the guard hangs.
  Discharge discharge(std::size_t owed = 0);
  // The same for a robot that the program cannot reach, or has already told: through the guard,
  // unless `left` says that the robot is standing.
  Discharge discharge_after(Parting left);
  // There is nothing to say: the wheels never turned, or the user asked for them to keep turning.
  void waive();

 private:
  explicit Duty(ByteStream& stream) : stream_{stream} {}

  ByteStream& stream_;
  std::unique_ptr<Guard> guard_{};
  bool demo_ = false;
  std::optional<Discharge> discharged_{};
};

}  // namespace cargobay::hal
