#include "hal/web/program/options.hpp"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string_view>
#include <utility>

#include <CLI/CLI.hpp>

#include "hal/web/program/token_file.hpp"
#include "hal/web/token.hpp"

namespace cargobay::web {
namespace {

// A token in the arguments can be read by each user of the machine for as long as it is there.
void hide(std::span<char* const> arguments, const std::string& secret) {
  for (char* const argument : arguments) {
    if (char* const found = std::strstr(argument, secret.c_str()))
      std::memset(found, 'x', secret.size());
  }
}

std::vector<std::string> lower(std::vector<std::string> texts) {
  for (std::string& text : texts) {
    std::ranges::transform(text, text.begin(),
                           [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  }
  return texts;
}

void describe(CLI::App& app, Options& options, std::string& address) {
  app.set_version_flag("--version", "cargobay-web " CARGOBAY_VERSION);
  app.add_option(
         "--feed", options.feed,
         "Port whose feed to show, or the socket of a feed. By itself the only one there is")
      ->type_name("PORT");
  app.add_option("--http", address,
                 "Where to listen: PORT, ADDRESS:PORT or [IPV6]:PORT; 0 is any free port. Beyond "
                 "the loopback a token is required")
      ->type_name("ADDRESS")
      ->capture_default_str();
  app.add_option("--token", options.token,
                 "What clients have to know, at least 8 letters or digits. Better in the variable "
                 "CARGOBAY_TOKEN, which other users cannot read. Beyond the loopback one is made "
                 "if none is given")
      ->type_name("TOKEN");
  app.add_option("--token-file", options.token_file,
                 "The token is in this file, for whoever may read it; made there if it is missing, "
                 "for the file's group")
      ->type_name("FILE")
      ->excludes("--token");
  app.add_option("--cert", options.certificate,
                 "PEM file with certificate and key: encrypts (https, wss)")
      ->type_name("PEM");
  app.add_option("--name", options.names,
                 "A name under which this server is reached, beside its addresses and the "
                 "machine's own name")
      ->type_name("NAME");
  app.add_option("--origin", options.origins,
                 "A page of another server that may connect, as https://app.foxglove.dev")
      ->type_name("ORIGIN");
  app.add_option(
         "--ready-fd", options.ready,
         "Descriptor for the line `serving URL`, instead of standard output; for a program that "
         "starts this one, which ends with it")
      ->type_name("N");
}

hal::Result<Options> checked(Options options, const std::string& address) {
  auto parsed = parse_listen_address(address);
  if (!parsed) return parsed.failure();
  options.address = *parsed;
  if (!options.token.empty() && !is_token(options.token))
    return hal::Failure{.message =
                            "the token has 8 to 128 letters, digits, or any of - _ . ~; leave it "
                            "out, and one is made"};
  options.names = lower(std::move(options.names));
  options.origins = lower(std::move(options.origins));
  return options;
}

}  // namespace

hal::Result<Options> parse_options(std::span<char* const> arguments) {
  CLI::App app{
      "Shows a robot in the browser and to Foxglove, and lets them steer it: HTTP and WebSockets "
      "in "
      "front of the feed that `cargobay serve` publishes, which also starts it.",
      "cargobay-web"};
  Options options;
  std::string address = "127.0.0.1:8080";
  describe(app, options, address);
  try {
    app.parse(static_cast<int>(arguments.size()), arguments.data());
  } catch (const CLI::Success& asked) {
    (void)app.exit(asked);  // prints it
    options.is_over = true;
    return options;
  } catch (const CLI::Error& error) {
    return hal::Failure{.message = std::string{error.what()} + "; see cargobay-web --help"};
  }
  if (!options.token_file.empty()) {
    auto token = token_in(options.token_file);
    if (!token) return token.failure();
    options.token = std::move(*token);
  } else if (!options.token.empty()) {
    hide(arguments, options.token);
    // NOLINTNEXTLINE(concurrency-mt-unsafe): no thread has been started
  } else if (const char* const token = std::getenv("CARGOBAY_TOKEN")) {
    options.token = token;
  }
  return checked(std::move(options), address);
}

}  // namespace cargobay::web
