// The process's place in the order in which the kernel kills when memory runs out.
#pragma once

namespace cargobay::hal {

// Makes this process at least as eligible as `least`, -1000 (never killed) to 1000; its children
// start with that. Nothing happens if it already is, or if there is no /proc. A child may go back
// as low as the process was put with the right to (proc_pid_oom_score_adj(5)): that is how a guard
// outlives the service that started it. Does not wait.
void raise_oom_score(int least);

}  // namespace cargobay::hal
