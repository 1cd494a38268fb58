// A file that a user names for output. It is opened before anything moves, and gets its name only
// once its contents are written: until then, what was there before is kept.
//
// One rule for what is there already (docs/man/cargobay.inc tells users):
// - A file that may be written is replaced, keeping its owner and rights. A file that came there
//   only after open() is not: publish() leaves the output beside it, and says so.
// - A symbolic link is followed, and the file it leads to is replaced or made; the link stays.
// - In a folder open to all, such as /tmp, files and links of other users are refused.
// - FIFOs that something reads, /dev/null, /dev/full, and /dev/stdout, /dev/stderr and /dev/fd/N
//   are written as they are; standard output and error may be terminals.
// - Ports, terminals, disks, other devices, sockets and folders are refused.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "hal/file/descriptor.hpp"
#include "hal/file/file_place.hpp"
#include "hal/result.hpp"
#include "rt/clock.hpp"

namespace cargobay::hal {

class OutputFile {
 public:
  // Writes nothing yet. Blocks for the disk, but not for the reader of a FIFO.
  static Result<OutputFile> open(const std::string& path);
  // What was not published leaves no trace.
  ~OutputFile();
  OutputFile(OutputFile&& other) noexcept = default;
  OutputFile& operator=(OutputFile&&) = delete;
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  // Appends all of it; after a failure, as much as there was room for. `patience` is how long to
  // wait for a pipe that takes nothing; without it, 24 h. A full disk, a limit on the file's size
  // and a pipe that nothing reads any longer are failures, not signals (SIGXFSZ, SIGPIPE).
  Result<void> write(std::string_view bytes, std::optional<rt::Duration> patience = {});
  // Gives the file its name; it may still be written to. The second call does nothing.
  Result<void> publish();
  // Blocks until what was written is on the disk.
  void sync() const;

  const std::string& path() const { return path_; }  // as it was given
  const FilePlace& place() const { return place_; }  // where its links lead

 private:
  explicit OutputFile(std::string path) : path_{std::move(path)} {}

  Result<void> open_descriptor(int named);
  Result<void> open_in_place(const std::string& name);
  Result<void> open_temporary(const std::string& name);
  void keep_rights_of(const std::string& name) const;
  bool link_as(const std::string& name) const;
  bool move_into_place();
  Failure cannot_write(int error) const;

  std::string path_;
  FilePlace place_{};
  Descriptor file_{};
  Descriptor folder_{};      // of the name; none if the file is written in place
  std::string name_{};       // in the folder
  std::string temporary_{};  // its name until it is published; empty if it has none
  bool replaces_ = false;    // there was such a file when it was opened
  bool published_ = false;
};

}  // namespace cargobay::hal
