#include "hal/machine/masked_thread.hpp"

#include <csignal>
#include <utility>

namespace cargobay::hal {

std::error_code start_masked(std::thread& thread, std::function<void()> body) {
  sigset_t all{};
  sigset_t before{};
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  std::error_code error;
  try {
    thread = std::thread{std::move(body)};
  } catch (const std::system_error& refused) {  // the only way std::thread reports it
    error = refused.code();
  }
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  return error;
}

}  // namespace cargobay::hal
