#include "hal/machine/oom_score.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <functional>

#include <gtest/gtest.h>

namespace cargobay::hal {
namespace {

int own_score() {
  int score = 9999;
  std::ifstream{"/proc/self/oom_score_adj"} >> score;
  return score;
}

void set_score(int score) { std::ofstream{"/proc/self/oom_score_adj"} << score << std::flush; }

// In a process of its own.
int in_a_child(const std::function<int()>& body) {
  const pid_t child = fork();
  if (child == 0) _exit(body());
  int status = 0;
  EXPECT_EQ(waitpid(child, &status, 0), child);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST(OomScore, IsRaisedAndNeverLowered) {
  const int before = own_score();
  ASSERT_LE(before, 500);
  const int code = in_a_child([] {
    raise_oom_score(500);
    if (own_score() != 500) return 1;
    raise_oom_score(-900);
    return own_score() == 500 ? 0 : 2;
  });
  EXPECT_EQ(code, 0);
  EXPECT_EQ(own_score(), before) << "the child's alone";
}

TEST(OomScore, AChildWithoutRightsGoesBackToWhereItsParentWasPut) {
  if (geteuid() != 0) GTEST_SKIP() << "needs root: only that may lower a score";
  const int code = in_a_child([] {
    set_score(-1000);
    if (own_score() != -1000) return 77;  // a container's root may not
    if (setgid(65534) != 0 || setuid(65534) != 0) return 1;
    raise_oom_score(-900);
    if (own_score() != -900) return 2;
    return in_a_child([] {
      if (own_score() != -900) return 3;
      set_score(-1000);
      return own_score() == -1000 ? 0 : 4;
    });
  });
  if (code == 77) GTEST_SKIP() << "may not lower a score: CAP_SYS_RESOURCE is missing";
  EXPECT_EQ(code, 0);
}

}  // namespace
}  // namespace cargobay::hal
