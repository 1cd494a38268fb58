// Who steers: one at a time, by name, for as long as they show that they are still there.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "rt/clock.hpp"

namespace cargobay::hal {

// One thread; allocates for names.
class Lease {
 public:
  using Client = std::uint64_t;  // a number of its own for each connection, from 1 on

  explicit Lease(rt::Duration length) : length_{length} {}

  // From `client`, which may be the holder already. False if another one has it and is not to be
  // deprived of it.
  bool hold(Client client, const std::string& name, bool take, rt::TimePoint now) {
    if (holder_ && holder_->client != client && !take) return false;
    if (!holds(client) || holder_->name != name) ++last_number_;
    holder_ = Holder{.client = client, .name = name, .until = now + length_};
    return true;
  }
  // Any request of the holder shows that it is there.
  void renew(Client client, rt::TimePoint now) {
    if (holds(client)) holder_->until = now + length_;
  }
  // True if it had it.
  bool release(Client client) {
    if (!holds(client)) return false;
    holder_.reset();
    return true;
  }
  // True if there was a holder.
  bool revoke() {
    const bool had = holder_.has_value();
    holder_.reset();
    return had;
  }
  // True if the time of the holder was up.
  bool expire(rt::TimePoint now) {
    if (!holder_ || now < holder_->until) return false;
    holder_.reset();
    return true;
  }

  bool holds(Client client) const { return holder_ && holder_->client == client; }
  std::optional<std::string> name() const {
    return holder_ ? std::optional{holder_->name} : std::nullopt;
  }
  // Goes up with each lease, also one of the same client under another name; 0: nobody has it. It
  // tells holders of one name apart.
  std::uint64_t number() const { return holder_ ? last_number_ : 0; }
  // When to call expire(); nothing without a holder.
  std::optional<rt::TimePoint> until() const {
    return holder_ ? std::optional{holder_->until} : std::nullopt;
  }

 private:
  struct Holder {
    Client client = 0;
    std::string name{};
    rt::TimePoint until{};
  };
  rt::Duration length_;
  std::optional<Holder> holder_{};
  std::uint64_t last_number_ = 0;
};

}  // namespace cargobay::hal
