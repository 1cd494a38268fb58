// An exception that leaves the control function stops the robot, and nothing else happens.
#include <cstdio>
#include <cstring>
#include <stdexcept>

#include "tests/capi/check.h"

namespace {

int throws(void* context, const cargobay_state* state, cargobay_output* output) {
  *static_cast<int*>(context) += 1;
  output->wheels = {200.0, 200.0};
  if (state->tick > 60) throw std::runtime_error{"planted"};
  return 0;
}

}  // namespace

// NOLINTBEGIN(concurrency-mt-unsafe, cppcoreguidelines-pro-type-member-init): as C tests do it
int main() {
  int calls = 0;
  cargobay_sim* const sim = virtual_sim();
  cargobay_robot* const robot = robot_of(sim, 0);
  CHECK(cargobay_set_control(robot, throws, &calls) == CARGOBAY_OK);
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  CHECK_FAILS(run_for(robot, 10.0), CARGOBAY_E_CONTROL, "an exception left");
  CHECK(calls > 60 && calls < 65);
  CHECK_FAILS(cargobay_end(robot), CARGOBAY_E_CONTROL, "an exception left");
  SIZED(cargobay_end_report, end);
  CHECK(cargobay_get_end(robot, &end) == CARGOBAY_OK);
  CHECK(end.ended == 1 && end.code == CARGOBAY_E_CONTROL && end.control_result == 0);
  CHECK(strstr(end.message, "an exception left") != nullptr);
  SIZED(cargobay_truth, truth);
  CHECK(cargobay_sim_get_truth(sim, &truth) == CARGOBAY_OK);
  CHECK(truth.commanded_left_mm_s == 0 && truth.mode == CARGOBAY_MODE_PASSIVE);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}
// NOLINTEND(concurrency-mt-unsafe, cppcoreguidelines-pro-type-member-init)
