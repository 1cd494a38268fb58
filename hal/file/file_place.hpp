// Whether two paths name one file, whatever links lead there.
#pragma once

#include <sys/types.h>

#include <optional>
#include <string>

namespace cargobay::hal {

struct FilePlace {
  struct Inode {
    dev_t device = 0;
    ino_t number = 0;
    bool operator==(const Inode&) const = default;
  };
  std::optional<Inode> file{};    // nothing if there is no file yet
  std::optional<Inode> folder{};  // in which it is, or would be; nothing if that is unknown
  std::string name{};             // in that folder
  bool discards = false;          // /dev/null: any number of writers may share it
};

// Of the file that the path leads to, which need not exist.
FilePlace place_of(const std::string& path);
// Of what is open there.
FilePlace place_of(int descriptor);

// True for hard links of one file too. False if either discards.
bool same_file(const FilePlace& a, const FilePlace& b);

}  // namespace cargobay::hal
