// test_conformance                        asks the virtual Create, in virtual time
// test_conformance --pty                  asks it over a pseudo-terminal, in real time
// test_conformance --port PATH [--baud N] asks any device: stand clear of a real robot, its wheels
//                                         turn, slowly and for moments
// --rows                                  says which statements of the manual were judged, and how
#include <charconv>
#include <cstdio>
#include <cstring>
#include <string_view>

#include <gtest/gtest.h>

#include "hal/port/pty_transport.hpp"
#include "hal/sim/line/server.hpp"
#include "tests/conformance/rows.hpp"
#include "tests/conformance/subject.hpp"

namespace {

using namespace cargobay;  // NOLINT(google-build-using-namespace): one program

bool open_port(const std::string& path) {
  auto opened = hal::open_pty(path, conformance::boot_baud);
  if (!opened) {
    std::fprintf(stderr, "%s\n", opened.failure().message.c_str());
    return false;
  }
  conformance::port = std::move(*opened);
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  std::unique_ptr<hal::sim::Server> server;
  std::string path;
  bool each_row = false;
  for (int i = 1; i < argc; ++i) {
    const std::string_view option = argv[i];
    const std::string_view value = i + 1 < argc ? argv[i + 1] : "";
    if (option == "--pty") {
      auto opened = hal::sim::Server::open({}, {});
      if (!opened || (*opened)->start()) return 1;
      server = std::move(*opened);
      path = server->path();
    } else if (option == "--port" && !value.empty()) {
      path = value;
      ++i;
    } else if (option == "--baud" &&
               std::from_chars(value.data(), value.data() + value.size(), conformance::boot_baud)
                       .ec == std::errc{}) {
      ++i;
    } else if (option == "--rows") {
      each_row = true;
    } else {
      std::fprintf(stderr, "usage: %s [--pty | --port PATH] [--baud N] [--rows]\n", argv[0]);
      return 2;
    }
  }
  if (!path.empty() && !open_port(path)) return 1;
  const int result = RUN_ALL_TESTS();
  conformance::port.reset();
  if (each_row || !path.empty()) {
    conformance::print_rows(
        conformance::read_rows(CARGOBAY_SOURCE_DIR "/tests/conformance/statements.toml"), each_row);
  }
  return result;
}
