#include "hal/bring_up/text_source.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

namespace cargobay::hal {
namespace {

struct Known {
  std::string_view pattern;  // '#': a digit; '^' first: at the beginning of the line
  TextSource source;
};

// The robot's: its own, and those of its relatives, which share the firmware (docs/protocol.md).
// Not "OK": that is a modem's.
constexpr std::array kKnown{
    Known{"bat:  ", TextSource::robot},
    Known{"  sec #", TextSource::robot},
    Known{"  mV #", TextSource::robot},
    Known{"  mA #", TextSource::robot},
    Known{"  mA -#", TextSource::robot},
    Known{"deg-C ", TextSource::robot},
    Known{"key-wakeup", TextSource::robot},
    Known{"processor-sleep", TextSource::robot},
    Known{"bl-start", TextSource::robot},
    Known{" by iRobot!", TextSource::robot},
    Known{"MC9S12E", TextSource::robot},
    Known{"battery-current-", TextSource::robot},
    Known{"20##-##-##-####-L", TextSource::robot},
    Known{"do-charging", TextSource::robot},
    Known{"^slept for ", TextSource::robot},
    Known{"^Slept for ", TextSource::robot},
    Known{"ogin: ", TextSource::login_prompt},
    Known{"ogin incorrect", TextSource::login_prompt},
    Known{"assword: ", TextSource::login_prompt},
    Known{"Debian GNU/Linux", TextSource::login_prompt},
    Known{"Raspbian GNU/Linux", TextSource::login_prompt},
    Known{"LTS tty", TextSource::login_prompt},
    Known{"ommand not found", TextSource::shell},
    Known{"#.######] ", TextSource::kernel},
    Known{"^[  OK  ] ", TextSource::kernel},
    Known{"^[FAILED] ", TextSource::kernel},
    Known{"^Linux version ", TextSource::kernel},
    Known{"^Uncompressing Linux", TextSource::boot_loader},
    Known{"^Starting kernel", TextSource::boot_loader},
    Known{"^U-Boot ", TextSource::boot_loader},
    Known{"^Hit any key to stop autoboot", TextSource::boot_loader},
    Known{"^RPi: BOOTLOADER", TextSource::boot_loader},
    Known{"^MESS:##:##:##.", TextSource::boot_loader},
    Known{"^RING", TextSource::modem},
    Known{"^NO CARRIER", TextSource::modem},
    Known{"^+CREG: ", TextSource::modem},
    Known{"^+CME ERROR", TextSource::modem},
};

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_capital(char c) { return c >= 'A' && c <= 'Z'; }
bool is_hex(char c) { return is_digit(c) || (c >= 'A' && c <= 'F') || (c >= 'a' && c <= 'f'); }

bool begins(std::string_view text, std::string_view pattern) {
  return text.size() >= pattern.size() &&
         std::equal(pattern.begin(), pattern.end(), text.begin(),
                    [](char wanted, char c) { return wanted == '#' ? is_digit(c) : wanted == c; });
}

bool matches(std::string_view line, std::string_view pattern) {
  if (pattern.front() == '^') return begins(line, pattern.substr(1));
  for (; line.size() >= pattern.size(); line.remove_prefix(1)) {
    if (begins(line, pattern)) return true;
  }
  return false;
}

// NMEA 0183: '$' or '!', talker and sentence in five or more capitals or digits, a comma; or, of a
// line whose beginning was missed, the checksum at its end, as '*' and two hexadecimal digits.
bool is_nmea(std::string_view line) {
  const auto is_sentence = [](std::string_view text) {
    if (text.size() < 7 || (text.front() != '$' && text.front() != '!')) return false;
    const std::string_view name = text.substr(1, text.find(',') - 1);
    return name.size() >= 5 && name.size() < text.size() - 1 && is_capital(name.front()) &&
           std::ranges::all_of(name, [](char c) { return is_capital(c) || is_digit(c); });
  };
  for (std::size_t at = line.find_first_of("$!"); at != std::string_view::npos;
       at = line.find_first_of("$!", at + 1)) {
    if (is_sentence(line.substr(at))) return true;
  }
  const std::size_t end = line.size();
  return end >= 8 && line[end - 3] == '*' && is_hex(line[end - 2]) && is_hex(line[end - 1]) &&
         std::ranges::count(line, ',') >= 3;
}

}  // namespace

TextSource text_source(std::string_view line) {
  for (const Known& known : kKnown) {
    if (matches(line, known.pattern)) return known.source;
  }
  return is_nmea(line) ? TextSource::gps : prompt_source(line);
}

TextSource prompt_source(std::string_view line) {
  while (line.ends_with(' ')) line.remove_suffix(1);
  if (line.ends_with("ogin:") || line.ends_with("assword:")) return TextSource::login_prompt;
  const bool of_user = line.find('@') != std::string_view::npos;
  return of_user && (line.ends_with('$') || line.ends_with('#')) ? TextSource::shell
                                                                 : TextSource::unknown;
}

std::string_view describe(TextSource source) {
  switch (source) {
    case TextSource::unknown: return "";
    case TextSource::robot: return "the robot";
    case TextSource::login_prompt: return "a login prompt";
    case TextSource::shell: return "a shell";
    case TextSource::kernel: return "a computer's kernel";
    case TextSource::boot_loader: return "a computer's boot loader";
    case TextSource::gps: return "a GPS receiver";
    case TextSource::modem: return "a modem";
  }
  return "";
}

}  // namespace cargobay::hal
