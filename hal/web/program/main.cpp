// The program cargobay-web.

#include <sys/prctl.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <span>
#include <string>

#include "hal/file/descriptor.hpp"
#include "hal/machine/oom_score.hpp"
#include "hal/web/program/options.hpp"
#include "hal/web/program/qr_code.hpp"
#include "hal/web/server/server.hpp"
#include "hal/web/token.hpp"

namespace {

namespace hal = cargobay::hal;
namespace web = cargobay::web;

constexpr int kUsageError = 2;

int fail(const std::string& message, int code = EXIT_FAILURE) {
  (void)std::fprintf(stderr, "cargobay-web: %s\n", message.c_str());
  return code;
}

// Readable when the process is to end.
hal::Descriptor ends() {
  sigset_t signals{};
  sigemptyset(&signals);
  for (const int signal : {SIGTERM, SIGINT, SIGHUP}) sigaddset(&signals, signal);
  (void)pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  return hal::Descriptor{signalfd(-1, &signals, SFD_CLOEXEC | SFD_NONBLOCK)};
}

hal::Result<web::Server::Options> server_options(const web::Options& options) {
  web::Gate::Policy policy{.address = options.address,
                           .is_encrypted = !options.certificate.empty(),
                           .token = options.token,
                           .names = options.names,
                           .origins = options.origins};
  if (!web::is_loopback(options.address.host)) {
    // On the loopback alone a name could be that of another machine, spoken into mDNS.
    for (std::string& name : web::names_of_this_machine()) policy.names.push_back(std::move(name));
    if (policy.token.empty()) {
      auto token = web::make_token();
      if (!token) return hal::Failure{.message = "the kernel gives no random numbers for a token"};
      policy.token = std::move(*token);
    }
  }
  return web::Server::Options{
      .policy = std::move(policy), .feed = options.feed, .certificate = options.certificate};
}

// The line is for programs, the rest for people.
bool announce(const web::Server& server, int ready) {
  const auto& policy = server.gate().policy();
  const std::string link =
      server.url() + (policy.token.empty() ? "/" : "/login#token=" + policy.token);
  if (!web::is_loopback(policy.address.host)) {
    if (!policy.is_encrypted)
      (void)std::fprintf(stderr,
                         "cargobay-web: not encrypted: whoever can listen on this network sees the "
                         "token and can steer; use --cert, or a tunnel\n");
    if (isatty(STDERR_FILENO) != 0) (void)std::fprintf(stderr, "%s", web::qr_code(link).c_str());
  }
  const std::string line = "serving " + link + "\n";
  const int descriptor = ready < 0 ? STDOUT_FILENO : ready;
  const bool told =
      write(descriptor, line.data(), line.size()) == static_cast<ssize_t>(line.size());
  if (ready > STDERR_FILENO) close(ready);
  return told;
}

}  // namespace

int main(int count, char** arguments) {
  const auto options = web::parse_options({arguments, static_cast<std::size_t>(count)});
  if (!options) return fail(options.failure().message, kUsageError);
  if (options->is_over) return EXIT_SUCCESS;
  // Who starts this with a descriptor is a program, and does not want it to outlive that.
  if (options->ready >= 0) {
    (void)prctl(PR_SET_PDEATHSIG, SIGTERM);
    hal::raise_oom_score(0);  // killed before who drives the robot, and before the guard
  }
  (void)std::signal(SIGPIPE, SIG_IGN);
  const hal::Descriptor stop = ends();
  auto wanted = server_options(*options);
  if (!wanted) return fail(wanted.failure().message);
  const auto server = web::Server::open(std::move(*wanted));
  if (!server) return fail(server.failure().message);
  if (!announce(**server, options->ready)) return fail("cannot say where it serves");
  if (const auto served = (*server)->run(stop.number()); !served)
    return fail(served.failure().message);
  return EXIT_SUCCESS;
}
