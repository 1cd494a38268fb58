#include "hal/web/foxglove/steering.hpp"

#include <charconv>
#include <utility>

#include <nlohmann/json.hpp>

namespace cargobay::web {

bool Steering::send(std::string members, Done done) {
  if (unanswered_.size() >= kMostUnanswered) return false;
  const std::uint64_t id = next_id_++;
  unanswered_.emplace(id, std::move(done));
  request_("{\"id\":" + std::to_string(id) + "," + std::move(members) + "}");
  return true;
}

bool Steering::ask(std::string_view what, Done done) {
  return send("\"do\":" + nlohmann::json(what).dump(), std::move(done));
}

bool Steering::drive(const Velocity& velocity, std::function<void(const std::string&)> refused) {
  const rt::TimePoint now = now_();
  const bool goes_on = heard_ && now - *heard_ < kLetGo;
  heard_ = now;
  must_let_go_ = must_let_go_ && goes_on;
  if (must_let_go_) return true;
  wanted_ = velocity;
  refused_ = std::move(refused);
  if (asks_for_lease_) return true;  // the newest is sent when it is there
  if (holds_) {
    send_velocity();
    return true;
  }
  asks_for_lease_ = true;
  const nlohmann::json name(name_);
  const std::string take = takes_ ? R"(,"take":true)" : "";
  const bool sent =
      send(R"("do":"hold","name":)" +
               name.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace) + take,
           [this](const hal::heard::Answer& answer) {
             asks_for_lease_ = false;
             holds_ = answer.ok;
             lease_ = answer.lease;
             if (holds_) {
               send_velocity();
             } else {
               refuse(answer.error);
             }
           });
  if (!sent) asks_for_lease_ = false;
  return sent;
}

void Steering::send_velocity() {
  if (!wanted_) return;
  const Velocity velocity = *std::exchange(wanted_, std::nullopt);
  const std::string members =
      R"("do":"drive","velocity_mm_s":)" + nlohmann::json(velocity.linear_m_s * 1e3).dump() +
      R"(,"turn_rate_rad_s":)" + nlohmann::json(velocity.angular_rad_s).dump();
  (void)send(members, [this](const hal::heard::Answer& answer) {
    if (!answer.ok && holds_) refuse(answer.error);
  });
}

void Steering::refuse(const std::string& why) {
  holds_ = false;
  must_let_go_ = true;
  wanted_.reset();
  refused_(why);
}

void Steering::release() {
  wanted_.reset();
  if (!holds_ && !asks_for_lease_) return;
  holds_ = false;
  (void)ask("release", [](const hal::heard::Answer& /*answer*/) {});
}

void Steering::answered(const hal::heard::Answer& answer) {
  std::uint64_t id = 0;  // of which there is none
  (void)std::from_chars(answer.id.data(), answer.id.data() + answer.id.size(), id);
  const auto found = unanswered_.find(id);
  if (found == unanswered_.end()) return;
  const Done done = std::move(found->second);
  unanswered_.erase(found);
  done(answer);
}

void Steering::held_by(const hal::heard::Holder& holder) {
  if (!holds_ || holder.lease == lease_) return;
  if (!holder.name) return refuse("somebody has stopped the robot, or the lease was given back");
  refuse((*holder.name == name_ ? "another " : "") + *holder.name + " steers now");
}

}  // namespace cargobay::web
