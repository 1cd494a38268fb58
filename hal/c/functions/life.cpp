// The loop of a robot: start, end, and why it ended; its control function; its recording.
#include <algorithm>
#include <string>

#include "hal/c/cargobay.h"
#include "hal/c/errors.hpp"
#include "hal/c/robot_object.hpp"
#include "hal/c/sized.hpp"
#include "hal/c/text.hpp"
#include "hal/file/output_file.hpp"
#include "hal/file/port_descriptor.hpp"
#include "hal/recording/recording_file.hpp"

namespace cargobay::c {
namespace {

int subscribe_again(RobotObject& object, Session& session) {
  const std::lock_guard lock{object.subscribing};
  hal::Request request;
  request.kind = hal::Request::Kind::stream;
  request.extras = lists_with(object.subscriptions);
  return request.extras.any() ? session.request(request) : static_cast<int>(CARGOBAY_OK);
}

int start(RobotObject& object) {
  const hal::StandardNumbersTaken taken;
  bool again = true;
  {
    const SessionUse session{object};
    if (session) {
      const Session::Life life = session->life.load();
      if (life == Session::Life::running && !session->robot->ended())
        return fail(CARGOBAY_E_STATE, "the loop runs already; end it first: cargobay_end()");
      again = life != Session::Life::open;
      if (again) session->end();
      if (session->robot->lost()) {
        return fail(CARGOBAY_E_STALLED,
                    "the control function has still not returned, and its loop holds the port: end "
                    "the program");
      }
    }
  }
  if (again) {
    if (const int failed = object.open_session(); failed != CARGOBAY_OK) return failed;
  }
  const SessionUse session{object};
  if (const int failed = subscribe_again(object, *session); failed != CARGOBAY_OK) return failed;
  return session->start();
}

int end(RobotObject& object) {
  const SessionUse session{object};
  if (!session) return no_session();
  if (const int early = session->must_be_started(); early != CARGOBAY_OK) return early;
  session->end();
  return session->outcome();
}

cargobay_end_report end_of(Session& session, const hal::Robot::Farewell& farewell) {
  const EndWords words = words_of(session, farewell);
  cargobay_end_report known{};
  known.ended = 1;
  known.code = words.code;
  known.control_result = session.control_result.load();
  known.hazards = farewell.causes.raw();
  known.passive_seen =
      session.life.load() == Session::Life::stopped && farewell.robot.standing() ? 1 : 0;
  known.guard_lost = farewell.end == hal::CycleEnd::guard_lost ? 1 : 0;
  (void)copy_text(words.message, std::begin(known.message), sizeof known.message);
  return known;
}

int save_recording(Session& session, const char* path) {
  auto output = hal::OutputFile::open(path);
  if (!output) return fail(CARGOBAY_E_FILE, output.failure());
  hal::RecordingHeader header = session.robot->recording_header();
  header.software = "libcargobay " CARGOBAY_VERSION;
  auto file = hal::RecordingFile::begin(std::move(*output), header);
  if (!file) return fail(CARGOBAY_E_FILE, file.failure());
  file->append(session.robot->flight_recorder());
  if (file->written()) file->publish();
  if (!file->written()) return fail(CARGOBAY_E_FILE, file->written().failure());
  return CARGOBAY_OK;
}

// Runs `function` on the robot for the thread that currently owns it.
template <typename Function>
int owned(cargobay_robot* robot, const char* name, const Function& function) {
  if (in_control()) return not_from_control(name);
  return guarded([&] {
    const RobotUse use = robots().use(robot);
    if (!use) return bad_robot(robot);
    const std::unique_lock lock{use->owner(), std::try_to_lock};
    if (!lock) {
      return fail(CARGOBAY_E_THREAD,
                  "another thread is in a function that belongs to this robot's owner; let one "
                  "thread own it");
    }
    return function(*use);
  });
}

}  // namespace
}  // namespace cargobay::c

using namespace cargobay::c;  // NOLINT(google-build-using-namespace): what C sees stands below

extern "C" {

int cargobay_set_control(struct cargobay_robot* robot, cargobay_control control, void* context) {
  return owned(robot, "cargobay_set_control",
               [&](RobotObject& object) { return object.set_control(control, context); });
}

int cargobay_start(struct cargobay_robot* robot) {
  return owned(robot, "cargobay_start", [](RobotObject& object) { return start(object); });
}

int cargobay_end(struct cargobay_robot* robot) {
  return owned(robot, "cargobay_end", [](RobotObject& object) { return end(object); });
}

int cargobay_request_end(struct cargobay_robot* robot) {
  const RobotUse use = robots().use(robot);
  if (!use) return CARGOBAY_E_HANDLE;  // a message is not for signal handlers
  const SessionUse session{*use};
  if (session) session.cycle().request_stop();
  return CARGOBAY_OK;
}

int cargobay_get_end(struct cargobay_robot* robot, struct cargobay_end_report* end) {
  return guarded([&] {
    const RobotUse use = robots().use(robot);
    if (!use) return bad_robot(robot);
    const SessionUse session{*use};
    cargobay_end_report known{};
    if (session) {
      if (const auto farewell = session->farewell()) known = end_of(*session, *farewell);
    }
    return give(known, end) ? static_cast<int>(CARGOBAY_OK) : bad_argument(kBadOut);
  });
}

int cargobay_save_recording(struct cargobay_robot* robot, const char* path) {
  if (path == nullptr) return bad_argument("`path` is NULL: name the file to write");
  if (in_control()) return not_from_control("cargobay_save_recording");
  return guarded([&] {
    const RobotUse use = robots().use(robot);
    if (!use) return bad_robot(robot);
    const SessionUse session{*use};
    if (!session) return no_session();
    if (const int early = session->must_be_started(); early != CARGOBAY_OK) return early;
    return save_recording(*session, path);
  });
}

}  // extern "C"
