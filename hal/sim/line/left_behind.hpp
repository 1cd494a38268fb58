// Names in the file system that a process which is gone left behind, and that we want.
#pragma once

#include <functional>
#include <string>
#include <system_error>

namespace cargobay::hal::sim {

// Removes the file at `path` if `removable` says of it, by the path it is handed, that it may go.
// It is asked twice: before the file is touched, and again when the file has been moved to a name
// of its own, where nothing can come in its place any more. What may not go is put back. Returns
// file_exists if it stays, nothing if it went or was not there.
std::error_code remove_if(const std::string& path,
                          const std::function<bool(const std::string&)>& removable);

// While it lives no other process, and no other thread, holds one for the same folder: of several
// that find the same dead file, the second finds what the first has put there. Waits for its turn
// for 1 s; then, and in a folder that may not be read, it is had without: who only holds the lock
// holds nobody up for ever.
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

// Where a symbolic link leads; empty if it is none.
std::string link_target(const std::string& link);

// What to do about an error of opening something; `otherwise` if descriptors have not run out.
std::string remedy_for(int error, std::string otherwise);

}  // namespace cargobay::hal::sim
