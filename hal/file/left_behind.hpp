// Names in the file system that a dead process left behind, and that we want.
#pragma once

#include <functional>
#include <string>
#include <system_error>

namespace cargobay::hal {

// Removes the file at `path` if `removable`, called with a path, says that it may go. It is called
// twice: before the file is touched, and again after the file has been moved to a name of its own,
// where no other file can take its place. A file that may not go is put back. Returns file_exists
// if the file stays, nothing if it was removed or did not exist.
std::error_code remove_if(const std::string& path,
                          const std::function<bool(const std::string&)>& removable);

// While it lives, no other process or thread holds one for the same folder: if several find the
// same dead file, the second finds what the first has put there. Waits for its turn for 1 s at
// most; after that, and in a folder that cannot be read, it goes ahead without the lock, so that a
// process that merely holds the lock cannot block others for ever.
class FolderTurn {
 public:
  // The folder that `path` is in.
  explicit FolderTurn(const std::string& path);
  ~FolderTurn();
  FolderTurn(const FolderTurn&) = delete;
  FolderTurn& operator=(const FolderTurn&) = delete;

 private:
  int folder_;
};

// The target of a symbolic link; empty if it is not one.
std::string link_target(const std::string& link);

// What to do about an error on opening something; `otherwise` unless descriptors have run out.
std::string remedy_for(int error, std::string otherwise);

}  // namespace cargobay::hal
