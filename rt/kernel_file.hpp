// Text files that the kernel writes as they are read: proc(5), sysfs(5).
#pragma once

#include <filesystem>
#include <string>

namespace cargobay::rt {

// The whole text of the file; empty if it cannot be opened, or if a read fails, as when the process
// that it is about ends meanwhile (ESRCH): then nothing of it. Throws nothing but std::bad_alloc.
// Any thread. Blocks as read(2) does; allocates.
std::string kernel_file(const std::filesystem::path& path);

}  // namespace cargobay::rt
