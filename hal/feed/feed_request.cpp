#include "hal/feed/feed_request.hpp"

#include <cmath>

#include <nlohmann/json.hpp>

namespace cargobay::hal {

namespace {

using Json = nlohmann::json;
using namespace feed_request;  // NOLINT(google-build-using-namespace): the rows of the table below

constexpr std::size_t kLongestName = 64;
constexpr std::uint32_t kMostRare = 1000;  // one in so many, about one in 15 s

// What is missing or wrong is noted; the first time counts.
class Members {
 public:
  explicit Members(const Json& object) : object_{object} {}

  double number(const char* key) {
    const auto found = object_.find(key);
    if (found != object_.end() && found->is_number()) {
      const double value = found->get<double>();
      if (std::isfinite(value)) return value;
    }
    wrong(key, "a number");
    return 0.0;
  }
  std::string text(const char* key, std::size_t longest) {
    const auto found = object_.find(key);
    if (found != object_.end() && found->is_string()) {
      auto value = found->get<std::string>();
      if (!value.empty() && value.size() <= longest) return value;
    }
    wrong(key, "a text of 1 to " + std::to_string(longest) + " bytes");
    return {};
  }
  bool truth(const char* key) {
    const auto found = object_.find(key);
    if (found == object_.end()) return false;
    if (found->is_boolean()) return found->get<bool>();
    wrong(key, "true or false");
    return false;
  }
  bool has(const char* key) const { return object_.contains(key); }
  const Json& at(const char* key) const { return object_.at(key); }
  void wrong(const char* key, const std::string& wanted) {
    if (error_.empty()) error_ = "`" + std::string{key} + "` must be " + wanted;
  }
  const std::string& error() const { return error_; }

 private:
  const Json& object_;
  std::string error_{};
};

FeedRequest::What subscribe(Members& members) {
  Subscribe wanted;
  if (members.has("types")) {
    const Json& types = members.at("types");
    // News come in any case: a reader that does not know them would show what is not so.
    wanted.choice.types.reset();
    for (const FeedType type : {FeedType::hello, FeedType::status, FeedType::event,
                                FeedType::holder, FeedType::missed, FeedType::answer})
      wanted.choice.types.set(static_cast<std::size_t>(type));
    if (!types.is_array()) members.wrong("types", "a list of types of messages");
    for (const Json& each : types) {
      const auto type =
          each.is_string() ? feed_type(each.get_ref<const std::string&>()) : std::nullopt;
      if (type) {
        wanted.choice.types.set(static_cast<std::size_t>(*type));
      } else {
        members.wrong("types", "a list of types of messages, such as [\"state\",\"truth\"]");
      }
    }
  }
  if (members.has("every")) {
    const double every = members.number("every");
    if (every >= 1 && every <= kMostRare) {
      wanted.choice.every = static_cast<std::uint32_t>(every);
    } else {
      members.wrong("every", "a number from 1 to " + std::to_string(kMostRare));
    }
  }
  return wanted;
}

FeedRequest::What drive(Members& members) {
  if (members.has("left_mm_s") || members.has("right_mm_s"))
    return DriveWheels{
        {.left_mm_s = members.number("left_mm_s"), .right_mm_s = members.number("right_mm_s")}};
  return DriveTwist{{.velocity_mm_s = members.number("velocity_mm_s"),
                     .turn_rate_rad_s = members.number("turn_rate_rad_s")}};
}

// Terminals show it: nothing in it may be a control character. JSON is UTF-8, in which those beyond
// ASCII are C2 80 to C2 9F.
bool shows_as_it_is(std::string_view name) {
  char before = '\0';
  for (const char byte : name) {
    const auto code = static_cast<unsigned char>(byte);
    if (code < 0x20 || code == 0x7F || (before == '\xC2' && code < 0xA0)) return false;
    before = byte;
  }
  return true;
}

FeedRequest::What hold(Members& members) {
  Hold wanted{.name = members.text("name", kLongestName), .take = members.truth("take")};
  if (!shows_as_it_is(wanted.name)) members.wrong("name", "without control characters");
  return wanted;
}

struct Row {
  const char* name;
  FeedRequest::What (*read)(Members& members);
};
constexpr Row kRequests[] = {
    {"subscribe", subscribe},
    {"hold", hold},
    {"release", [](Members&) { return FeedRequest::What{Release{}}; }},
    {"drive", drive},
    {"stop", [](Members&) { return FeedRequest::What{Stop{}}; }},
    {"rearm", [](Members&) { return FeedRequest::What{Rearm{}}; }},
    {"reset_odometry",
     [](Members& members) {
       return FeedRequest::What{ResetOdometry{{.x_mm = members.number("x_mm"),
                                               .y_mm = members.number("y_mm"),
                                               .heading_rad = members.number("heading_rad")}}};
     }},
    {"send",
     [](Members& members) {
       return FeedRequest::What{
           Send{.command = members.text("command", FeedConnection::kLongestLine)}};
     }},
    {"control",
     [](Members& members) {
       return FeedRequest::What{
           Control{.line = members.text("line", FeedConnection::kLongestLine)}};
     }},
};

std::string known_requests() {
  std::string names;
  for (const Row& row : kRequests) (names += names.empty() ? "" : ", ") += row.name;
  return names;
}

}  // namespace

Result<FeedRequest::What> parse_request(std::string_view line, std::string& id) {
  const Json object = Json::parse(line, nullptr, false);
  if (!object.is_object()) return Failure{.message = "not a JSON object on one line"};
  if (const auto found = object.find("id"); found != object.end()) {
    if (!found->is_number() && !found->is_string())
      return Failure{.message = "`id` must be a number or a text"};
    id = found->dump(-1, ' ', false, Json::error_handler_t::replace);
  }
  Members members{object};
  const std::string wanted = members.text("do", kLongestName);
  if (!members.error().empty()) return Failure{.message = members.error()};
  for (const Row& row : kRequests) {
    if (wanted != row.name) continue;
    FeedRequest::What what = row.read(members);
    if (!members.error().empty()) return Failure{.message = members.error()};
    return what;
  }
  return Failure{.message = "`" + wanted + "` is not a request; there are " + known_requests()};
}

}  // namespace cargobay::hal
