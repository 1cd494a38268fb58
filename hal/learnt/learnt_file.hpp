// The file that keeps what was learnt of a robot's wheels for the next start.
#pragma once

#include <string>
#include <string_view>

#include "hal/result.hpp"
#include "rt/learnt_plant.hpp"

namespace cargobay::hal {

struct LearntRecord {
  std::string port{};  // whose robot it was: as port_name() tells ports apart
  rt::LearntPlant plant{};
};

// TOML, with a comment for whoever opens it.
std::string learnt_text(const LearntRecord& record);

// What learnt_text() wrote. Anything else is a failure that says what is wrong, without the file's
// name: not TOML, another version, a key that is missing, a value that no robot has.
Result<LearntRecord> parse_learnt(std::string_view text);

// Reads a file of `port`, as hal/file/read_input.hpp does; blocks for the disk. A file of another
// port is a failure too. If there is no file, the code is no_such_file_or_directory.
Result<rt::LearntPlant> load_learnt(const std::string& file, const std::string& port);

// Whether there is a file that save_learnt() has not written, which must not be lost to a name that
// was mistyped. One that is empty, or that a power cut has filled with zeros, may be.
bool is_of_another_kind(const std::string& file);

// Writes it so that a reader, or a machine that loses its power, finds the former file or the new
// one, never half of it; makes the folder, for its owner alone. Blocks for the disk, not until it
// has written. Two writers do not disturb each other; the later one stays. After a failure, which
// names the file, the former one is untouched.
Result<void> save_learnt(const std::string& file, const LearntRecord& record);

// Whether a drive has learnt enough for the next one to begin from it: it moved for some seconds,
// and what it found is a robot's, not that of counters that are dead.
bool worth_keeping(const rt::LearntPlant& plant);

}  // namespace cargobay::hal
