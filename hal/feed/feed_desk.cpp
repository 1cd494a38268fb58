#include "hal/feed/feed_desk.hpp"

#include "hal/cycle/request.hpp"
#include "hal/json_object.hpp"
#include "oi/limits.hpp"

namespace cargobay::hal {

namespace {

using namespace feed_request;  // NOLINT(google-build-using-namespace): the kinds of a request

constexpr const char* kNotSteerable =
    "this process drives by itself, and can only be watched; `cargobay serve` can be steered";
constexpr const char* kNotVirtual = "only a virtual Create can be arranged; this is a robot";

Result<std::string> done(const Result<void>& result) {
  if (!result) return result.failure();
  return std::string{};
}

std::string answer(const std::string& id, const Result<std::string>& result) {
  JsonObject object;
  object.text("type", name(FeedType::answer)).raw("id", id).truth("ok", static_cast<bool>(result));
  if (!result) {
    object.text("error", result.failure().message);
  } else if (!result->empty()) {
    object.raw("result", *result);
  }
  return object.take();
}

}  // namespace

std::optional<std::string> FeedDesk::hear(FeedConnection& client, std::string_view line,
                                          rt::TimePoint now) {
  std::string id;
  const Result<FeedRequest::What> what = parse_request(line, id);
  lease_.renew(client.number(), now);
  const Result<std::string> result =
      what ? act(client, *what, now) : Result<std::string>{what.failure()};
  if (!id.empty()) return answer(id, result);
  // A reader that wanted no answer is told at least that it was not understood.
  if (result) return std::nullopt;
  return answer("null", result);
}

Result<std::string> FeedDesk::act(FeedConnection& client, const FeedRequest::What& what,
                                  rt::TimePoint now) {
  if (const auto* const subscribe = std::get_if<Subscribe>(&what)) {
    client.choose(subscribe->choice);
    return std::string{};
  }
  if (const auto* const wanted = std::get_if<Control>(&what)) return control(wanted->line);
  if (!steering_.drive) return Failure{.message = kNotSteerable};
  if (std::holds_alternative<Stop>(what)) {
    (void)lease_.revoke();
    stop();
    return std::string{};
  }
  if (const auto* const wanted = std::get_if<Hold>(&what)) return hold(client, *wanted, now);
  if (!lease_.holds(client.number())) {
    const auto holder = lease_.name();
    return Failure{.message = holder ? *holder +
                                           " steers; ask for the lease with `take` to take "
                                           "it from them"
                                     : "ask for the lease first, with `hold`"};
  }
  if (std::holds_alternative<Release>(what)) {
    leave(client.number());
    return std::string{};
  }
  if (const auto* const wheels = std::get_if<DriveWheels>(&what)) return drive(wheels->speeds);
  if (const auto* const wanted = std::get_if<DriveTwist>(&what))
    return drive(rt::wheels_for(wanted->twist, wheel_base_mm_, oi::kMaxWheelSpeed));
  if (const auto* const reset = std::get_if<ResetOdometry>(&what)) {
    if (!is_possible(reset->pose)) return Failure{.message = kPossiblePoses};
    return done(steering_.reset_odometry(reset->pose));
  }
  if (const auto* const command = std::get_if<Send>(&what))
    return done(steering_.send(command->command));
  return done(steering_.rearm());
}

Result<std::string> FeedDesk::hold(const FeedConnection& client, const Hold& wanted,
                                   rt::TimePoint now) {
  const bool had = lease_.holds(client.number());
  if (!lease_.hold(client.number(), wanted.name, wanted.take, now)) {
    return Failure{.message =
                       *lease_.name() + " steers; ask again with `take` to take it from them"};
  }
  if (!had) stop();  // what the former holder wanted is not what this one wants
  return JsonObject{}.number("lease", lease_.number()).take();
}

Result<std::string> FeedDesk::drive(const rt::WheelSpeeds& speeds) {
  constexpr double kMost = oi::kMaxWheelSpeed;
  const auto possible = [](double speed) { return speed >= -kMost && speed <= kMost; };
  if (!possible(speeds.left_mm_s) || !possible(speeds.right_mm_s))
    return Failure{.message = "a wheel's speed must be from -500 to 500 mm/s"};
  return done(steering_.drive(speeds));
}

Result<std::string> FeedDesk::control(const std::string& line) {
  if (!steering_.control) return Failure{.message = kNotVirtual};
  constexpr std::string_view kError = "error: ";
  const std::string answer = steering_.control(line);
  if (answer.starts_with(kError)) return Failure{.message = answer.substr(kError.size())};
  if (answer.starts_with('{') || answer.starts_with('[')) return answer;
  return json_text(answer);
}

void FeedDesk::leave(Lease::Client client) {
  if (lease_.release(client)) stop();
}

void FeedDesk::revoke() {
  if (lease_.revoke()) stop();
}

void FeedDesk::expire(rt::TimePoint now) {
  if (lease_.expire(now)) stop();
}

void FeedDesk::stop() {
  if (steering_.stop) steering_.stop();
}

}  // namespace cargobay::hal
